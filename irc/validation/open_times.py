"""Calendars, as the validator reads them: the closed times of a resource or an action until a time.

Openings are counted: a moment is open where more open times of the calendar have begun than ended,
and no closed time has begun that has not ended.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from datetime import UTC, datetime, timedelta, tzinfo
from fractions import Fraction
from itertools import groupby

from irc.errors import IrcError
from irc.model import Calendar, ClosedTime, Resource, Task
from irc.model.quantities import Number
from irc.model.times import Clock
from irc.model.zones import zone

Span = tuple[Number, Number]
"""A half-open time [start, end) in the task's unit."""

MOST_OPENINGS = 1_000_000
"""A calendar with more openings until the last end of a schedule is not read."""

_WEEK = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")


class UnreadableCalendarError(IrcError, ValueError):
    """A calendar that the validator cannot read; `irc check` says why."""


class Calendars:
    """The closed times of a task's calendars and resources in [0, until), each found once."""

    def __init__(self, task: Task, clock: Clock, until: Number) -> None:
        self.clock, self.until = clock, until
        self.calendars = {calendar.id: calendar for calendar in task.calendars}
        self._closed: dict[str, list[Span]] = {}
        self._without_capacity: dict[str, list[Span]] = {}

    def closed(self, name: str) -> Sequence[Span]:
        """The closed times of a calendar, in order."""
        if name not in self._closed:
            if name not in self.calendars:
                raise UnreadableCalendarError(f"there is no calendar {name!r}")
            self._closed[name] = list(self._gaps(self.calendars[name]))
        return self._closed[name]

    def without_capacity(self, resource: Resource) -> Sequence[Span]:
        """The times at which a resource has no capacity, in order."""
        if resource.id not in self._without_capacity:
            self._without_capacity[resource.id] = list(self._zero(resource))
        return self._without_capacity[resource.id]

    def levels(self, resource: Resource) -> list[tuple[Number, int]]:
        """(From when on, capacity) of a resource: its windows, its calendar, its own capacity."""
        number = self.clock.number
        windows = sorted(
            (number(w.from_), number(w.to), w.capacity)
            for w in dict.fromkeys(resource.availability)
            if number(w.from_) < number(w.to)
        )
        closed = [] if resource.calendar is None else self.closed(resource.calendar)
        marks: list[tuple[Number, int, int, int]] = [(0, 0, 0, 0)]
        for start, end, capacity in windows:
            marks += [(start, 1, capacity, 0), (end, -1, 0, 0)]
        for start, end in closed:
            marks += [(start, 0, 0, 1), (end, 0, 0, -1)]
        levels, shut, window, own = [], 0, 0, 0
        for time, group in groupby(sorted(marks), key=lambda mark: mark[0]):
            for _, change, capacity, closing in group:
                window, shut = window + change, shut + closing
                own = capacity if change > 0 else own
            usual = 0 if shut else resource.capacity
            levels.append((time, own if window else usual))
        return levels

    def _zero(self, resource: Resource) -> Iterator[Span]:
        since: Number | None = None
        for time, level in self.levels(resource):
            if level == 0 and since is None:
                since = time
            elif level and since is not None:
                yield since, time
                since = None
        if since is not None:
            yield since, max(since, self.until) + 1

    def _gaps(self, calendar: Calendar) -> Iterator[Span]:
        changes: list[tuple[Number, int, int]] = [(0, 0, 0)]
        for count, (start, end) in enumerate(self._openings(calendar)):
            if count > MOST_OPENINGS:
                raise UnreadableCalendarError(
                    f"calendar {calendar.id!r} opens more than {MOST_OPENINGS} times before the end"
                )
            if start < end:
                changes += [(max(0, start), 1, 0), (max(0, end), -1, 0)]
        for start, end in self._shut(calendar):
            if start < end:
                changes += [(max(0, start), 0, 1), (max(0, end), 0, -1)]
        opened = shut = 0
        since: Number | None = None
        for time, group in groupby(sorted(changes), key=lambda change: change[0]):
            for _, more_open, more_shut in group:
                opened, shut = opened + more_open, shut + more_shut
            is_closed = shut > 0 or opened == 0
            if is_closed and since is None:
                since = time
            elif not is_closed and since is not None:
                if since < time:
                    yield since, time
                since = None
        if since is not None:
            yield since, max(since, self.until) + 1

    def _openings(self, calendar: Calendar) -> Iterator[Span]:
        if calendar.every is not None:
            yield from self._of_cycles(calendar)
        else:
            yield from self._of_days(calendar)

    def _of_cycles(self, calendar: Calendar) -> Iterator[Span]:
        exact = self.clock.exact
        every = Fraction(exact(calendar.every))  # type: ignore[arg-type]
        if every <= 0:
            raise UnreadableCalendarError(f"the cycle of calendar {calendar.id!r} takes no time")
        cycle = -1
        while cycle * every <= self.until:
            for part in calendar.open:
                if isinstance(part.from_, str) or isinstance(part.to, str):
                    raise UnreadableCalendarError("a time of day in a calendar of cycles")
                start, end = exact(part.from_), exact(part.to)
                whole = cycle + 1 if end <= start else cycle
                yield self._rounded(cycle * every + start), self._rounded(whole * every + end)
            cycle += 1

    def _of_days(self, calendar: Calendar) -> Iterator[Span]:
        if self.clock.origin is None:
            raise UnreadableCalendarError(f"calendar {calendar.id!r} has days, the task no origin")
        local = self._zone(calendar)
        first = self._origin(local).astimezone(local).replace(tzinfo=None)
        day = datetime(first.year, first.month, first.day) - timedelta(days=1)
        while True:
            for part in calendar.open:
                if part.days and _WEEK[day.weekday()] not in part.days:
                    continue
                start, end = day + _of_day(part.from_), day + _of_day(part.to)
                if end <= start:
                    end += timedelta(days=1)
                yield self._at(start, local), self._at(end, local)
            if self._at(day, local) > self.until or day.year >= _LAST_YEAR:
                return
            day += timedelta(days=1)

    def _shut(self, calendar: Calendar) -> Iterator[Span]:
        for part in calendar.closed:
            if isinstance(part, ClosedTime):
                yield self._moment(part.from_, calendar), self._moment(part.to, calendar)
            elif isinstance(part, datetime):
                following = part + timedelta(days=1)
                yield self._moment(part, calendar), self._moment(following, calendar)

    def _moment(self, value: object, calendar: Calendar) -> Number:
        if isinstance(value, datetime) and value.tzinfo is None and self.clock.origin is not None:
            return self._at(value, self._zone(calendar))
        return self.clock.number(value)  # type: ignore[arg-type]

    def _zone(self, calendar: Calendar) -> tzinfo:
        if calendar.time_zone is not None:
            found = zone(calendar.time_zone)
            if found is None:
                raise UnreadableCalendarError(f"there is no time zone {calendar.time_zone!r}")
            return found
        origin = self.clock.origin
        return self.clock.zone or (origin.tzinfo if origin else None) or UTC

    def _origin(self, local: tzinfo) -> datetime:
        origin = self.clock.origin
        if origin is None:
            raise UnreadableCalendarError("the task has no origin")
        return origin if origin.tzinfo else origin.replace(tzinfo=self.clock.zone or local)

    def _at(self, shown: datetime, local: tzinfo) -> Number:
        """The time at which the clock of a zone first shows a date and a time of day."""
        offset = shown.replace(tzinfo=local).utcoffset() or timedelta(0)
        origin = self._origin(local)
        since = (shown - offset) - (origin.replace(tzinfo=None) - (origin.utcoffset() or _NONE))
        return self._rounded(Fraction(since // _MICROSECOND, 1_000_000) / self.clock.unit)

    def _rounded(self, value: Number) -> Number:
        return self.clock.number(Fraction(value))


_LAST_YEAR = 9998
_NONE = timedelta(0)
_MICROSECOND = timedelta(microseconds=1)


def _of_day(text: object) -> timedelta:
    """The time from midnight to a time of day."""
    if not isinstance(text, str):
        raise UnreadableCalendarError(f"{text} is not a time of day")
    hours, minutes, *seconds = map(int, text.split(":"))
    return timedelta(hours=hours, minutes=minutes, seconds=sum(seconds))


def time_in(spans: Iterable[Sequence[Span]], start: Number, end: Number) -> Number:
    """How much of [start, end) lies in one of several lists of times."""
    cut = sorted(
        (max(a, start), min(b, end)) for own in spans for a, b in own if a < end and b > start
    )
    total: Number = 0
    reached = start
    for a, b in cut:
        if b > reached:
            total += b - max(a, reached)
            reached = b
    return total


def holds(spans: Iterable[Sequence[Span]], time: Number, *, at_end: bool = False) -> bool:
    """Whether a time lies in one of several lists of times: in [start, end), or in (start, end]
    where it is the end of something.
    """
    if at_end:
        return any(a < time <= b for own in spans for a, b in own)
    return any(a <= time < b for own in spans for a, b in own)
