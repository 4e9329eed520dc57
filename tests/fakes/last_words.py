"""Improves its plan until asked to end, and prints the best one only then; exits with code 7.

First argument: "wide" if stdout takes all of it at once (Linux only), so that it is gone before
anybody has read it; "narrow" if it does not, so that it has to be read before the end. A second
request to end is obeyed without a word, as with many an anytime planner.
"""

import fcntl
import os
import signal
import sys
import time

PLAN = b"; Plan found with metric 10.000\n" + b"0.000: (grill) [10.000]\n" * 8000


def say(*_: object) -> None:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    time.sleep(0.05)
    unsaid = memoryview(PLAN)
    while unsaid:
        unsaid = unsaid[os.write(1, unsaid) :]
    os._exit(7)


if sys.argv[1] == "wide" and hasattr(fcntl, "F_SETPIPE_SZ"):
    fcntl.fcntl(1, fcntl.F_SETPIPE_SZ, 1 << 20)
signal.signal(signal.SIGTERM, say)
os.write(1, b"ready\n")
time.sleep(600)
