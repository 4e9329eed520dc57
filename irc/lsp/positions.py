"""Offsets of a text ↔ the positions of the Language Server Protocol (3.17, "Position").

A line of the protocol ends in "\\n", "\\r\\n" or "\\r" and in nothing else; columns are counted in
code units of the encoding that was agreed on.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from enum import StrEnum
from typing import NamedTuple

_LINE_END = re.compile(r"\r\n|\n|\r")
_SURROGATE = re.compile("[\ud800-\udfff]")


class Encoding(StrEnum):
    """What columns are counted in."""

    UTF_8 = "utf-8"
    UTF_16 = "utf-16"
    UTF_32 = "utf-32"


class Place(NamedTuple):
    """0-based line, and column in code units."""

    line: int
    character: int


def units(text: str, encoding: Encoding) -> int:
    """How many code units a text has."""
    if encoding is Encoding.UTF_32 or text.isascii():
        return len(text)
    if encoding is Encoding.UTF_8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text) + sum(c > "\uffff" for c in text)


def whole_characters(text: str) -> str:
    """The text with both halves of a character, where edits brought them together, as one."""
    if not _SURROGATE.search(text):
        return text
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")


class Lines:
    """Where the lines of a text begin, for looking up positions."""

    __slots__ = ("encoding", "starts", "text")

    def __init__(self, text: str, encoding: Encoding) -> None:
        self.text = text
        self.encoding = encoding
        self.starts = [0, *(end.end() for end in _LINE_END.finditer(text))]

    def offset(self, line: int, character: int) -> int:
        """The offset of a position; one beyond its line, or the text, means the end of that.

        A column inside of a character means the beginning of that character.
        """
        if line < 0:
            return 0
        if line >= len(self.starts):
            return len(self.text)
        start, end = self.starts[line], self._end(line)
        if self.encoding is Encoding.UTF_32 or self.text.isascii():
            return min(start + max(character, 0), end)
        at = start
        while at < end:
            character -= units(self.text[at], self.encoding)
            if character < 0:
                break
            at += 1
        return at

    def place(self, offset: int) -> Place:
        """The position of an offset; one outside of the text means its nearest end."""
        offset = min(max(offset, 0), len(self.text))
        line = bisect_right(self.starts, offset) - 1
        # Behind the text of a line and before its end there is no position but the end.
        offset = max(min(offset, self._end(line)), self.starts[line])
        return Place(line, units(self.text[self.starts[line] : offset], self.encoding))

    def _end(self, line: int) -> int:
        """Where the text of a line ends, without what ends the line."""
        if line + 1 == len(self.starts):
            return len(self.text)
        end = self.starts[line + 1] - 1
        return end - 1 if self.text[end] == "\n" and self.text[end - 1 : end] == "\r" else end
