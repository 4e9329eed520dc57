"""Prints a file, as a planner would its plans, and then goes wrong (or does not).

First argument: the file. Second: "exits" (with code 0), "fails" (code 3), "crashes" (a signal),
"hangs", "ignores" (hangs, and ignores SIGTERM), "forks" (hangs, and so does a child of it that
ignores SIGTERM) or "floods" (prints chatter without end). Whatever follows, such as a domain and
a problem, is not read.
"""

import os
import resource
import signal
import sys
import time

said, what = sys.argv[1:3]
with open(said, "rb") as file:
    os.write(1, file.read())
if what == "crashes":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.kill(os.getpid(), signal.SIGSEGV)
if what == "fails":
    print("bad_alloc: cannot go on", file=sys.stderr)
    sys.exit(3)
if what == "floods":
    while True:
        os.write(1, b"Resorting to best-first search\n" * 1000)
if what == "forks":
    ready, say_ready = os.pipe()
    if os.fork() == 0:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        os.write(say_ready, b"!")
        time.sleep(600)
    os.read(ready, 1)
if what == "ignores":
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
if what != "exits":
    time.sleep(600)
