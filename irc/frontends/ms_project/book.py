"""Builds the XML of a project: its elements in the order of the schema, escaped by the library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date, datetime, timedelta
from fractions import Fraction
from xml.etree import ElementTree

from irc.frontends.ms_project.calendars import ALWAYS, DAY_MINUTES, Times, WorkCalendar
from irc.frontends.ms_project.elements import NAMESPACE
from irc.model import Task

Value = str | int | Fraction | datetime | timedelta | None
ALWAYS_OPEN = WorkCalendar("24 Hours", (ALWAYS,) * 7)

ELAPSED_MINUTES, MINUTES = 4, 3
"""Formats of durations and lags."""

TASK_LABEL, RESOURCE_LABEL = 188743731, 205520904
"""The numbers of the fields Text1 of tasks and of resources, which hold labels."""

_SUNDAY_FIRST = (6, 0, 1, 2, 3, 4, 5)
_WITHOUT_ORIGIN = datetime(2000, 1, 3)
"""A Monday: the date of t = 0 of a task that has no origin."""


@dataclass
class Book:
    """A project in the making."""

    task: Task
    root: ElementTree.Element = field(default_factory=lambda: ElementTree.Element("Project"))
    start: datetime = field(init=False)

    def __post_init__(self) -> None:
        """Sets the date of t = 0, and the fields of the project."""
        self.root.set("xmlns", NAMESPACE)
        self.start = self.wall(Fraction(0))

    def wall(self, seconds: Fraction) -> datetime:
        """The time on the clock, in the zone of the origin, `seconds` after t = 0."""
        origin, zone = self.task.origin or _WITHOUT_ORIGIN, self.task.clock.zone
        passed = timedelta(microseconds=round(seconds * 1_000_000))
        if zone is None:
            return (origin + passed).replace(tzinfo=None)
        from irc.model.times import in_utc

        return (in_utc(origin, zone) + passed).astimezone(zone).replace(tzinfo=None)

    def head(self, finish: datetime | None = None) -> None:
        """The fields of the project itself; its calendar is the one with the UID 1."""
        fields: dict[str, Value] = {
            "SaveVersion": 14,
            "Name": f"{self.task.name or 'task'}.xml",
            "Title": self.task.name,
            "Subject": self.task.description,
            "ScheduleFromStart": 1,
            "StartDate": self.start,
            "FinishDate": finish,
            "CalendarUID": 1,
            "DefaultStartTime": "00:00:00",
            "DefaultFinishTime": "23:59:00",
            "MinutesPerDay": 24 * 60,
            "MinutesPerWeek": 7 * 24 * 60,
            "DaysPerMonth": 30,
        }
        add(self.root, fields)
        labels = ElementTree.SubElement(self.root, "ExtendedAttributes")
        for number in (TASK_LABEL, RESOURCE_LABEL):
            one = ElementTree.SubElement(labels, "ExtendedAttribute")
            add(one, {"FieldID": number, "FieldName": "Text1", "Alias": "label"})

    def text(self) -> str:
        """The text of the document."""
        ElementTree.indent(self.root)
        body = ElementTree.tostring(self.root, encoding="unicode")
        return f'<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n{body}\n'


def add(parent: ElementTree.Element, fields: Mapping[str, Value]) -> None:
    """Adds an element for each field that has a value."""
    for name, value in fields.items():
        if value is not None:
            ElementTree.SubElement(parent, name).text = _text(value)


def _text(value: str | int | Fraction | datetime | timedelta) -> str:
    if isinstance(value, datetime):
        return value.isoformat(timespec="seconds")
    if isinstance(value, timedelta):
        return length_text(Fraction(value // timedelta(microseconds=1), 1_000_000))
    return str(value)


def length_text(seconds: Fraction) -> str:
    """A length of time: "PT8H30M0S"."""
    whole = int(seconds)
    return f"PT{whole // 3600}H{whole // 60 % 60}M{whole % 60}S"


def add_calendars(
    root: ElementTree.Element, bases: Sequence[WorkCalendar], derived: Sequence[tuple[str, int]]
) -> None:
    """Adds base calendars with the UIDs 1, 2, …, then the (name, UID of the base) of resources."""
    parent = ElementTree.SubElement(root, "Calendars")
    for uid, calendar in enumerate(bases, 1):
        one = ElementTree.SubElement(parent, "Calendar")
        fields: dict[str, Value] = {
            "UID": uid,
            "Name": calendar.name,
            "IsBaseCalendar": 1,
            "BaseCalendarUID": -1,
        }
        add(one, fields)
        days = ElementTree.SubElement(one, "WeekDays")
        for kind, day in enumerate(_SUNDAY_FIRST, 1):
            _add_day(ElementTree.SubElement(days, "WeekDay"), {"DayType": kind}, calendar.week[day])
        if calendar.exceptions:
            exceptions = ElementTree.SubElement(one, "Exceptions")
            for closed, times in sorted(calendar.exceptions.items()):
                _add_exception(ElementTree.SubElement(exceptions, "Exception"), closed, times)
    for uid, (name, base) in enumerate(derived, len(bases) + 1):
        one = ElementTree.SubElement(parent, "Calendar")
        add(one, {"UID": uid, "Name": name, "IsBaseCalendar": 0, "BaseCalendarUID": base})


def _add_exception(one: ElementTree.Element, day: date, times: Times) -> None:
    add(one, {"EnteredByOccurrences": 0})
    period = ElementTree.SubElement(one, "TimePeriod")
    begin = datetime(day.year, day.month, day.day)
    add(period, {"FromDate": begin, "ToDate": begin + timedelta(hours=23, minutes=59)})
    _add_day(one, {"Occurrences": 1, "Name": day.isoformat(), "Type": 1}, times)


def _add_day(one: ElementTree.Element, head: Mapping[str, Value], times: Times) -> None:
    add(one, {**head, "DayWorking": int(bool(times))})
    if times:
        spans = ElementTree.SubElement(one, "WorkingTimes")
        for begin, end in times:
            span = ElementTree.SubElement(spans, "WorkingTime")
            add(span, {"FromTime": _clock(begin), "ToTime": _clock(end % DAY_MINUTES)})


def _clock(minute: int) -> str:
    return f"{minute // 60:02}:{minute % 60:02}:00"


def add_label(one: ElementTree.Element, number: int, label: str | None) -> None:
    """Adds a label as an extended attribute."""
    if label is not None:
        add(ElementTree.SubElement(one, "ExtendedAttribute"), {"FieldID": number, "Value": label})
