"""Allocates as many MiB as its first argument says, and says so."""

import sys

block = bytearray(int(sys.argv[1]) << 20)
print(f"allocated {len(block) >> 20} MiB")
