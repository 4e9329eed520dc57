"""One entry of a schedule: the time, mode and resources of one occurrence of an action."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from datetime import datetime
from itertools import repeat
from typing import Any

from irc.model.dates import Dates
from irc.model.quantities import Number, exact

CANCELLED = "cancelled"
"""The status of an entry that ended before it was done."""


ABANDONED = "abandoned"
"""The status of an entry that ran for a group that is given up."""


BEGUN = "begun"
"""The status of an entry that was observed to begin at the very instant of a replanning."""


LeftOut = str | tuple[str, bool | str]
"""An action, or a goal on state: a variable and its value."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One occurrence of an action. Times are in the task's unit; resources map to amounts held."""

    id: str
    start: Number
    end: Number
    resources: Mapping[str, int] = field(default_factory=dict)
    mode: str | None = None
    occurrence: int = 1
    rank: int = 0
    end_rank: int | None = None
    status: str | None = None
    paused: Number = field(default=0, compare=False)
    """The closed time between its start and its end, in which its work pauses."""
    dates: Dates | None = field(default=None, compare=False, repr=False)
    """The dates of its task, where this has an origin."""

    @property
    def start_at(self) -> datetime | None:
        """Its start as a date-time, in the zone of the task's dates; None without an origin.

        Raises `irc.TimeError` beyond the years 1 to 9999.
        """
        return None if self.dates is None else self.dates.at(self.start)

    @property
    def end_at(self) -> datetime | None:
        """Its end as a date-time; see `start_at`."""
        return None if self.dates is None else self.dates.at(self.end)

    @property
    def last_rank(self) -> int:
        """The rank of its end: where none is given, that of its start."""
        return self.rank if self.end_rank is None else self.end_rank

    @property
    def duration(self) -> Number:
        """The time from its start to its end."""
        length = self.end - self.start
        return length if isinstance(length, int) else exact(length)


_AT_ONCE = 2_000
"""Entries that are filled at once: so few that they stay in the processor's cache."""


def plain_entries(rows: Sequence[tuple[int, int, str]]) -> tuple[Entry, ...]:
    """Entries of actions that hold nothing, each of a start, an end and an id.

    A call of `Entry` for each would take four times as long, and there may be a million.
    """
    entries = tuple(map(object.__new__, repeat(Entry, len(rows))))
    setters = {field.name: vars(Entry)[field.name].__set__ for field in fields(Entry)}
    defaults = {field.name: field.default for field in fields(Entry)}
    for at in range(0, len(rows), _AT_ONCE):
        some = entries[at : at + _AT_ONCE]
        starts, ends, ids = zip(*rows[at : at + _AT_ONCE], strict=True)
        given: dict[str, Iterable[Any]] = {"id": ids, "start": starts, "end": ends}
        given["resources"] = [{} for _ in ids]
        for name, setter in setters.items():
            deque(map(setter, some, given.get(name, repeat(defaults[name]))), maxlen=0)
    return entries
