"""What a solver needs: the task in whole ticks, in a fixed order, with the way back.

A `Problem` is made by `irc.lowering.lower` and refined by `irc.passes`; nothing downstream reads a `Task`.
All times are integers in ticks; `tick` says how many of the task's time units one tick is.
Actions, resources and arcs are referred to by index; the canonical order (by id) makes the same
task give the same bytes, however its arrays were written.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from irc.diagnostics.source import Pointer
from irc.model.times import Number, exact, format_number

if TYPE_CHECKING:
    from irc.problem.decisions import Placed


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


class Mode(NamedTuple):
    """One way to carry out an activity; a fixed duration has both the same."""

    id: str
    duration_min: int
    duration_max: int


class StockChange(NamedTuple):
    """What an activity puts into a reservoir at one of its ends; a negative amount takes."""

    reservoir: int
    amount: int
    at_end: bool


class Condition(NamedTuple):
    """`var` (index) has `value` (index into its values) at the start, throughout, or at the end.

    `at` is "start", "all" or "end".
    """

    var: int
    value: int
    at: str


class Effect(NamedTuple):
    """`var` (index) gets `value` (index into its values) at the start or the end."""

    var: int
    value: int
    at_end: bool


class Ranks(NamedTuple):
    """The ranks of a start and an end that have been; None where a rank is still to be found.

    `at_least`: the start has that rank or a higher one. (What runs for a fixed duration ends with
    the rank of its start, and must not be too early in the order of that instant.)
    """

    start: int | None
    end: int | None
    at_least: bool = False


@dataclass(frozen=True, slots=True)
class Details:
    """What most activities do without.

    `optional`: it may be absent. `repeats`: the least and the greatest number of occurrences
    (None: no greatest) where more than one is possible; `irc.passes.unroll` makes an activity of
    each, the k-th with `occurrence` k and the index of the one before as `previous`.

    With `modes` exactly one is chosen. `use_modes` says for each of the activity's `uses` in which
    mode (index) it is held, None: in all; empty stands for all None.

    `ranks` are those that its start and its end are known to have; where it starts at the time of
    `not_before`, (time, rank), its start has that rank at least.
    """

    optional: bool = False
    repeats: tuple[int, int | None] | None = None
    occurrence: int = 1
    previous: int | None = None
    modes: tuple[Mode, ...] = ()
    use_modes: tuple[int | None, ...] = ()
    ranks: Ranks | None = None
    not_before: tuple[int, int] | None = None
    stock: tuple[StockChange, ...] = ()
    conditions: tuple[Condition, ...] = ()
    effects: tuple[Effect, ...] = ()
    due: int | None = None
    weight: int = 1
    reward: int = 0
    cost: int = 0

    def use_mode(self, use: int) -> int | None:
        """The mode in which a use is held; None: in all."""
        return self.use_modes[use] if self.use_modes else None


PLAIN = Details()


@dataclass(frozen=True, slots=True)
class Activity:
    """An action; every schedule contains it exactly once unless its `details` say otherwise.

    With modes, the durations are the least and the greatest of all modes, and `uses` are the
    activity's own followed by those of each mode.
    """

    id: str
    duration_min: int
    duration_max: int
    release: int = 0
    deadline: int | None = None
    start: int | None = None
    uses: tuple[Requirement, ...] = ()
    claims: tuple[Claim, ...] = ()
    origin: Pointer = ()
    details: Details = PLAIN

    @property
    def is_fixed(self) -> bool:
        """Whether the solver has no say in the duration."""
        return self.duration_min == self.duration_max


class Window(NamedTuple):
    """Another capacity throughout [start, end)."""

    start: int
    end: int
    capacity: int


@dataclass(frozen=True, slots=True)
class Renewable:
    """A resource of which `capacity` units can be held at once, save in its windows.

    `windows` are in order and do not overlap.
    """

    id: str
    capacity: int
    origin: Pointer = ()
    windows: tuple[Window, ...] = ()


@dataclass(frozen=True, slots=True)
class Reservoir:
    """A stock whose level stays within [least, greatest] (None: no limit) at every instant."""

    id: str
    initial: int
    least: int = 0
    greatest: int | None = None
    origin: Pointer = ()


@dataclass(frozen=True, slots=True)
class Variable:
    """A state variable; `initial` is an index into its `values`."""

    id: str
    values: tuple[bool | str, ...]
    initial: int
    origin: Pointer = ()


@dataclass(frozen=True, slots=True)
class Group:
    """All of its members (activities) or none; a required one is always there."""

    id: str
    members: tuple[int, ...]
    required: bool = True
    reward: int = 0
    due: int | None = None
    weight: int = 1
    origin: Pointer = ()


@dataclass(frozen=True, slots=True)
class Shared:
    """What encoders see of resources that are contended for.

    One resource, or a pool of interchangeable ones: `members` (indexes into `Problem.resources`)
    are told apart again when an answer is decoded. A pool has no `windows`; of a single resource
    `capacity` is the greatest it ever has, and `base` what it has outside of them.
    """

    id: str
    capacity: int
    members: tuple[int, ...]
    base: int | None = None
    windows: tuple[Window, ...] = ()

    @property
    def least_capacity(self) -> int:
        """What there is at every instant."""
        base = self.capacity if self.base is None else self.base
        return min((base, *(w.capacity for w in self.windows)))


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


class Earlier(NamedTuple):
    """Where an earlier schedule has an activity: its start, the index of its mode, and the
    resource (index) of each of its uses, None where the mode has no such use.
    """

    start: int
    mode: int | None
    resources: tuple[int | None, ...]


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

    `goals` are (variable, value) pairs, `wanted` the activities that must be present, `objectives`
    the names of what counts, in order ("makespan", "tardiness", "reward", "cost",
    "changes"). `sequel` holds pairs of activities of which state says, through `arcs`, that the
    second starts when the first has ended, at the same time if need be but at a higher rank.

    `heads[i]` is the earliest start of activity i, `tails[i]` the least time between its end and
    the end of the schedule; both follow from precedence, lags and releases alone.

    `earlier` (empty, or one for each activity) says where an earlier schedule has what may move,
    of an action that repeats the first occurrence, and `recurring` by activity the others;
    `start_from` is a schedule (empty, or one place for each activity) that engines may start from;
    `stability` is how much worse, as a fraction, the last objective before "changes" may get to
    move fewer.
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
    reservoirs: tuple[Reservoir, ...] = ()
    variables: tuple[Variable, ...] = ()
    groups: tuple[Group, ...] = ()
    goals: tuple[tuple[int, int], ...] = ()
    wanted: tuple[int, ...] = ()
    objectives: tuple[str, ...] = ("makespan",)
    sequel: tuple[tuple[int, int], ...] = ()
    earlier: tuple[Earlier | None, ...] = ()
    recurring: Mapping[int, tuple[Earlier, ...]] = field(default_factory=dict)
    start_from: tuple[Placed, ...] = ()
    stability: Fraction = Fraction(0)

    def to_units(self, ticks: int) -> Number:
        """Ticks → the task's time unit, exactly."""
        if self.tick.denominator == 1:
            return ticks * self.tick.numerator
        return exact(ticks * self.tick)

    def time_text(self, ticks: int) -> str:
        """A time as messages show it: in the task's unit, which it names."""
        return f"{format_number(self.to_units(ticks))} {self.time_unit}"

    def effective_deadline(self, index: int) -> int | None:
        """The tighter of an activity's own deadline and the task's, in ticks."""
        own = self.activities[index].deadline
        if own is None or self.deadline is None:
            return self.deadline if own is None else own
        return min(own, self.deadline)

    @property
    def levels(self) -> tuple[str, ...]:
        """The objectives, and behind them the changes to an earlier schedule, if there is one."""
        if not any(self.earlier) or "changes" in self.objectives:
            return self.objectives
        return (*self.objectives, "changes")

    @property
    def is_plain(self) -> bool:
        """Whether every schedule has each activity once, in one way, and no state or stock."""
        return not (self.groups or self.variables or self.reservoirs) and all(
            a.details is PLAIN or not _decides(a.details) for a in self.activities
        )

    @property
    def has_calendars(self) -> bool:
        """Whether some resource has another capacity at times."""
        return any(resource.windows for resource in self.resources)

    @property
    def has_contention(self) -> bool:
        """Whether anything is left for a solver to decide besides times."""
        return any(activity.claims for activity in self.activities) or not self.is_plain


def _decides(details: Details) -> bool:
    return (
        details.optional
        or details.repeats is not None
        or details.previous is not None
        or bool(details.modes or details.stock or details.conditions or details.effects)
    )
