"""The fault of one statement, which the reader of the statement catches and reports."""

from __future__ import annotations

from irc.diagnostics import Code
from irc.errors import IrcError


class Fault(IrcError):
    """A fault of a statement: the code, the message, and the offsets in its text."""

    def __init__(
        self, code: Code, message: str, start: int, end: int, hint: str | None = None
    ) -> None:
        super().__init__(message)
        self.code, self.message = code, message
        self.start, self.end, self.hint = start, end, hint
