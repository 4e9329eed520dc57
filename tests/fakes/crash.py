"""Prints a plan, then dies: by a signal (first argument "signal") or with exit code 3."""

import os
import resource
import signal
import sys

print("; Plan found with metric 10.000\n0.000: (grill) [10.000]", flush=True)
print("bad_alloc: cannot go on", file=sys.stderr, flush=True)
if sys.argv[1] == "signal":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.kill(os.getpid(), signal.SIGSEGV)
sys.exit(3)
