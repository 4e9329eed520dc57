"""Prints what is no text: broken UTF-8, NUL, a lone carriage return, and no last line end."""

import os

os.write(1, b"\xff\xfe\x00 pla\rn \xc3\x28\r\n\xe2\x82")
os.write(2, b"\x80\x81")
