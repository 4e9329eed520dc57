"""The parts of the document that statements add, their places, and limits on their number."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from irc.diagnostics import Code
from irc.diagnostics.source import Pointer, Range, Source
from irc.frontends.dsl.faults import Fault

MAX_EXPANDED = 500_000
"""Limit on the parts of a document that arrows between many actions and pools may produce."""

MAX_REPEATED = 100_000
"""Limit on the statements that all `for`s of a text may produce."""

MAX_REPEATED_TEXT = 4_000_000
"""Limit on the characters of these statements, before their braces are filled in."""

Element = dict[str, Any]


@dataclass(slots=True)
class Places:
    """The places of the parts of the document, or only of the `wanted` ones."""

    wanted: frozenset[Pointer] | None = None
    found: dict[Pointer, Range] = field(default_factory=dict)
    elements: frozenset[Pointer] | None = None
    """The elements of arrays of which a part is wanted; None means all."""

    def __post_init__(self) -> None:
        if self.wanted is not None:
            self.elements = frozenset(pointer[:2] for pointer in self.wanted)

    def add(
        self, pointer: Pointer, start: int, end: int, key: int | None, source: Source | None
    ) -> None:
        """Records one place; the first one of a pointer counts."""
        if (self.wanted is None or pointer in self.wanted) and pointer not in self.found:
            self.found[pointer] = Range(start, end, key, source)


@dataclass(slots=True)
class ExpansionLimit:
    """Counts the parts and statements of an expanding text, so that none grows without limit."""

    parts: int = MAX_EXPANDED
    statements: int = MAX_REPEATED
    text: int = MAX_REPEATED_TEXT

    def take(self, count: int, what: str, start: int, end: int) -> None:
        """Counts parts. Raises `Fault` if `count` more parts are too many."""
        if count > self.parts:
            made = MAX_EXPANDED - self.parts + count
            raise _too_many(f"with {what} the text has {made:,} parts", MAX_EXPANDED, start, end)
        self.parts -= count

    def repeat(self, count: int, length: int, start: int, end: int) -> None:
        """Counts `count` statements of a `for`, with `length` characters together.

        Raises `Fault` if they are too many, or too long.
        """
        if length > self.text:
            made = MAX_REPEATED_TEXT - self.text + length
            message = f"with this `for` the repeated statements have {made:,} characters"
            raise _too_many(message, MAX_REPEATED_TEXT, start, end)
        if count > self.statements:
            made = MAX_REPEATED - self.statements + count
            message = f"with this `for` the text has {made:,} repeated statements"
            raise _too_many(message, MAX_REPEATED, start, end)
        self.statements -= count
        self.text -= length


def _too_many(what: str, most: int, start: int, end: int) -> Fault:
    return Fault(
        Code.DSL_EXPANSION,
        f"{what}; the maximum is {most:,}",
        start,
        end,
        "split the task, or repeat less",
    )


@dataclass(slots=True)
class Sink:
    """The arrays that statements add to: those of the task, or those of one change."""

    arrays: dict[str, list[Any]]
    base: Pointer = ()

    def next(self, part: str) -> Pointer:
        """The pointer of the next element of an array."""
        return (*self.base, part, len(self.arrays.setdefault(part, [])))

    def put(self, part: str, element: Any) -> None:
        """Adds an element."""
        self.arrays.setdefault(part, []).append(element)

    def lengths(self) -> dict[str, int]:
        """The length of each array, for `cut`."""
        return {part: len(elements) for part, elements in self.arrays.items()}

    def cut(self, lengths: dict[str, int]) -> None:
        """Removes the elements that were added since."""
        for part, elements in self.arrays.items():
            del elements[lengths.get(part, 0) :]
