"""Converts offsets of a text to positions of the Language Server Protocol (3.17), and back.

A line of the protocol ends only in "\\n", "\\r\\n" or "\\r"; columns are counted in code units of
the agreed encoding.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from enum import StrEnum
from typing import NamedTuple

_LINE_END = re.compile(r"\r\n|\n|\r")
_SURROGATE = re.compile("[\ud800-\udfff]")


class Encoding(StrEnum):
    """The encoding whose code units are the columns."""

    UTF_8 = "utf-8"
    UTF_16 = "utf-16"
    UTF_32 = "utf-32"


class Place(NamedTuple):
    """0-based line, and column in code units."""

    line: int
    character: int


def units(text: str, encoding: Encoding) -> int:
    """The number of code units of a text."""
    if encoding is Encoding.UTF_32 or text.isascii():
        return len(text)
    if encoding is Encoding.UTF_8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text) + sum(c > "\uffff" for c in text)


def whole_characters(text: str) -> str:
    """The text with pairs of surrogates joined to one character."""
    if not _SURROGATE.search(text):
        return text
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")


class Lines:
    """The starts of the lines of a text, for looking up positions."""

    __slots__ = ("encoding", "starts", "text")

    def __init__(self, text: str, encoding: Encoding) -> None:
        self.text = text
        self.encoding = encoding
        self.starts = [0, *(end.end() for end in _LINE_END.finditer(text))]

    def offset(self, line: int, character: int) -> int:
        """The offset of a position; one beyond its line or the text means its end.

        A column inside a character means the beginning of that character.
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
        """The position of an offset; one outside the text means its nearest end."""
        offset = min(max(offset, 0), len(self.text))
        line = bisect_right(self.starts, offset) - 1
        # An offset inside the line end means the end of the line's text.
        offset = max(min(offset, self._end(line)), self.starts[line])
        return Place(line, units(self.text[self.starts[line] : offset], self.encoding))

    def _end(self, line: int) -> int:
        """The offset of the end of a line's text, without the line end."""
        if line + 1 == len(self.starts):
            return len(self.text)
        end = self.starts[line + 1] - 1
        return end - 1 if self.text[end] == "\n" and self.text[end - 1 : end] == "\r" else end
