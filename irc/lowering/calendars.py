"""Expands calendars: the open times of each, as windows of the task's unit up to a time.

A calendar repeats without end, so it is expanded as far as a schedule needs; see
`irc.lowering.calendar_horizon`. The work is linear in the number of days, or cycles, until then.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from datetime import UTC, date, datetime, timedelta, tzinfo
from fractions import Fraction
from itertools import count

from irc.model import Calendar, ClosedTime, Task
from irc.model.quantities import DAY, Number, TimeError, exact
from irc.model.time_text import day_seconds
from irc.model.times import Clock, in_utc, rounded
from irc.model.zones import zone
from irc.problem.intervals import intersection

Interval = tuple[Number, Number]
"""A half-open interval [start, end), in the task's unit."""

MOST_CYCLES = 100_000
"""A calendar is read for at most this many cycles; the checks refuse a task that needs more."""

MOST_DAYS = 350_000
"""A calendar is read for at most this many days, in which it opens once a week more often than the
checks let pass."""

_NAMES = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")


class OpenTimes:
    """The open times of a calendar, or of several at once, from t = 0 to any time.

    `until(time)` has every open interval that begins before a time. The last one may go on behind
    its end, if that is not before the time.
    """

    def __init__(self, calendars: Iterable[Calendar], clock: Clock) -> None:
        self._calendars = tuple(calendars)
        self._clock = clock
        self._known: list[Interval] = []
        self.reached: Number = 0

    @property
    def size(self) -> int:
        """The number of open intervals that are known."""
        return len(self._known)

    def until(self, time: Number) -> list[Interval]:
        """The open intervals up to a time or a later one, in order; they do not touch."""
        if time > self.reached:
            self.reached = max(time, 2 * self.reached)
            found: list[Interval] = [(0, self.reached)]
            for calendar in self._calendars:
                found = list(
                    intersection(found, open_intervals(calendar, self._clock, self.reached))
                )
            self._known = found
        return self._known


def open_intervals(calendar: Calendar, clock: Clock, until: Number) -> list[Interval]:
    """The intervals in [0, until) in which a calendar is open, in order; they do not touch.

    A calendar with faults, which the checks report, is never open.
    """
    try:
        repeated = (
            _by_cycle(calendar, clock, until)
            if calendar.every is not None
            else _by_day(calendar, clock, until)
        )
        closed = list(_merged(_closed(calendar, clock)))
        return list(without(_merged(repeated), closed, until))
    except TimeError:
        return []


def zone_of(calendar: Calendar, clock: Clock) -> tzinfo:
    """The zone whose clock shows a calendar's times of day. Raises `TimeError`."""
    if calendar.time_zone is not None:
        found = zone(calendar.time_zone)
        if found is None:
            raise TimeError(f"there is no time zone {calendar.time_zone!r}")
        return found
    if clock.zone is not None:
        return clock.zone
    named = None if clock.origin is None else clock.origin.tzinfo
    return UTC if named is None else named


def _by_cycle(calendar: Calendar, clock: Clock, until: Number) -> Iterator[Interval]:
    """The open times of a calendar of cycles, from the one before t = 0 on."""
    period = clock.exact(calendar.every)  # type: ignore[arg-type]
    if period <= 0:
        raise TimeError("a cycle takes more than no time")
    parts = sorted(
        (clock.exact(part.from_), clock.exact(part.to))
        for part in calendar.open
        if not (isinstance(part.from_, str) or isinstance(part.to, str))
    )
    for k in count(-1):
        begin = k * period
        if begin >= until or k > MOST_CYCLES:
            return
        for start, end in parts:
            yield (
                _read(begin + start, clock),
                _read(begin + end + (period if end <= start else 0), clock),
            )


def _by_day(calendar: Calendar, clock: Clock, until: Number) -> Iterator[Interval]:
    """The open times of a calendar of days, from the day before t = 0 on."""
    if clock.origin is None:
        raise TimeError("a calendar of days needs the task's origin")
    local = zone_of(calendar, clock)
    origin = in_utc(clock.origin, clock.zone or local)
    parts = sorted(
        (day_seconds(part.from_), day_seconds(part.to), frozenset(part.days or _NAMES))
        for part in calendar.open
        if isinstance(part.from_, str) and isinstance(part.to, str)
    )
    day = origin.astimezone(local).date() - timedelta(days=1)
    for _ in range(MOST_DAYS):
        try:
            for start, end, days in parts:
                if _NAMES[day.weekday()] in days:
                    end += DAY if end <= start else 0
                    yield (
                        _since(_moment(day, start, local), origin, clock),
                        _since(_moment(day, end, local), origin, clock),
                    )
            day += timedelta(days=1)
            if _since(_moment(day, 0, local), origin, clock) >= until:
                return
        except OverflowError:  # The calendar of the machine ends with the year 9999.
            return


def _moment(day: date, seconds: int, local: tzinfo) -> datetime:
    """The moment at which the clock of a zone shows a time of day, in UTC (PEP 495, fold 0)."""
    day += timedelta(days=seconds // DAY)
    at = datetime(day.year, day.month, day.day) + timedelta(seconds=seconds % DAY)
    return in_utc(at, local)


def _since(moment: datetime, origin: datetime, clock: Clock) -> Number:
    """A moment as a time after t = 0 in the task's unit."""
    delta = moment - origin
    if delta.microseconds:
        seconds = Fraction(delta // timedelta(microseconds=1), 1_000_000)
    else:
        seconds = Fraction(delta.days * DAY + delta.seconds)
    return _read(exact(seconds / clock.unit), clock)


def _read(value: Number, clock: Clock) -> Number:
    """A time as a multiple of the task's resolution, if it has one."""
    value = value if isinstance(value, int) else exact(value)
    return value if clock.resolution is None else rounded(value, clock.resolution)


def _closed(calendar: Calendar, clock: Clock) -> Iterator[Interval]:
    """The closed times of a calendar; a date alone is that day, in the calendar's zone."""
    for part in calendar.closed:
        if isinstance(part, ClosedTime):
            yield point(part.from_, calendar, clock), point(part.to, calendar, clock)
        elif isinstance(part, datetime):
            following = part + timedelta(days=1)
            yield point(part, calendar, clock), point(following, calendar, clock)


def point(value: object, calendar: Calendar, clock: Clock) -> Number:
    """A time among a calendar's closed ones, in the task's unit. Raises `TimeError`."""
    if isinstance(value, datetime) and value.tzinfo is None and clock.origin is not None:
        local = zone_of(calendar, clock)
        origin = in_utc(clock.origin, clock.zone or local)
        return _since(in_utc(value, local), origin, clock)
    return clock.number(value)  # type: ignore[arg-type]


def _merged(intervals: Iterable[Interval]) -> Iterator[Interval]:
    """The union of intervals that are nearly in order, without empty ones."""
    pending: Interval | None = None
    for start, end in _in_order(intervals):
        if pending is None:
            pending = start, end
        elif start <= pending[1]:
            pending = pending[0], max(pending[1], end)
        else:
            yield pending
            pending = start, end
    if pending is not None:
        yield pending


def _in_order(intervals: Iterable[Interval]) -> list[Interval]:
    return sorted((max(0, start), end) for start, end in intervals if max(0, start) < end)


def without(
    intervals: Iterable[Interval], taken: list[Interval], until: Number
) -> Iterator[Interval]:
    """The intervals that begin before a time, less those that are `taken`; both are in order."""
    k = 0
    for start, end in intervals:
        while k < len(taken) and taken[k][1] <= start:
            k += 1
        at = k
        while at < len(taken) and taken[at][0] < end:
            if start < taken[at][0]:
                yield start, taken[at][0]
            start = max(start, taken[at][1])
            at += 1
        if start < end and start < until:
            yield start, end


def calendars_by_id(task: Task) -> dict[str, Calendar]:
    """The calendars of a task by their ids; of two with one id, which is a fault, the first."""
    return {calendar.id: calendar for calendar in reversed(task.calendars)}
