"""Prints a plan, begins a better one, and hangs in the middle of it."""

import time

print("; Plan found with metric 12.000")
print("0.000: (grill) [10.000]")
print("10.001: (stack) [1.000]")
print("; Plan found with metric 11.000\n0.000: (gri", end="", flush=True)
time.sleep(600)
