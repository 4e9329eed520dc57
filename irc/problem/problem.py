"""The problem that solvers get: the task in whole ticks, in a fixed order, with the way back.

`irc.lowering` makes a `Problem`, `irc.passes` refine it; no later stage reads a `Task`.
All times are integers in ticks; `tick` is the length of a tick in the task's time unit. Actions,
resources and arcs are referred to by index. The canonical order (by id) makes the same task give
the same bytes, however its arrays were written.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from irc.diagnostics.source import Pointer
from irc.model.quantities import Number, exact
from irc.model.state_values import limits_text
from irc.model.times import format_number

if TYPE_CHECKING:
    from irc.problem.decisions import Placed


NO_FAMILY = -1
"""The family of a use that names none."""

ANY_FAMILY = -2
"""In a row of set-ups, any family that the other one is not."""


class Requirement(NamedTuple):
    """Holds `amount` units of one of the `alternatives` (indexes into `Problem.resources`).

    `origin` is the index of the entry in the source's `uses`; `family` (an index into
    `Problem.families`) is what set-ups of the resource depend on.
    """

    alternatives: tuple[int, ...]
    amount: int
    origin: int = 0
    family: int = NO_FAMILY


class OpenDemand(NamedTuple):
    """A use of a resource that a solver still has to decide on.

    `use` is the index in the activity's `uses`; the `alternatives` index `Contention.pools`.
    """

    use: int
    alternatives: tuple[int, ...]
    amount: int


class StockChange(NamedTuple):
    """A change of a reservoir by an activity at one of its ends; a negative amount takes."""

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


def _is_within(level: int, least: int | None, greatest: int | None) -> bool:
    return (least is None or level >= least) and (greatest is None or level <= greatest)


class NumberCondition(NamedTuple):
    """The number `number` (index) is within [least, greatest] at the start, throughout, or at the
    end; None: no limit. `at` is "start", "all" or "end".
    """

    number: int
    least: int | None
    greatest: int | None
    at: str

    def allows(self, level: int) -> bool:
        """Whether a level is within the limits."""
        return _is_within(level, self.least, self.greatest)


class NumberEffect(NamedTuple):
    """The number `number` (index) changes by `amount` at the start or the end, or, if it `sets`,
    becomes `amount`.
    """

    number: int
    amount: int
    sets: bool
    at_end: bool


def together(effects: Iterable[NumberEffect]) -> tuple[NumberEffect, ...]:
    """Effects on numbers: all that one end of an activity adds to one is a sum."""
    found: dict[tuple[int, bool, bool, int], int] = {}
    for number, amount, sets, at_end in effects:
        key = number, at_end, sets, amount if sets else 0
        found[key] = amount if sets else found.get(key, 0) + amount
    return tuple(
        NumberEffect(number, amount, sets, at_end)
        for (number, at_end, sets, _), amount in sorted(found.items())
    )


class NumberGoal(NamedTuple):
    """In the end the number `number` (index) is within [least, greatest]; None: no limit."""

    number: int
    least: int | None
    greatest: int | None

    def allows(self, level: int) -> bool:
        """Whether a level is within the limits."""
        return _is_within(level, self.least, self.greatest)


class Mode(NamedTuple):
    """One way to carry out an activity; a fixed duration has both the same.

    Its stock, conditions, effects and cost come on top of the activity's own.
    """

    id: str
    duration_min: int
    duration_max: int
    stock: tuple[StockChange, ...] = ()
    conditions: tuple[Condition, ...] = ()
    effects: tuple[Effect, ...] = ()
    number_conditions: tuple[NumberCondition, ...] = ()
    number_effects: tuple[NumberEffect, ...] = ()
    cost: int = 0

    @property
    def bare(self) -> Mode:
        """The mode with its durations alone."""
        return Mode(self.id, self.duration_min, self.duration_max)


class Ranks(NamedTuple):
    """The ranks of an executed start and end; None where a rank is still to be found.

    `at_least`: the start has that rank or a higher one. (A running activity of fixed duration ends
    with the rank of its start, and must not come too early in the order of that instant.)
    """

    start: int | None
    end: int | None
    at_least: bool = False


class Protected(NamedTuple):
    """While `activity` (index) runs, `var` does not lose `value` (both indexes) where it has it.

    The activity needs the value throughout and has lost it; who has this in its `protects` does not
    take the value away again.
    """

    activity: int
    var: int
    value: int


@dataclass(frozen=True, slots=True)
class Details:
    """The rare fields of an activity, which most activities do not need.

    `optional`: it may be absent. `repeats`: the least and the greatest number of occurrences
    (None: no greatest) where more than one is possible; `irc.passes.unroll` makes an activity of
    each, the k-th with `occurrence` k and the index of its predecessor as `previous_occurrence`.

    With `modes` exactly one is chosen; each may have stock, conditions, effects and a cost besides
    those here, which are of every mode (see `in_mode`, `all_stock` and so on). `use_modes` says for
    each of the activity's `uses` in which mode (index) it is held, None: in all; empty stands for
    all None.

    `entered` is its release as the task says it, from which flow time counts (None where it does
    not count).

    `ranks` are those that its start and its end are known to have; where it starts at the time of
    `not_before`, (time, rank), its start has that rank at least, and changes stock behind all that
    ended then.

    With a `calendar` (index into `Problem.calendars`) it starts, lasts and ends at open times. If
    it pauses, `work` has its least and greatest working time, one pair for each mode or one alone.
    Closed times come on top of that, `max_pause` of them at most, so its durations only limit the
    time from start to end. One that has begun has `paused` instead: its times are known.
    """

    optional: bool = False
    repeats: tuple[int, int | None] | None = None
    occurrence: int = 1
    previous_occurrence: int | None = None
    modes: tuple[Mode, ...] = ()
    use_modes: tuple[int | None, ...] = ()
    ranks: Ranks | None = None
    not_before: tuple[int, int] | None = None
    calendar: int | None = None
    work: tuple[tuple[int, int], ...] = ()
    max_pause: int | None = None
    paused: bool = False
    stock: tuple[StockChange, ...] = ()
    conditions: tuple[Condition, ...] = ()
    effects: tuple[Effect, ...] = ()
    number_conditions: tuple[NumberCondition, ...] = ()
    number_effects: tuple[NumberEffect, ...] = ()
    protects: tuple[Protected, ...] = ()
    due: int | None = None
    weight: int = 1
    reward: int = 0
    cost: int = 0
    entered: int | None = None

    @property
    def touches_state(self) -> bool:
        """Whether it has conditions or effects, on variables or on numbers, in any mode."""
        return bool(
            self.all_conditions
            or self.all_effects
            or self.all_number_conditions
            or self.all_number_effects
        )

    def use_mode(self, use: int) -> int | None:
        """The mode in which a use is held; None: in all."""
        return self.use_modes[use] if self.use_modes else None

    @property
    def keeps_units(self) -> bool:
        """Whether it keeps its units while a resource has no capacity."""
        return bool(self.work) or self.paused

    def in_mode(self, mode: int | None) -> Details:
        """The details with what a mode (index) adds among their own; the modes become bare.

        None: as they are.
        """
        if mode is None or self.modes[mode] == self.modes[mode].bare:
            return self
        own = self.modes[mode]
        return replace(
            self,
            modes=tuple(m.bare for m in self.modes),
            stock=tuple(sorted(self.stock + own.stock)),
            conditions=tuple(sorted({*self.conditions, *own.conditions})),
            effects=tuple(sorted({*self.effects, *own.effects})),
            number_conditions=(*self.number_conditions, *own.number_conditions),
            number_effects=together((*self.number_effects, *own.number_effects)),
            cost=self.cost + own.cost,
        )

    @property
    def ways(self) -> tuple[Details, ...]:
        """The details in each mode; the details themselves where there are no modes."""
        return tuple(self.in_mode(m) for m in range(len(self.modes))) or (self,)

    @property
    def all_stock(self) -> tuple[StockChange, ...]:
        """The changes of stock of the activity and of all its modes, of which one is chosen."""
        return self.stock + tuple(c for mode in self.modes for c in mode.stock)

    @property
    def all_conditions(self) -> tuple[Condition, ...]:
        """The conditions of the activity and of all its modes, of which one is chosen."""
        return self.conditions + tuple(c for mode in self.modes for c in mode.conditions)

    @property
    def all_effects(self) -> tuple[Effect, ...]:
        """The effects of the activity and of all its modes, of which one is chosen."""
        return self.effects + tuple(e for mode in self.modes for e in mode.effects)

    @property
    def all_number_conditions(self) -> tuple[NumberCondition, ...]:
        """The conditions on numbers of the activity and of all its modes."""
        return self.number_conditions + tuple(c for m in self.modes for c in m.number_conditions)

    @property
    def all_number_effects(self) -> tuple[NumberEffect, ...]:
        """The effects on numbers of the activity and of all its modes, of which one is chosen."""
        return self.number_effects + tuple(e for m in self.modes for e in m.number_effects)

    @property
    def touches_world(self) -> bool:
        """Whether it reads or changes state or stock, in any mode."""
        return bool(self.all_stock) or self.touches_state


PLAIN = Details()

IMPOSSIBLE_DEADLINE = -1
"""The deadline of an activity that must not occur: nothing ends before t = 0."""


class GroupDeadline(NamedTuple):
    """The deadline of a group, where it is the deadline of its members; `origin` is its place."""

    group: str
    origin: Pointer


@dataclass(frozen=True, slots=True)
class Activity:
    """An action; every schedule contains it exactly once unless its `details` say otherwise.

    With modes, the durations are the least and the greatest of all modes, and `uses` are the
    activity's own followed by those of each mode. With a `latest_start` it starts then or earlier,
    with an `earliest_end` it ends then or later.
    `deadline_by` is the group whose deadline `deadline` is; None where it is the activity's own.
    """

    id: str
    duration_min: int
    duration_max: int
    release: int = 0
    deadline: int | None = None
    start: int | None = None
    latest_start: int | None = None
    earliest_end: int | None = None
    deadline_by: GroupDeadline | None = None
    uses: tuple[Requirement, ...] = ()
    open_demands: tuple[OpenDemand, ...] = ()
    origin: Pointer = ()
    details: Details = PLAIN

    def has_ended_by(self, time: int) -> bool:
        """Whether it is known to have started before a time, and to end at it."""
        return (
            self.start is not None
            and self.is_fixed
            and self.start < time == self.start + self.duration_min
        )

    @property
    def deadline_origin(self) -> Pointer:
        """The place of the deadline in the document: the group's, or the activity's own."""
        if self.deadline_by is not None:
            return self.deadline_by.origin
        return (*self.origin, "deadline")

    @property
    def is_fixed(self) -> bool:
        """Whether the duration is fixed, so that no solver chooses it."""
        return self.duration_min == self.duration_max

    def uses_in(self, mode: int | None) -> tuple[int, ...]:
        """The indexes of the uses that apply in a mode (index); None: of those in every mode."""
        if not self.details.use_modes:
            return tuple(range(len(self.uses)))
        return tuple(u for u, m in enumerate(self.details.use_modes) if m is None or m == mode)


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


class TimedChange(NamedTuple):
    """At the tick `at` the world gives a variable a value (index into its values)."""

    at: int
    value: int


@dataclass(frozen=True, slots=True)
class Variable:
    """A state variable; `initial` is an index into its `values`.

    `changes` are in the order of time, no two of them at one time.
    """

    id: str
    values: tuple[bool | str, ...]
    initial: int
    origin: Pointer = ()
    changes: tuple[TimedChange, ...] = ()

    @property
    def known_values(self) -> frozenset[int]:
        """The values that it has at some time if no activity changes it."""
        return frozenset([self.initial, *(change.value for change in self.changes)])


@dataclass(frozen=True, slots=True)
class NumberVariable:
    """A number that stays within [least, greatest] (None: no limit) after every happening.

    Levels are whole: `scale` of them are 1 in the task. `changes` are in the order of time, no two
    of them at one time; the value of each is the new level.
    """

    id: str
    initial: int
    least: int | None = None
    greatest: int | None = None
    scale: int = 1
    origin: Pointer = ()
    changes: tuple[TimedChange, ...] = ()

    def allows(self, level: int) -> bool:
        """Whether a level is within the bounds."""
        return _is_within(level, self.least, self.greatest)

    def text(self, level: int) -> str:
        """A level as text for messages, as the task writes it."""
        return format_number(exact(Fraction(level, self.scale)))

    def limits_text(self, least: int | None, greatest: int | None) -> str:
        """Limits as text for messages: "at least 10"."""
        low, high = (
            None if level is None else exact(Fraction(level, self.scale))
            for level in (least, greatest)
        )
        return limits_text(low, high)


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


class CoupledChoice(NamedTuple):
    """The choices of an activity that a coupling is about.

    `use` is the place of one of the action's own uses in the source; None: all that it holds.
    `modes` (names, of which one) and `resource` (index) are what an "if" or a "then" says.
    """

    activity: int
    use: int | None = None
    modes: tuple[str, ...] = ()
    resource: int | None = None


class Coupling(NamedTuple):
    """Choices that depend on each other, among present activities.

    `kind` is "same", "different" or "if" (of two members), `what` is "resource" or "mode".
    """

    kind: str
    what: str
    members: tuple[CoupledChoice, ...]
    origin: int = 0

    @property
    def is_about_resources(self) -> bool:
        """Whether it is about what its members hold, not only about their modes."""
        return self.what == "resource" or any(m.resource is not None for m in self.members)


class Selection(NamedTuple):
    """At least `least` and at most `most` (None: all) of the items are present.

    An item is a set of activities that are present together; with a `condition`, which is an item,
    only where that is present. With `all_or_none` it is all of them or none instead.
    """

    items: tuple[tuple[int, ...], ...]
    least: int
    most: int | None
    condition: tuple[int, ...] | None = None
    origin: int = 0
    all_or_none: bool = False


NOBODY = -1
"""In a row of a sequence: no activity of the job holds that resource."""


class UseOrder(NamedTuple):
    """An order of uses of resources of capacity 1, which all have `setups`, perhaps empty ones.

    `kind` is "consecutive" (the one row has two activities, of which the second holds each of the
    `resources` next after the first, if both hold it) or "same_order" (a row for each job, with its
    activity on each resource, or `NOBODY`). Nothing is demanded of the pairs of rows (indexes) that
    are `waived`: while a task runs, their order is history.
    """

    kind: str
    resources: tuple[int, ...]
    rows: tuple[tuple[int, ...], ...]
    origin: int = 0
    waived: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True, slots=True)
class ContendedPool:
    """A contended pool, as encoders see it: one resource, or several interchangeable ones.

    Decoding an answer assigns the `members` (indexes into `Problem.resources`) again. A pool of
    several has no `windows`. For a single resource, `capacity` is its greatest capacity, and `base`
    its capacity outside of its windows.
    """

    id: str
    capacity: int
    members: tuple[int, ...]
    base: int | None = None
    windows: tuple[Window, ...] = ()

    @property
    def least_capacity(self) -> int:
        """The capacity that the pool has at every instant."""
        return min((self._outside, *(w.capacity for w in self.windows)))

    @property
    def never_away(self) -> ContendedPool:
        """The pool with all of its capacity where it has none."""
        return replace(
            self,
            base=self._outside or self.capacity,
            windows=tuple(
                window if window.capacity else window._replace(capacity=self.capacity)
                for window in self.windows
            ),
        )

    def levels(self) -> Iterator[tuple[int, int]]:
        """(From when on, capacity), in order of time; the last level stays."""
        return capacity_levels(self._outside, self.windows)

    @property
    def _outside(self) -> int:
        """The capacity outside of the windows."""
        return self.capacity if self.base is None else self.base


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


class Bound(NamedTuple):
    """A proven lower bound on the makespan, in ticks, and the reason for it."""

    value: int
    reason: str


NO_BOUND = Bound(0, "no schedule ends before it starts")


@dataclass(frozen=True, slots=True)
class Contention:
    """The open choices of resources, and the choices that passes fixed without loss.

    Open demands of activities refer to the `pools`. `fixed_choices` are (activity, use) → resource.
    """

    pools: tuple[ContendedPool, ...] = ()
    fixed_choices: Mapping[tuple[int, int], int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Bounds:
    """Proven lower bounds, in ticks.

    `heads[i]` is the earliest start of activity i, `tails[i]` the least time between its end and
    the end of the schedule. Both follow from precedence, lags and releases alone. They are empty
    until a pass has found them.
    """

    heads: tuple[int, ...] = ()
    tails: tuple[int, ...] = ()
    makespan: Bound = NO_BOUND


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
    contention: Contention = Contention()
    bounds: Bounds = Bounds()
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
