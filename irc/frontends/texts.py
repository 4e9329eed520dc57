"""Reads the bytes and the texts of files and of standard input."""

from __future__ import annotations

import sys
from pathlib import Path

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.frontends.json.document import MAX_BYTES, decode_bytes

STANDARD_INPUT = "-"


def read_bytes(path: str | Path) -> tuple[bytes, str]:
    """The bytes of a file ("-": standard input) and its name. Raises `InputError`."""
    if not isinstance(path, (str, Path)):
        raise TypeError(f"expected a path, not {type(path).__name__}")
    if str(path) == STANDARD_INPUT:
        return sys.stdin.buffer.read(MAX_BYTES + 1), "<stdin>"
    try:
        with open(path, "rb") as file:
            return file.read(MAX_BYTES + 1), str(path)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        message = f"cannot read {str(path)!r}: {getattr(error, 'strerror', None) or error}"
        raise InputError(Report((Diagnostic(Code.UNREADABLE, message),))) from None


def read_text(path: str | Path) -> tuple[str, str]:
    """The text of a file and its name. Raises `InputError`."""
    data, name = read_bytes(path)
    return decode_bytes(data, name), name
