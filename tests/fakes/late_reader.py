"""Closes its output, then reads all of its stdin; exit code 6 if it ends in "end"."""

import os
import sys

os.close(1)
os.close(2)
os._exit(6 if sys.stdin.buffer.read().endswith(b"end") else 1)
