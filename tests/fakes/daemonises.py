"""Leaves a daemon behind, in a session of its own, that never ends by itself.

First argument: "silent" if the daemon lets go of stdout and stderr, "open" if it keeps them.
"""

import os
import signal
import sys
import time

ready, say_ready = os.pipe()
if os.fork() == 0:
    os.setsid()
    if os.fork() > 0:
        os._exit(0)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    if sys.argv[1] == "silent":
        null = os.open(os.devnull, os.O_RDWR)
        os.dup2(null, 1)
        os.dup2(null, 2)
    os.write(say_ready, b"!")
    time.sleep(600)
    os._exit(0)
os.read(ready, 1)
os.wait()
print("daemon started", flush=True)
