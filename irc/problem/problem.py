"""The problem that solvers get: the task in whole ticks, in a fixed order, with the way back.

`irc.lowering` makes a `Problem`, `irc.passes` refine it; no later stage reads a `Task`.
All times are integers in ticks; `tick` is the length of a tick in the task's time unit. Actions,
resources and arcs are referred to by index. The canonical order (by id) makes the same task give
the same bytes, however its arrays were written.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from irc.model.quantities import Number, exact
from irc.model.times import format_number
from irc.problem.activity import PLAIN, Activity, Details
from irc.problem.contention import NO_BOUNDS, NO_CONTENTION, Bound, Bounds, Contention
from irc.problem.resources import OpenCalendar, Renewable, Reservoir
from irc.problem.rules import Coupling, Group, Selection, UseOrder
from irc.problem.variables import NumberGoal, NumberVariable, TimedChange, Variable

if TYPE_CHECKING:
    from irc.problem.decisions import Placed


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


class PreviousPlace(NamedTuple):
    """The previous place of an activity: its start, the index of its mode, and the resources.

    There is a resource (index) for each of its uses, None where the mode has no such use.
    """

    start: int
    mode: int | None
    resources: tuple[int | None, ...]


@dataclass(frozen=True, slots=True)
class PreviousPlan:
    """The previous plan of a running task: the places of activities that may still move.

    `places` is empty, or has one entry for each activity. For an action that repeats, it is the
    place of the first occurrence; `recurring` has the places of the others by activity.
    `warm_start` is a schedule (empty, or one place for each activity) from which an engine may
    begin. `stability` is how much worse, as a fraction, the last objective before "changes" may
    get so that fewer activities move.
    """

    places: tuple[PreviousPlace | None, ...] = ()
    recurring: Mapping[int, tuple[PreviousPlace, ...]] = field(default_factory=dict)
    warm_start: tuple[Placed, ...] = ()
    stability: Fraction = Fraction(0)


@dataclass(frozen=True, slots=True)
class Problem:
    """The task as integers.

    `activity.uses` and `resources` are those of the task. `activity.open_demands` and `contention`
    are the part of them that is still to be decided, which passes make smaller.

    `goals` are (variable, value) pairs, `number_goals` those on numbers. `required` are the
    activities that must be present.
    `families` are the names of the families of uses, on which set-ups depend.
    `objectives` are the short names of the objectives, in order ("makespan", "tardiness", "reward",
    "cost", "changes", "setup_time", "setup_cost"). `state_precedences` are pairs of activities: by
    state, through `arcs`, the second starts after the end of the first, perhaps at the same time,
    but then at a higher rank.
    `horizon` is a time by which some optimal schedule ends, where calendars had to be cut there.
    """

    name: str | None
    time_unit: str
    tick: Fraction
    activities: tuple[Activity, ...]
    resources: tuple[Renewable, ...] = ()
    families: tuple[str, ...] = ()
    reservoirs: tuple[Reservoir, ...] = ()
    variables: tuple[Variable, ...] = ()
    numbers: tuple[NumberVariable, ...] = ()
    arcs: tuple[Arc, ...] = ()
    groups: tuple[Group, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    selections: tuple[Selection, ...] = ()
    sequences: tuple[UseOrder, ...] = ()
    deadline: int | None = None
    goals: tuple[tuple[int, int], ...] = ()
    number_goals: tuple[NumberGoal, ...] = ()
    required: tuple[int, ...] = ()
    objectives: tuple[str, ...] = ("makespan",)
    state_precedences: tuple[tuple[int, int], ...] = ()
    calendars: tuple[OpenCalendar, ...] = ()
    horizon: int | None = None
    contention: Contention = NO_CONTENTION
    bounds: Bounds = NO_BOUNDS
    previous: PreviousPlan = PreviousPlan()

    @property
    def coupled(self) -> frozenset[int]:
        """The activities whose resources a coupling is about."""
        return frozenset(
            m.activity
            for c in self.couplings
            for m in c.members
            if c.what == "resource" or m.resource is not None
        )

    def with_bound(self, value: int, reason: str) -> Problem:
        """The problem with another lower bound on the makespan."""
        return replace(self, bounds=replace(self.bounds, makespan=Bound(value, reason)))

    def to_units(self, ticks: int) -> Number:
        """Converts ticks to the task's time unit, exactly."""
        if self.tick.denominator == 1:
            return ticks * self.tick.numerator
        return exact(ticks * self.tick)

    def to_ticks(self, time: Number) -> Number:
        """Converts a time of the task's unit to ticks, exactly: a `Fraction` if between two."""
        # Whole numbers all the way: in a large schedule fractions would cost more than the search.
        ticks, rest = divmod(
            time.numerator * self.tick.denominator, time.denominator * self.tick.numerator
        )
        return Fraction(time) / self.tick if rest else ticks

    def whole_ticks(self, time: Number) -> int:
        """Converts a time of the task's unit to ticks. Raises `ValueError` if between two ticks."""
        ticks = self.to_ticks(time)
        if not isinstance(ticks, int):
            raise ValueError(f"{time} is not a whole number of ticks of {self.tick}")
        return ticks

    def time_text(self, ticks: int) -> str:
        """A time as text for messages, with the task's unit."""
        return f"{format_number(self.to_units(ticks))} {self.time_unit}"

    def effective_deadline(self, index: int) -> int | None:
        """The tighter of an activity's own deadline and the task's, in ticks."""
        own = self.activities[index].deadline
        if own is None or self.deadline is None:
            return self.deadline if own is None else own
        return min(own, self.deadline)

    @property
    def levels(self) -> tuple[str, ...]:
        """The objectives, followed by the changes to the previous plan, if there is one."""
        if not any(self.previous.places) or "changes" in self.objectives:
            return self.objectives
        return (*self.objectives, "changes")

    @property
    def is_plain_but_loads(self) -> bool:
        """Whether it would be plain if its batch resources were renewable ones."""
        return self.has_batches and replace(self, resources=()).is_plain

    @property
    def is_plain(self) -> bool:
        """Whether every schedule has each activity once, in one way, and there are no state, stock,
        loads or orders of uses.
        """
        return not (
            self.couplings
            or self.selections
            or self.sequences
            or self.groups
            or self.has_state
            or self.reservoirs
            or self.has_batches
        ) and all(a.details is PLAIN or not _decides(a.details) for a in self.activities)

    @property
    def timed_changes(self) -> Iterator[TimedChange]:
        """All timed changes, of variables and of numbers."""
        for variable in self.variables:
            yield from variable.changes
        for number in self.numbers:
            yield from number.changes

    @property
    def has_state(self) -> bool:
        """Whether it has state variables or numbers, so that the ranks of happenings count."""
        return bool(self.variables or self.numbers)

    @property
    def is_regular(self) -> bool:
        """Whether no objective gets better by a later end: then the earliest times are best."""
        return not any("earliness" in name for name in self.objectives)

    @property
    def has_calendars(self) -> bool:
        """Whether some resource has a calendar, or an action has one or pauses."""
        return bool(self.calendars) or any(resource.windows for resource in self.resources)

    @property
    def has_work(self) -> bool:
        """Whether some activity has a calendar, or pauses at closed times."""
        return any(
            a.details is not PLAIN and (a.details.calendar is not None or a.details.work)
            for a in self.activities
        )

    @property
    def has_setups(self) -> bool:
        """Whether some resource has set-ups."""
        return any(resource.setups is not None for resource in self.resources)

    @property
    def has_batches(self) -> bool:
        """Whether some resource takes loads."""
        return any(resource.batch for resource in self.resources)

    @property
    def has_contention(self) -> bool:
        """Whether a solver has anything to decide besides the earliest times."""
        return (
            any(activity.open_demands for activity in self.activities)
            or not self.is_plain
            or not self.is_regular
            or self.has_work
        )


def _decides(details: Details) -> bool:
    return (
        details.optional
        or details.repeats is not None
        or details.previous_occurrence is not None
        or bool(details.modes or details.stock)
        or details.touches_state
    )
