"""Forks a child that holds stdout open, and one that ignores SIGTERM; neither ends by itself.

First argument: "wait" to wait for them, "exit" to leave them behind (exit code 0).
"""

import os
import signal
import sys
import time

for handler in (signal.SIG_DFL, signal.SIG_IGN):
    ready, say_ready = os.pipe()
    if os.fork() == 0:
        signal.signal(signal.SIGTERM, handler)
        os.write(say_ready, b"!")
        time.sleep(600)
        os._exit(0)
    os.read(ready, 1)
print("ready", flush=True)
if sys.argv[1] == "wait":
    os.wait()
