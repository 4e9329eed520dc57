"""All that can be held or taken: renewable resources with windows and set-ups, calendars, stock."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from irc.diagnostics.source import Pointer

NO_FAMILY = -1
"""The family of a use that names none."""


ANY_FAMILY = -2
"""In a row of set-ups, any family that the other one is not."""


class Window(NamedTuple):
    """Another capacity throughout [start, end)."""

    start: int
    end: int
    capacity: int


def capacity_levels(base: int, windows: Iterable[Window]) -> Iterator[tuple[int, int]]:
    """(From when on, capacity), in order of time; the last level stays.

    `base` is the capacity outside of the windows, which are in order and do not overlap.
    """
    at = 0
    for window in windows:
        if at < window.start:
            yield at, base
        yield window.start, window.capacity
        at = window.end
    yield at, base


class Setup(NamedTuple):
    """The time (ticks) that passes between two uses of a resource at least, and what it costs."""

    time: int
    cost: int = 0


NO_SETUP = Setup(0, 0)


@dataclass(frozen=True, slots=True)
class Setups:
    """The set-ups of a resource of capacity 1, by the families before and after.

    `table` has the rows of the task. With an `initial` family the first use needs its set-up,
    which can begin at the tick `since`. Uses that start before `waived_before` wait for no set-up:
    while a task runs, they have started too early. Where they are `tight`, nothing but a set-up is
    between two uses, and the time before `now`.
    """

    table: Mapping[tuple[int, int], Setup] = field(default_factory=dict)
    initial: int | None = None
    since: int = 0
    waived_before: int = 0
    tight: bool = False
    now: int = 0

    def between(self, before: int, after: int) -> Setup:
        """The set-up of the most specific row (docs/semantics.md, rule 4.3)."""
        if before == after:
            return NO_SETUP if after == NO_FAMILY else self.table.get((before, after), NO_SETUP)
        rows = ((before, after), (before, ANY_FAMILY), (ANY_FAMILY, after), _ANY_ROW)
        return next((self.table[row] for row in rows if row in self.table), NO_SETUP)

    def first(self, after: int) -> Setup:
        """The set-up of the first use."""
        return NO_SETUP if self.initial is None else self.between(self.initial, after)

    @property
    def longest(self) -> int:
        """The longest time of any row, in ticks."""
        return max((setup.time for setup in self.table.values()), default=0)


_ANY_ROW = (ANY_FAMILY, ANY_FAMILY)


@dataclass(frozen=True, slots=True)
class Renewable:
    """A resource of which `capacity` units can be held at once, save in its windows.

    `windows` are in order and do not overlap. Only a capacity of 1 has `setups`. Uses of a `batch`
    resource that overlap are one load: one start, one end, one family.
    """

    id: str
    capacity: int
    origin: Pointer = ()
    windows: tuple[Window, ...] = ()
    setups: Setups | None = None
    batch: bool = False

    @property
    def is_ordered(self) -> bool:
        """Whether more than amounts decides which uses go together: set-ups, orders, loads."""
        return self.setups is not None or self.batch

    def greatest_capacity(self, since: int | None = None) -> int:
        """The greatest capacity that there ever is, or from a time on."""
        later = (w.capacity for w in self.windows if since is None or w.end > since)
        return max((self.capacity, *later))

    def open_times(self, amount: int) -> Iterator[tuple[int, int | None]]:
        """The times with at least this capacity, in order; the end None is never."""
        begun: int | None = None
        for start, capacity in capacity_levels(self.capacity, self.windows):
            if capacity >= amount:
                begun = start if begun is None else begun
            elif begun is not None:
                yield begun, start
                begun = None
        if begun is not None:
            yield begun, None


@dataclass(frozen=True, slots=True)
class OpenCalendar:
    """A calendar that actions have: the (start, end) in which it is open, in order.

    They do not touch; after the last one it is closed.
    """

    id: str
    times: tuple[tuple[int, int], ...]
    origin: Pointer = ()


@dataclass(frozen=True, slots=True)
class Reservoir:
    """A stock whose level stays within [least, greatest] (None: no limit) at every instant."""

    id: str
    initial: int
    least: int = 0
    greatest: int | None = None
    origin: Pointer = ()
