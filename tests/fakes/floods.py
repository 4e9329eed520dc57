"""Prints without end: lines on stdout ("stdout"), one endless line ("line").

Or prints 4 MiB to stderr, then a last line there, and ends ("stderr").
"""

import os
import sys

where = sys.argv[1]
if where == "stderr":
    os.write(2, b"noise\n" * 700_000)
    os.write(2, b"the last line\n")
    sys.exit(0)
while True:
    os.write(1, (b"Resorting to best-first search\n" if where == "stdout" else b".") * 1000)
