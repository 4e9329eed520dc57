"""Prints a plan, begins a better one, and hangs in the middle of it."""

import os
import time

PLANS = b"""\
; Plan found with metric 12.000
0.000: (grill) [10.000]
10.001: (stack) [1.000]
; Plan found with metric 11.000
0.000: (gri"""

os.write(1, PLANS)
time.sleep(600)
