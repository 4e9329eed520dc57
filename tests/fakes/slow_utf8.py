"""Prints a line in pieces, cut inside a character, and a last line without its end."""

import os
import time

for piece in (b"grill po", b"ulet r\xc3", b"\xb4ti\r\nsec", b"ond\nunfinished"):
    os.write(1, piece)
    time.sleep(0.03)
