"""Closes its output, goes on for as many seconds as its first argument says; exit code 5."""

import os
import sys
import time

os.write(1, b"that was all\n")
os.close(1)
os.close(2)
time.sleep(float(sys.argv[1]))
os._exit(5)
