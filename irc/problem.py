"""What a solver needs: the task in whole ticks, in a fixed order, with the way back.

A `Problem` is made by `irc.lower` and refined by `irc.passes`; nothing downstream reads a `Task`.
All times are integers in ticks; `tick` says how many of the task's time units one tick is.
Actions, resources and arcs are referred to by index; the canonical order (by id) makes the same
task give the same bytes, however its arrays were written.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import NamedTuple

from irc.source import Pointer
from irc.times import Number, exact


class Requirement(NamedTuple):
    """Holds `amount` units of one of the `alternatives` (indexes into `Problem.resources`).

    `origin` is the index of the entry in the source's `uses`.
    """

    alternatives: tuple[int, ...]
    amount: int
    origin: int = 0


class Claim(NamedTuple):
    """A requirement that a solver must still see to.

    `use` is the index in the activity's `uses`; the `alternatives` index `Problem.shared`.
    """

    use: int
    alternatives: tuple[int, ...]
    amount: int


@dataclass(frozen=True, slots=True)
class Activity:
    """An action that every schedule contains exactly once."""

    id: str
    duration_min: int
    duration_max: int
    release: int = 0
    deadline: int | None = None
    start: int | None = None
    uses: tuple[Requirement, ...] = ()
    claims: tuple[Claim, ...] = ()
    origin: Pointer = ()

    @property
    def is_fixed(self) -> bool:
        """Whether the solver has no say in the duration."""
        return self.duration_min == self.duration_max


@dataclass(frozen=True, slots=True)
class Renewable:
    """A resource of which `capacity` units can be held at once."""

    id: str
    capacity: int
    origin: Pointer = ()


@dataclass(frozen=True, slots=True)
class Shared:
    """What encoders see of resources that are contended for.

    One resource, or a pool of interchangeable ones: `members` (indexes into `Problem.resources`)
    are told apart again when an answer is decoded.
    """

    id: str
    capacity: int
    members: tuple[int, ...]


class Arc(NamedTuple):
    """`min_lag <= point(after) - point(before) <= max_lag`, each point a start or an end.

    `origin` is the index of the precedence in the source.
    """

    before: int
    after: int
    from_end: bool = True
    to_end: bool = False
    min_lag: int = 0
    max_lag: int | None = None
    origin: int = 0


@dataclass(frozen=True, slots=True)
class Bound:
    """A proven lower bound on the makespan, in ticks, and the argument that gave it."""

    value: int
    reason: str


@dataclass(frozen=True, slots=True)
class Problem:
    """The task as integers.

    `uses` and `resources` are what the user wrote; `claims` and `shared` are what of it is still
    to be decided, which passes make smaller. `settled` holds choices that passes could make
    without loss: (activity, use) → resource.

    `heads[i]` is the earliest start of activity i, `tails[i]` the least time between its end and
    the end of the schedule; both follow from precedence, lags and releases alone.
    """

    name: str | None
    time_unit: str
    tick: Fraction
    activities: tuple[Activity, ...]
    resources: tuple[Renewable, ...] = ()
    shared: tuple[Shared, ...] = ()
    arcs: tuple[Arc, ...] = ()
    deadline: int | None = None
    settled: Mapping[tuple[int, int], int] = field(default_factory=dict)
    heads: tuple[int, ...] = ()
    tails: tuple[int, ...] = ()
    bound: Bound = Bound(0, "no schedule ends before it starts")

    def to_units(self, ticks: int) -> Number:
        """Ticks → the task's time unit, exactly."""
        if self.tick.denominator == 1:
            return ticks * self.tick.numerator
        return exact(ticks * self.tick)

    def effective_deadline(self, index: int) -> int | None:
        """The tighter of an activity's own deadline and the task's, in ticks."""
        own = self.activities[index].deadline
        if own is None or self.deadline is None:
            return self.deadline if own is None else own
        return min(own, self.deadline)

    @property
    def has_contention(self) -> bool:
        """Whether anything is left for a solver to decide besides times."""
        return any(activity.claims for activity in self.activities)
