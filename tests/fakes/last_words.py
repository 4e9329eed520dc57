"""Improves its plan until asked to end, and prints the best one only then; exits with code 7.

A second request ends it at once, as with many an anytime planner.
"""

import signal
import sys
import time


def say(*_: object) -> None:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    time.sleep(0.05)
    print("; Plan found with metric 10.000")
    print("0.000: (grill) [10.000]\n" * 8000, flush=True)  # more than a pipe holds
    sys.exit(7)


signal.signal(signal.SIGTERM, say)
print("ready", flush=True)
time.sleep(600)
