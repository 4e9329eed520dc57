"""The document in the making: what statements add, where each part of it stands, the budget."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from irc.diagnostics import Code
from irc.diagnostics.source import Pointer, Range, Source
from irc.frontends.dsl.faults import Fault

MAX_EXPANDED = 2_000_000
"""What one text may grow to by arrows between many and by pools: parts in all."""

MAX_REPEATED = 200_000
"""How many statements all `for`s of a text may make."""

Element = dict[str, Any]


@dataclass(slots=True)
class Places:
    """Where the parts of the document stand; only the `wanted` ones where that is given."""

    wanted: frozenset[Pointer] | None = None
    found: dict[Pointer, Range] = field(default_factory=dict)
    elements: frozenset[Pointer] | None = None
    """The elements of arrays that something of is wanted; all where that is not given."""

    def __post_init__(self) -> None:
        if self.wanted is not None:
            self.elements = frozenset(pointer[:2] for pointer in self.wanted)

    def add(
        self, pointer: Pointer, start: int, end: int, key: int | None, source: Source | None
    ) -> None:
        """Notes one place; the first one said counts."""
        if (self.wanted is None or pointer in self.wanted) and pointer not in self.found:
            self.found[pointer] = Range(start, end, key, source)


@dataclass(slots=True)
class Budget:
    """Counts what short texts grow to, so that none grows without end."""

    parts: int = MAX_EXPANDED
    statements: int = MAX_REPEATED

    def take(self, count: int, what: str, start: int, end: int) -> None:
        """Raises `Fault` where `count` more parts would be too many."""
        if count > self.parts:
            made = MAX_EXPANDED - self.parts + count
            raise _too_many(f"with {what} the text has {made:,} parts", MAX_EXPANDED, start, end)
        self.parts -= count

    def repeat(self, count: int, start: int, end: int) -> None:
        """Raises `Fault` where `count` more statements of a `for` would be too many."""
        if count > self.statements:
            made = MAX_REPEATED - self.statements + count
            message = f"with this `for` the text has {made:,} repeated statements"
            raise _too_many(message, MAX_REPEATED, start, end)
        self.statements -= count


def _too_many(what: str, most: int, start: int, end: int) -> Fault:
    return Fault(
        Code.DSL_EXPANSION,
        f"{what}; at most {most:,} are made",
        start,
        end,
        "split the task, or say less of it",
    )


@dataclass(slots=True)
class Sink:
    """Where statements put what they declare: the task's own arrays, or those of one change."""

    arrays: dict[str, list[Any]]
    base: Pointer = ()

    def next(self, part: str) -> Pointer:
        """The pointer of the next element of an array."""
        return (*self.base, part, len(self.arrays.setdefault(part, [])))

    def put(self, part: str, element: Any) -> None:
        """Adds an element."""
        self.arrays.setdefault(part, []).append(element)

    def lengths(self) -> dict[str, int]:
        """How long each array is, for `cut`."""
        return {part: len(elements) for part, elements in self.arrays.items()}

    def cut(self, lengths: dict[str, int]) -> None:
        """Takes away what was added since."""
        for part, elements in self.arrays.items():
            del elements[lengths.get(part, 0) :]
