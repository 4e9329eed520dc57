"""Reads files of numbers line by line; a fault has its line and column.

The formats of scheduling benchmarks say what a number means by its position alone, so a reader
cannot go on behind a fault: each file has one diagnostic, at the first number that is wrong.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn

from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Source

_WORD = re.compile(r"\S+")
_WHOLE = re.compile(r"[+-]?\d{1,18}(?:\.0*)?\Z", re.ASCII)

MOST_ELEMENTS = 1_000_000
"""More jobs, operations or resources than this in a file are refused before they are read."""


@dataclass(frozen=True)
class Line:
    """A line that is not blank: its words, and where each begins in the text."""

    words: tuple[str, ...]
    offsets: tuple[int, ...]
    text: str
    """The line without surrounding blanks."""

    @property
    def is_numbers(self) -> bool:
        """Whether each word is a whole number, also one that is written as a decimal (`3.0`)."""
        return all(_WHOLE.match(word) for word in self.words)


class NumberLines:
    """The lines of a file, and a position among them that the `take…` methods move on."""

    def __init__(self, text: str, name: str, expected: str) -> None:
        """`expected` describes the format; it is the hint of every fault."""
        self.source = Source(name, text)
        self.expected = expected
        self.lines = tuple(_lines(text))
        self.position = 0

    def __bool__(self) -> bool:
        return self.position < len(self.lines)

    @property
    def next(self) -> Line:
        """The line that is read next. Raises `InputError` at the end of the file."""
        if not self:
            self.refuse("the file ends too early", len(self.source.text.rstrip()))
        return self.lines[self.position]

    def take(self) -> Line:
        """The next line; the position moves behind it."""
        line = self.next
        self.position += 1
        return line

    def take_numbers(self, what: str, count: int | None = None) -> Numbers:
        """The numbers of the next line. `count`: how many there must be."""
        line = self.take()
        if count is not None and len(line.words) != count:
            place = line.offsets[min(count, len(line.words) - 1)]
            self.refuse(f"{what}: expected {count} numbers, found {len(line.words)}", place)
        return Numbers(self, what, line.words, line.offsets)

    def rest(self, what: str) -> Numbers:
        """All numbers up to the end of the file, whatever lines they stand in."""
        lines = self.lines[self.position :]
        self.position = len(self.lines)
        words = tuple(word for line in lines for word in line.words)
        return Numbers(self, what, words, tuple(at for line in lines for at in line.offsets))

    def refuse(self, message: str, offset: int) -> NoReturn:
        """Raises the `InputError` of a fault at an offset into the text."""
        findings = Findings()
        findings.add(Code.NOT_AN_IMPORT, message, offset=offset, hint=self.expected)
        raise InputError(Report(tuple(findings.items), self.source))


class Numbers:
    """A row of numbers, read from left to right."""

    def __init__(
        self, lines: NumberLines, what: str, words: tuple[str, ...], offsets: tuple[int, ...]
    ) -> None:
        self.lines, self.what = lines, what
        self._words, self._offsets = words, offsets
        self._position = 0

    def __bool__(self) -> bool:
        return self._position < len(self._words)

    def __len__(self) -> int:
        return len(self._words) - self._position

    def take(
        self, name: str, least: int | None = 0, most: int | None = None, *, brackets: bool = False
    ) -> int:
        """The next number, `least` or more and `most` or less; `name` says what it counts.

        With `brackets` it may stand in square brackets.
        """
        if not self:
            self.refuse(f"{name} is missing")
        word = self._words[self._position]
        if brackets and word.startswith("[") and word.endswith("]"):
            word = word[1:-1]
        if not _WHOLE.match(word):
            self.refuse(f"{name}: expected a whole number, found {word[:40]!r}")
        value = int(word.partition(".")[0])
        if least is not None and value < least:
            self.refuse(f"{name}: expected {least} or more, found {value}")
        if most is not None and value > most:
            self.refuse(f"{name}: expected {most} or less, found {value}")
        self._position += 1
        return value

    def take_many(self, name: str, count: int, least: int | None = 0) -> list[int]:
        """The next `count` numbers."""
        return [self.take(name, least) for _ in range(count)]

    def end(self) -> None:
        """Refuses numbers that are left over."""
        if self:
            self.refuse(f"{len(self)} more numbers than the format has here")

    def refuse(self, message: str) -> NoReturn:
        """Raises the `InputError` of a fault at the next number, or behind the last one."""
        if self:
            place = self._offsets[self._position]
        else:
            last = len(self._words) - 1
            place = self._offsets[last] + len(self._words[last]) if self._words else 0
        self.lines.refuse(f"{self.what}: {message}", place)


def _lines(text: str) -> Iterator[Line]:
    start = 0
    for raw in text.splitlines(keepends=True):
        words = list(_WORD.finditer(raw))
        if words:
            yield Line(
                tuple(w.group() for w in words),
                tuple(start + w.start() for w in words),
                raw.strip(),
            )
        start += len(raw)
