"""The rows of an analysis: exact numbers in the task's time unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from fractions import Fraction

from irc.model.quantities import Number
from irc.reporting.closed import Interval, Levels

Key = tuple[str, int]
"""An occurrence: the id of the action and its number."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Why an occurrence starts when it does, and not earlier.

    `kind` is "origin", "release", "start", "earliest_end", "precedence", "max_lag", "resource",
    "capacity", "setup", "closed", "stock", "state", "world" or "occurrence". `after` is the
    occurrence that it waits for, if it is one; `resource` the resource, stock, state variable or
    calendar. A reason that is not `tight` holds it back to an earlier time, from which on it waits
    for an open time.
    """

    kind: str
    text: str
    after: Key | None = None
    resource: str | None = None
    tight: bool = True


@dataclass(frozen=True, slots=True)
class ActionRow:
    """An occurrence of an action.

    `slack` is how much later it could start without a later makespan, in the same order on every
    resource; None where that is not known (choices, state, stock or calendars). `critical`: it has
    no slack; or, where slack is not known, a chain of waits leads from it to the makespan.
    `lateness` is its end less its due date, None where it has none.
    """

    action: str
    occurrence: int
    label: str
    start: Number
    end: Number
    duration: Number
    paused: Number
    mode: str | None
    resources: Mapping[str, int]
    orders: tuple[str, ...]
    release: Number
    due: Number | None
    lateness: Number | None
    slack: Number | None
    critical: bool
    status: str | None
    why: tuple[Reason, ...]

    @property
    def key(self) -> Key:
        """Its action and its number."""
        return self.action, self.occurrence


@dataclass(frozen=True, slots=True)
class OrderRow:
    """A group, or an occurrence of an action with a due date of its own (`kind` "action").

    `start` and `end` are None, and so is all that follows from them, where it is not present.
    `lateness` is its end less its due date, `tardiness` what of that is above 0 (not times the
    weight). `critical` are the occurrences that its end waits for, one after the other, at most the
    last 100 of them.
    """

    order: str
    kind: str
    label: str
    actions: int
    present: bool
    start: Number | None
    end: Number | None
    release: Number
    due: Number | None
    deadline: Number | None
    weight: int
    lateness: Number | None
    tardiness: Number | None
    critical: tuple[Key, ...]
    occurrence: int = 1


@dataclass(frozen=True, slots=True)
class ResourceRow:
    """A renewable resource from t = 0 to the makespan.

    `busy`, `setup`, `idle` and `closed` are lengths of time, which add up to the makespan: closed
    is it where it has no capacity, busy where else something holds it. `used` is the amount held
    times the time, while it is open; `utilisation` is the part of its capacity that `used` is.
    """

    resource: str
    label: str
    capacity: int
    actions: int
    busy: Number
    setup: Number
    idle: Number
    closed: Number
    used: Number
    utilisation: Fraction | None
    setups: int
    setup_cost: int


@dataclass(frozen=True, slots=True)
class DayRow:
    """A day by the clock of the dates: what starts, ends and is due, and the use of each resource.

    `start` and `end` are its part of the schedule; `used` is as in `ResourceRow`.
    """

    day: datetime
    start: Number
    end: Number
    begun: int
    ended: int
    due: int
    late: int
    used: Mapping[str, Number]


@dataclass(frozen=True, slots=True)
class SetupRow:
    """A set-up of a resource, drawn right before the use that it is for."""

    resource: str
    start: Number
    end: Number
    before: Key | None
    after: Key
    cost: int


@dataclass(frozen=True, slots=True)
class Pauses:
    """The closed times within an occurrence, in which its work pauses."""

    action: str
    occurrence: int
    spans: tuple[Interval, ...]


@dataclass(frozen=True, slots=True)
class Load:
    """The amount of a renewable resource that is held, and its capacity, over time."""

    resource: str
    load: Levels
    capacity: Levels
    closed: tuple[Interval, ...]


@dataclass(frozen=True, slots=True)
class Stock:
    """The level of a reservoir over time, after all changes of an instant."""

    resource: str
    levels: Levels
    least: int
    greatest: int | None


@dataclass(frozen=True, slots=True)
class State:
    """The value of a state variable, or the level of a number variable, over time."""

    variable: str
    is_number: bool
    values: tuple[tuple[Number, bool | str | Number], ...]
