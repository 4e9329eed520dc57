"""A fault of one statement, raised where it is found and told where the statement is read."""

from __future__ import annotations

from irc.diagnostics import Code
from irc.errors import IrcError


class Fault(IrcError):
    """What is wrong with a statement: the code, the words, and the offsets in its text."""

    def __init__(
        self, code: Code, message: str, start: int, end: int, hint: str | None = None
    ) -> None:
        super().__init__(message)
        self.code, self.message = code, message
        self.start, self.end, self.hint = start, end, hint
