"""Calendars of a project as calendars of the IR: a week of open times, and what is closed.

A calendar of MS Project derives from another: a day of the week that it does not define is that of
its base. Times of day are minutes here; a day's times are sorted and do not overlap.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date, datetime, timedelta
from typing import Any

from irc.frontends.ms_project.elements import Element

Times = tuple[tuple[int, int], ...]
"""Open times of a day: [from, to) in minutes."""

DAYS = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")
DAY_MINUTES = 24 * 60
ALWAYS: Times = ((0, DAY_MINUTES),)
_DAILY = 1
_TIME = re.compile(r"(?:\d{4}-\d\d-\d\dT)?(\d\d):(\d\d)(?::(\d\d)(?:\.0+)?)?\Z", re.ASCII)
_LOOK_AHEAD = 3_000
"""Days."""

_MOST_DAYS = 20_000
"""An exception over more days than this is refused."""


@dataclass(frozen=True)
class WorkCalendar:
    """A resolved calendar: open times of each day of the week (Monday first) and exceptions."""

    name: str
    week: tuple[Times, ...]
    exceptions: Mapping[date, Times] = field(default_factory=dict)
    base: WorkCalendar | None = None

    @property
    def plain(self) -> WorkCalendar:
        """The first calendar of those that it derives from that says the same."""
        same = self.base is not None and self.base.contents == self.contents
        return self.base.plain if same and self.base else self

    @property
    def is_always_open(self) -> bool:
        """Whether nothing is ever closed, so that it restricts nothing."""
        return all(times == ALWAYS for times in self.week) and not self.exceptions

    @property
    def contents(self) -> tuple[object, ...]:
        """Its open times, without its name."""
        return self.week, tuple(sorted(self.exceptions.items()))

    def is_within(self, other: WorkCalendar) -> bool:
        """Whether it is open only when the other is."""
        days = {*self.exceptions, *other.exceptions}
        pairs = [*zip(self.week, other.week, strict=True)]
        pairs += [(self.on(day), other.on(day)) for day in days]
        return not any(without(mine, theirs) for mine, theirs in pairs)

    def on(self, day: date) -> Times:
        """Its open times on a day."""
        return self.exceptions.get(day, self.week[day.weekday()])

    def open_spans(self, begin: datetime) -> Iterator[tuple[datetime, datetime]]:
        """Its open times from an instant on, for some years."""
        midnight = datetime(begin.year, begin.month, begin.day)
        for _ in range(_LOOK_AHEAD):
            for first, last in self.on(midnight.date()):
                start = max(midnight + timedelta(minutes=first), begin)
                end = midnight + timedelta(minutes=last)
                if start < end:
                    yield start, end
            midnight += timedelta(days=1)

    def end_of_work(self, begin: datetime, length: timedelta) -> datetime:
        """The earliest end of work that begins at an instant or later; that instant if unknown."""
        left = length
        for start, end in self.open_spans(begin):
            if left <= end - start:
                return start + left
            left -= end - start
        return begin

    def open_time(self, begin: datetime, end: datetime) -> timedelta:
        """How long it is open between two instants."""
        total = timedelta()
        for start, close in self.open_spans(begin):
            if start >= end:
                break
            total += min(close, end) - start
        return total


def read_calendars(project: Element) -> dict[int, WorkCalendar]:
    """The calendars of a project by their UIDs. What the IR cannot say is a fault."""
    elements: dict[int, Element] = {}
    for one in project.all("Calendars", "Calendar"):
        uid = one.whole("UID", -1)
        if uid in elements:
            project.faults.add(one.at("UID"), f"there are two calendars with the UID {uid}")
        elements[uid] = one
    found: dict[int, WorkCalendar] = {}
    for uid in elements:
        _resolve(uid, elements, found, ())
    return found


def _resolve(
    uid: int, elements: Mapping[int, Element], found: dict[int, WorkCalendar], inner: Sequence[int]
) -> WorkCalendar | None:
    if uid in found or uid not in elements:
        return found.get(uid)
    one = elements[uid]
    base_uid = one.whole("BaseCalendarUID", -1)
    base = None
    if base_uid in inner or base_uid == uid:
        one.faults.add(one.at("BaseCalendarUID"), f"calendar {_name(one)!r} derives from itself")
    elif base_uid in elements:
        base = _resolve(base_uid, elements, found, (*inner, uid))
    elif base_uid > 0:
        one.faults.add(one.at("BaseCalendarUID"), f"there is no calendar with the UID {base_uid}")
    found[uid] = _read(one, base)
    return found[uid]


def _name(one: Element) -> str:
    return one.said("Name") or f"calendar {one.said('UID')}"


def _read(one: Element, base: WorkCalendar | None) -> WorkCalendar:
    week: list[Times | None] = list(base.week) if base else [None] * 7
    exceptions = dict(base.exceptions) if base else {}
    for day in one.all("WeekDays", "WeekDay"):
        kind = day.whole("DayType", -1)
        if kind == 0:
            exceptions.update(_exception(day, one))
        elif 1 <= kind <= 7:
            week[(kind + 5) % 7] = _times(day)
        else:
            one.faults.add(day.at("DayType"), "DayType: expected 0 to 7 (1 is Sunday)")
    # A file has an exception both as a day of type 0 and, since MS Project 2007, by itself.
    for exception in one.all("Exceptions", "Exception"):
        exceptions.update(_exception(exception, one))
    for weeks in one.all("WorkWeeks", "WorkWeek"):
        if weeks.child("WeekDays") is not None:
            message = f"calendar {_name(one)!r}: a work week of its own for a time is not read"
            one.faults.add(weeks, message, "write its days as exceptions")
    missing = [DAYS[k] for k, times in enumerate(week) if times is None]
    if missing:
        message = f"calendar {_name(one)!r} does not say when it is open: {', '.join(missing)}"
        one.faults.add(one, message, "write a WeekDay for each DayType from 1 to 7")
    return WorkCalendar(_name(one), tuple(times or () for times in week), exceptions, base)


def _times(day: Element) -> Times:
    """The working times of a day of the week or of an exception."""
    if not day.flag("DayWorking"):
        return ()
    spans = []
    for one in day.all("WorkingTimes", "WorkingTime"):
        begin, end = _minute(one, "FromTime"), _minute(one, "ToTime")
        if begin is None and end is None:
            continue
        end = DAY_MINUTES if end == 0 else end
        if begin is None or end is None or begin >= end:
            day.faults.add(one, "WorkingTime: expected a FromTime before the ToTime")
        else:
            spans.append((begin, end))
    if not spans:
        message = "a working day without working times"
        day.faults.add(day, message, "write its WorkingTimes, or DayWorking 0")
    return union(spans)


def _minute(one: Element, name: str) -> int | None:
    said = one.said(name)
    if not said:
        return None
    match = _TIME.match(said)
    if match and int(match[1]) < 24 and int(match[2]) < 60 and int(match[3] or 0) == 0:
        return int(match[1]) * 60 + int(match[2])
    one.faults.add(one.at(name), f"{name}: expected whole minutes such as 08:00:00, found {said!r}")
    return None


def union(spans: Iterable[tuple[int, int]]) -> Times:
    """Times in order, with those that touch or overlap joined."""
    joined: list[tuple[int, int]] = []
    for begin, end in sorted(spans):
        if joined and begin <= joined[-1][1]:
            joined[-1] = joined[-1][0], max(end, joined[-1][1])
        else:
            joined.append((begin, end))
    return tuple(joined)


def without(times: Times, taken: Iterable[tuple[int, int]]) -> Times:
    """The parts of `times` that are outside of all spans in `taken`."""
    left = list(times)
    for begin, end in taken:
        cut = []
        for a, b in left:
            cut += [(x, y) for x, y in ((a, min(b, begin)), (max(a, end), b)) if x < y]
        left = cut
    return tuple(left)


def _exception(one: Element, owner: Element) -> dict[date, Times]:
    """The times of each day of an exception."""
    period = one.child("TimePeriod")
    begin = period.date("FromDate") if period else None
    end = period.date("ToDate") if period else None
    if begin is None or end is None or end < begin:
        one.faults.add(one, "an exception needs a TimePeriod with FromDate and ToDate")
        return {}
    count = _last_day(begin, end) - begin.date()
    if count.days > _MOST_DAYS:
        one.faults.add(one, f"an exception over more than {_MOST_DAYS:,} days")
        return {}
    days = [begin.date() + timedelta(days=n) for n in range(count.days + 1)]
    counted = one.flag("EnteredByOccurrences") and one.whole("Occurrences", 1) < len(days)
    if one.whole("Type", _DAILY) != _DAILY or one.whole("Period", 1) > 1 or counted:
        message = f"calendar {_name(owner)!r}: an exception that recurs is not read"
        one.faults.add(one, message, "write each of its days as an exception")
        return {}
    return dict.fromkeys(days, _times(one))


def _last_day(begin: datetime, end: datetime) -> date:
    """The last day of a period; a midnight ends the day before, if the period is not empty."""
    if end > begin and (end.hour, end.minute, end.second) == (0, 0, 0):
        return (end - timedelta(seconds=1)).date()
    return end.date()


def clock_text(minute: int) -> str:
    """A time of day: "08:00", "24:00"."""
    return f"{minute // 60:02}:{minute % 60:02}"


def calendar_document(calendar: WorkCalendar, id: str, element: Element) -> dict[str, Any]:
    """A calendar as the IR writes it. Working time beyond that of the week is a fault."""
    days: dict[tuple[int, int], list[str]] = defaultdict(list)
    for name, spans in zip(DAYS, calendar.week, strict=True):
        for span in spans:
            days[span].append(name)
    closed: list[Any] = []
    for day, times in sorted(calendar.exceptions.items()):
        usual = calendar.week[day.weekday()]
        if without(times, usual):
            message = (
                f"calendar {calendar.name!r} works on {day} at times at which it else does not"
            )
            hint = "the IR has open times by days of the week only: make it a time of the week"
            element.faults.add(element, message, hint)
        if usual and not times:
            closed.append(day.isoformat())
        else:
            closed += [_closed_time(day, span) for span in without(usual, times)]
    if not days:
        element.faults.add(element, f"calendar {calendar.name!r} is never open")
    opened = [
        {
            **({} if len(names) == len(DAYS) else {"days": names}),
            "from": clock_text(begin),
            "to": clock_text(end),
        }
        for (begin, end), names in sorted(days.items())
    ]
    return {"id": id, "open": opened, **({"closed": closed} if closed else {})}


def _closed_time(day: date, span: tuple[int, int]) -> dict[str, str]:
    midnight = datetime(day.year, day.month, day.day)
    begin, end = (midnight + timedelta(minutes=minute) for minute in span)
    return {"from": begin.isoformat(), "to": end.isoformat()}
