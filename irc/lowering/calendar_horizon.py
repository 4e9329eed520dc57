"""How far calendars are expanded: some optimal schedule ends by then, if there is any schedule.

Fix the choices and the order on every resource as some optimal schedule has them. In its earliest
schedule with these, each start waits for a fixed time (a release, the end of a window, an event) or
for a happening of another activity, and then for its own open time. So every time is reached by a
path that visits each activity at most once. With `F(t)` the latest time at which any of them ends
that begins when it can from t on, each step of the path leads from t at most to F(t): F grows with
t, so n steps from the last fixed time lead at most to F applied n times. A lag, or an activity
without a calendar, is a step of its own kind. Maximum lags can make activities wait together for
open times that suit them all; these come at the latest after the calendars' common period.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice, product
from math import ceil

from irc.lowering.calendars import Interval, OpenTimes, calendars_by_id, point
from irc.model import Action, Calendar, ClosedTime, DurationRange, Task
from irc.model.parts import Duration
from irc.model.quantities import DAY, Number, TimeError, exact
from irc.model.times import Clock, Instant, common_tick

YEAR_AND_A_WEEK = 374 * DAY
"""Seconds within which every kind of open time of a calendar of days has come: a year has each
change of clocks, and a week each day."""

WEEK_AND_A_DAY = 8 * DAY
"""Seconds: the period of calendars of days, and room for a change of clocks."""

GREATEST_PERIOD = 10_000
"""At most this many cycles of a calendar are looked at for its common period with others."""

MOST_WINDOWS = 50_000
"""A calendar with more open times until the horizon is refused."""

COMBINATIONS = 1000
"""At most this many combinations of calendars of one action are looked at."""


@dataclass(frozen=True)
class Need:
    """Open time that an action may wait for: at once for `length`, or with pauses."""

    calendars: frozenset[str]
    length: Number
    pauses: bool = False
    max_pause: Number | None = None


@dataclass
class CalendarTimes:
    """The open times of the calendars of a task, and of what several of them have in common."""

    task: Task
    clock: Clock
    _joint: dict[frozenset[str], OpenTimes] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.by_id = calendars_by_id(self.task)

    def of(self, names: frozenset[str]) -> OpenTimes:
        """The times at which all of some calendars are open; unknown names are left out."""
        if names not in self._joint:
            found = [self.by_id[name] for name in sorted(names) if name in self.by_id]
            self._joint[names] = OpenTimes(found, self.clock)
        return self._joint[names]

    def end(self, need: Need, start: Number) -> Number | None:
        """The earliest end of a need that starts at a time or later; None if it never fits."""
        times, span = self.of(need.calendars), self.search_span(need.calendars)
        limit = start + span + _work_span(need, span)
        at = min(limit, start + need.length + self.short_span)
        while True:
            found = _end(times.until(at), need, start)
            if found is not None and found <= times.reached:
                return found
            if times.reached >= limit:
                return None
            at = min(limit, 2 * times.reached)

    @property
    def size(self) -> int:
        """The greatest number of open times that are known of a calendar, or of several at once."""
        return max((times.size for times in self._joint.values()), default=0)

    @property
    def short_span(self) -> Number:
        """The time that is looked at first."""
        return self._units(WEEK_AND_A_DAY)

    def search_span(self, names: Iterable[str]) -> Number:
        """The time within which every kind of open time of these calendars has come."""
        return self._span(names, YEAR_AND_A_WEEK)

    def period(self, names: Iterable[str]) -> Number:
        """The time after which these calendars are open at the same times again."""
        return self._span(names, WEEK_AND_A_DAY)

    def _span(self, names: Iterable[str], of_days: int) -> Number:
        cycles = [
            Fraction(self.clock.exact(c.every)) for c in self._known(names) if c.every is not None
        ]
        days = any(c.every is None for c in self._known(names))
        together = _common_period([*cycles, *([Fraction(self._units(7 * DAY))] if days else [])])
        return exact(
            together + Fraction(self._units(of_days) if days else 0) + max([Fraction(0), *cycles])
        )

    def _known(self, names: Iterable[str]) -> Iterator[Calendar]:
        return (self.by_id[name] for name in names if name in self.by_id)

    def _units(self, seconds: int) -> Number:
        return exact(Fraction(seconds) / self.clock.unit)


def _common_period(periods: list[Fraction]) -> Fraction:
    """The least time that is a multiple of every period, within bounds."""
    positive = [period for period in periods if period > 0]
    if not positive:
        return Fraction(0)
    tick = common_tick(exact(p) for p in positive)
    together = 1
    for period in positive:
        steps = int(period / tick)
        together = together * steps // _gcd(together, steps)
    return min(together * tick, GREATEST_PERIOD * max(positive))


def _gcd(a: int, b: int) -> int:
    while b:
        a, b = b, a % b
    return a


def _work_span(need: Need, span: Number) -> Number:
    """More time that work with pauses may need, however few open times there are."""
    return need.length * 8 + span if need.pauses else need.length


def _end(times: list[Interval], need: Need, start: Number) -> Number | None:
    """The earliest end of a need within known open times."""
    first = _first_after(times, start)
    for k in range(first, len(times)):
        begin = max(start, times[k][0])
        if not need.pauses or not need.length:
            if begin + need.length <= times[k][1] and begin < times[k][1]:
                return begin + need.length
            continue
        end = _end_of_work(times, k, begin, need.length)
        if end is None:
            return None
        if need.max_pause is None or end - begin - need.length <= need.max_pause:
            return end
    return None


def _first_after(times: list[Interval], start: Number) -> int:
    """The index of the first interval that ends after a time."""
    low, high = 0, len(times)
    while low < high:
        middle = (low + high) // 2
        if times[middle][1] <= start:
            low = middle + 1
        else:
            high = middle
    return low


def _end_of_work(times: list[Interval], k: int, begin: Number, length: Number) -> Number | None:
    left = length
    for start, end in islice(times, k, None):
        start = max(start, begin)
        if end - start >= left:
            return start + left
        left -= end - start
    return None


def needs_of(task: Task, clock: Clock) -> Iterator[tuple[Action, list[Need]]]:
    """For each action, the open times that it may need: one for each way to carry it out."""
    by_resource = {r.id: r.calendar for r in task.resources if r.kind != "reservoir"}
    for action in task.actions:
        yield action, list(dict.fromkeys(_needs(action, by_resource, clock)))


def _needs(action: Action, by_resource: dict[str, str | None], clock: Clock) -> Iterator[Need]:
    own = [action.calendar] if action.calendar is not None else []
    pauses = action.breaks == "pause"
    max_pause = _number(action.max_pause, clock)
    for mode in action.modes or (None,):
        length = _longest(action.duration if mode is None else mode.duration, clock)
        held = [*action.uses, *(() if mode is None else mode.uses)] if length else []
        choices = [dict.fromkeys(by_resource.get(r) for r in use.alternatives) for use in held]
        for chosen in islice(product(*(c for c in choices if c)), COMBINATIONS):
            names = frozenset(name for name in (*own, *chosen) if name is not None)
            yield Need(names, length, pauses, max_pause if pauses else None)


def _number(value: Instant | None, clock: Clock) -> Number | None:
    if value is None:
        return None
    try:
        return clock.number(value)
    except TimeError:
        return None


def _longest(duration: Duration | None, clock: Clock) -> Number:
    longest = duration.max if isinstance(duration, DurationRange) else duration
    return max(0, _number(longest, clock) or 0)


def horizon(
    task: Task,
    times: CalendarTimes,
    instants: Iterable[Number] = (),
    deadline: Number | None = None,
) -> Number:
    """The time up to which the calendars of a task are expanded, in its unit.

    No later than its deadline, but for `instants`: what runs may have to end after it.
    """
    clock, instants = task.clock, [*instants]
    steps, shifts, kinds = 0, list[Number](), set[Need]()
    for action, needs in needs_of(task, clock):
        often = action.occurrence_bounds[1]
        occurrences = max(1, min(often if often is not None else UNLIMITED, UNLIMITED))
        steps += occurrences
        kinds.update(need for need in needs if need.calendars)
        free = max((need.length for need in needs if not need.calendars), default=0)
        shifts += [free] * occurrences if free else []
    shifts += _lags(task, clock)
    start = _last_fixed_time(task, times, instants)
    rare = {need for need in kinds if _is_rare(times, need, start)}
    kinds -= rare
    found = _after_steps(times, _possible(times, kinds, start), start, steps, shifts)
    found = max(found, start + times.period(times.by_id))
    if rare:
        seldom = sum(not rare.isdisjoint(needs) for _, needs in needs_of(task, clock))
        longest = max(need.length for need in rare)
        found += seldom * (times.search_span(times.by_id) + longest)
    together = sum(edge.max_lag is not None for edge in task.precedence)
    if together:
        found += together * times.period(times.by_id)
    if deadline is not None:
        found = min(found, max([deadline, *instants]))
    return found


UNLIMITED = 64
"""The number of occurrences that is assumed of an action that may occur without end."""


def _is_rare(times: CalendarTimes, need: Need, start: Number) -> bool:
    """Whether a need waits for an open time that comes far more seldom than its calendars repeat.

    (A night of 9 hours comes once a year. Only the activities that need it wait so long.)
    """
    end = times.end(need, start)
    return end is not None and end - start > 2 * times.period(need.calendars) + 20 * need.length


def _possible(times: CalendarTimes, kinds: Iterable[Need], start: Number) -> list[Need]:
    """Of the needs of one kind the longest that ever fits: no other one ends later."""
    by_kind: dict[tuple[frozenset[str], bool, Number | None], list[Need]] = {}
    for need in kinds:
        by_kind.setdefault((need.calendars, need.pauses, need.max_pause), []).append(need)
    found = []
    for needs in by_kind.values():
        for need in sorted(needs, key=lambda n: -n.length):
            if times.end(need, start) is not None:
                found.append(need)
                break
    return found


def _after_steps(
    times: CalendarTimes, needs: list[Need], start: Number, steps: int, shifts: list[Number]
) -> Number:
    """The time after a number of steps, each of any of the needs, and shifts between them."""
    longest = max((need.length for need in needs), default=0)
    small = max((s for s in shifts if s <= longest), default=0)
    at = start
    for _ in range(steps if needs else 0):
        if times.size > MOST_WINDOWS:
            break  # The checks refuse the task.
        at = max([at, *(end for n in needs if (end := times.end(n, at + small)) is not None)])
    period = times.period(times.by_id) if needs else 0
    return at + sum(s + period for s in shifts if s > longest) + (small if not needs else 0)


def _lags(task: Task, clock: Clock) -> Iterator[Number]:
    """How far a precedence, or a set-up, pushes one action behind another."""
    for resource in task.resources:
        if resource.setups is not None:
            yield from (_number(row.time, clock) or 0 for row in resource.setups.times)
    for edge in task.precedence:
        forward = _number(edge.min_lag, clock) or 0
        back = -(_number(edge.max_lag, clock) or 0)
        yield from (lag for lag in (forward, back) if lag > 0)


def _last_fixed_time(task: Task, times: CalendarTimes, known: list[Number]) -> Number:
    """The last of the times that a task names: all that comes later repeats."""
    clock = task.clock
    for action in task.actions:
        known += [_number(t, clock) or 0 for t in (action.release, action.start) if t is not None]
    for resource in task.resources:
        known += [_number(w.to, clock) or 0 for w in resource.availability]
    for variable in task.state:
        known += [_number(c.at, clock) or 0 for c in variable.changes]
    for calendar in times.by_id.values():
        known.append(last_closed(calendar, clock))
    return max([0, *known])


def last_closed(calendar: Calendar, clock: Clock) -> Number:
    """The end of the last closed time of a calendar; later on its open times repeat."""
    return max([0, *_closed_ends(calendar, clock)])


def _closed_ends(calendar: Calendar, clock: Clock) -> Iterator[Number]:
    for part in calendar.closed:
        last = part.to if isinstance(part, ClosedTime) else part
        try:
            yield point(last, calendar, clock) + ceil(Fraction(DAY) / clock.unit)
        except TimeError:
            continue
