"""Writes a task as a project that MS Project plans itself.

A project has one constraint for each task, and its times are multiples of a tenth of a minute. All
of its tasks work at the open times of their calendars and of their resources, and pause otherwise.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date, datetime, timedelta
from fractions import Fraction
from xml.etree import ElementTree

from irc.diagnostics.source import Pointer
from irc.frontends.exporters.refusal import Refusals
from irc.frontends.ms_project.book import (
    ALWAYS_OPEN,
    ELAPSED_MINUTES,
    MINUTES,
    RESOURCE_LABEL,
    TASK_LABEL,
    Book,
    Value,
    add,
    add_calendars,
    add_label,
    length_text,
)
from irc.frontends.ms_project.calendars import DAY_MINUTES, DAYS, WorkCalendar, union, without
from irc.model import Action, DurationRange, Precedence, Resource, Task
from irc.model.details import Calendar, ClosedTime
from irc.model.features import Feature
from irc.model.times import Instant

_SUPPORTED = frozenset(
    [
        *(Feature.ZERO_DURATION, Feature.PRECEDENCE, Feature.PRECEDENCE_TYPES, Feature.MIN_LAG),
        *(Feature.NEGATIVE_LAG, Feature.RELEASE, Feature.DEADLINE, Feature.FIXED_START),
        *(Feature.LATEST_START, Feature.EARLIEST_END, Feature.DUE_DATE, Feature.RESOURCES),
        *(Feature.AMOUNTS, Feature.CALENDARS, Feature.ACTION_CALENDARS, Feature.PAUSES),
        Feature.MAKESPAN,
    ]
)
TYPES = {"finish-finish": 0, "finish-start": 1, "start-finish": 2, "start-start": 3}
"""The numbers of the types of links."""

_CONSTRAINTS = {"start": 2, "release": 4, "latest_start": 5, "earliest_end": 6, "deadline": 7}
_STEP = 6
"""Seconds: a tenth of a minute, in which MS Project counts."""

_MOST_TIMES, _MOST_CLOSED_DAYS = 5, 3_000
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_ms_project(task: Task) -> str:
    """The text of a task as a project. Raises `InputError` with each element that it cannot say."""
    return _Writer(task).text()


def require_writable(task: Task, refusals: Refusals) -> None:
    """Refuses names with characters that XML does not have."""
    kinds: dict[str, Sequence[Action | Resource | Calendar]] = {
        "actions": task.actions,
        "resources": task.resources,
        "calendars": task.calendars,
    }
    for field, elements in kinds.items():
        for k, one in enumerate(elements):
            texts = (one.id, one.label, one.description)
            if any(text and _NOT_XML.search(text) for text in texts):
                message = f"{field[:-1]} {one.id!r}: XML has no control characters"
                refusals.add(message, (field, k))
    if any(text and _NOT_XML.search(text) for text in (task.name, task.description)):
        refusals.add("the task: XML has no control characters", ("name",))


class _Writer:
    """A project in the making, and what it cannot say."""

    def __init__(self, task: Task) -> None:
        self.task, self.book = task, Book(task)
        self.refusals = Refusals(task, "MS Project")
        self.calendars = {
            calendar.id: k for k, calendar in enumerate(task.calendars, 2)
        }  # The first is the project's own.
        self.resources = {resource.id: k for k, resource in enumerate(task.resources, 1)}
        self.actions = {action.id: k for k, action in enumerate(task.actions, 1)}

    def text(self) -> str:
        """The text of the project. Raises `InputError`."""
        task, refusals = self.task, self.refusals
        refusals.require_features(_SUPPORTED)
        require_writable(task, refusals)
        self._require_plain()
        refusals.raise_any()
        bases = [ALWAYS_OPEN, *(self._calendar(c, k) for k, c in enumerate(task.calendars))]
        self.book.head()
        derived = [(r.id, self.calendars.get(r.calendar or "", 1)) for r in task.resources]
        add_calendars(self.book.root, bases, derived)
        self._add_tasks()
        add_resources(self.book, len(bases))
        self._add_assignments()
        refusals.raise_any()
        return self.book.text()

    def _require_plain(self) -> None:
        task, refuse = self.task, self.refusals.add
        if task.deadline is not None:
            hint = "give the last actions a deadline"
            refuse("MS Project has no deadline of the whole task", ("deadline",), hint)
        if task.events:
            refuse("MS Project has no events", ("events",))
        for k, resource in enumerate(task.resources):
            if resource.availability:
                message = f"resource {resource.id!r}: MS Project has no availability windows"
                refuse(message, ("resources", k, "availability"), "write a calendar")
        for i, action in enumerate(task.actions):
            for field in ("on_failure", "max_pause", "weight"):
                if getattr(action, field) is not None:
                    message = f"action {action.id!r}: MS Project has no {field}"
                    refuse(message, ("actions", i, field))
            self._require_one_constraint(action, i)
            self._require_pauses(action, i)

    def _require_one_constraint(self, action: Action, index: int) -> None:
        said = [name for name in _CONSTRAINTS if name in _constraints(action)]
        if len(said) > 1 and said != ["earliest_end", "deadline"]:
            message = f"action {action.id!r}: MS Project has one constraint for each task, not "
            self.refusals.add(message + ", ".join(said), ("actions", index, said[1]))

    def _require_pauses(self, action: Action, index: int) -> None:
        """Refuses work that MS Project would carry out at other times."""
        name, at = f"action {action.id!r}", ("actions", index)
        held = {use.alternatives[0] for use in action.uses}
        theirs = {r.calendar for r in self.task.resources if r.id in held and r.calendar}
        calendars = theirs | ({action.calendar} if action.calendar else set())
        if not calendars:
            return
        if action.duration == 0 and action.calendar:
            message = f"{name}: a milestone of MS Project has no calendar"
            self.refusals.add(message, (*at, "calendar"))
        elif action.duration != 0 and action.breaks != "pause":
            message = f"{name}: MS Project interrupts work at closed times"
            self.refusals.add(message, at, 'write "breaks": "pause"')
        if len(theirs) > 1:
            message = f"{name}: in MS Project each resource works by its own calendar"
            self.refusals.add(message, (*at, "uses"), "give its resources the same calendar")

    def _seconds(self, value: Instant, element: str, pointer: Pointer) -> Fraction:
        """A time in seconds, a multiple of a tenth of a minute; otherwise a refusal."""
        seconds = Fraction(self.task.number(value)) * self.task.clock.unit
        if seconds % _STEP:
            message = f"{element}: MS Project has tenths of minutes only"
            self.refusals.add(message, pointer, "write multiples of 6 seconds")
        return seconds

    # --- calendars --------------------------------------------------------------------------

    def _calendar(self, calendar: Calendar, index: int) -> WorkCalendar:
        name, at = f"calendar {calendar.id!r}", ("calendars", index)
        if calendar.every is not None or calendar.time_zone is not None:
            field = "time_zone" if calendar.every is None else "every"
            self.refusals.add(f"{name}: MS Project has no {field}", (*at, field))
            return ALWAYS_OPEN
        spans: list[list[tuple[int, int]]] = [[] for _ in DAYS]
        for k, time in enumerate(calendar.open):
            begin = self._minute(time.from_, name, (*at, "open", k, "from"))
            end = self._minute(time.to, name, (*at, "open", k, "to"))
            for day in [DAYS.index(day) for day in time.days] or range(7):
                if begin < end:
                    spans[day].append((begin, end))
                    continue
                spans[day].append((begin, DAY_MINUTES))
                if end:
                    spans[(day + 1) % 7].append((0, end))
        week = tuple(union(day) for day in spans)
        found = WorkCalendar(calendar.id, week, self._exceptions(calendar, week, at))
        if any(len(times) > _MOST_TIMES for times in (*week, *found.exceptions.values())):
            message = f"{name}: MS Project has at most {_MOST_TIMES} working times a day"
            self.refusals.add(message, (*at, "open"))
        return found

    def _minute(self, time: object, element: str, pointer: Pointer) -> int:
        hours, minutes, *seconds = map(int, str(time).split(":"))
        if any(seconds):
            self.refusals.add(f"{element}: MS Project has whole minutes only", pointer)
        return hours * 60 + minutes

    def _exceptions(
        self, calendar: Calendar, week: tuple[tuple[tuple[int, int], ...], ...], at: Pointer
    ) -> dict[date, tuple[tuple[int, int], ...]]:
        found: dict[date, tuple[tuple[int, int], ...]] = {}
        for k, closed in enumerate(calendar.closed):
            place = (*at, "closed", k)
            if isinstance(closed, ClosedTime):
                begin, end = self._instant(closed.from_, place), self._instant(closed.to, place)
            else:
                begin = self._instant(closed, place)
                end = begin + timedelta(days=1)
            day = begin.date()
            while datetime(day.year, day.month, day.day) < end:
                midnight = datetime(day.year, day.month, day.day)
                first, last = ((t - midnight) // timedelta(minutes=1) for t in (begin, end))
                usual = found.get(day, week[day.weekday()])
                taken = [(max(first, 0), min(last, DAY_MINUTES))]
                found[day] = without(usual, taken)
                day += timedelta(days=1)
                if len(found) > _MOST_CLOSED_DAYS:
                    self.refusals.add(f"more than {_MOST_CLOSED_DAYS:,} closed days", place)
                    return {}
        return found

    def _instant(self, value: Instant, pointer: Pointer) -> datetime:
        found = self.book.wall(Fraction(self.task.number(value)) * self.task.clock.unit)
        if found.second or found.microsecond:
            self.refusals.add("MS Project closes at whole minutes only", pointer)
        return found

    # --- tasks ------------------------------------------------------------------------------

    def _add_tasks(self) -> None:
        parent = ElementTree.SubElement(self.book.root, "Tasks")
        links: dict[str, list[tuple[int, Precedence]]] = {}
        for k, edge in enumerate(self.task.precedence):
            links.setdefault(edge.after, []).append((k, edge))
        for uid, action in enumerate(self.task.actions, 1):
            one = ElementTree.SubElement(parent, "Task")
            add(one, self._task(action, uid))
            for k, edge in links.get(action.id, ()):
                self._add_link(one, edge, k)
            add_label(one, TASK_LABEL, action.label)

    def _task(self, action: Action, uid: int) -> dict[str, Value]:
        at, name = ("actions", uid - 1), f"action {action.id!r}"
        seconds = self._seconds(_length(action), name, (*at, "duration"))
        kind, when = 0, None
        for field in _constraints(action):
            kind = _CONSTRAINTS[field]
            when = self._date(getattr(action, field), name, (*at, field))
        if action.earliest_end is not None and action.deadline is not None:
            kind = 3
            if self.task.number(action.earliest_end) != self.task.number(action.deadline):
                message = f"{name}: MS Project has one constraint for each task"
                self.refusals.add(message, (*at, "earliest_end"))
        due = None if action.due is None else self._date(action.due, name, (*at, "due"))
        head = task_fields(uid, action.id, seconds, MINUTES)
        return {
            **head,
            "ConstraintType": kind,
            "CalendarUID": self.calendars.get(action.calendar or "", -1),
            "ConstraintDate": when,
            "Deadline": due,
            "IgnoreResourceCalendar": 0,
            "Notes": action.description,
        }

    def _date(self, value: Instant, element: str, pointer: Pointer) -> datetime:
        return self.book.wall(self._seconds(value, element, pointer))

    def _add_link(self, one: ElementTree.Element, edge: Precedence, index: int) -> None:
        name = f"precedence {index + 1}"
        lag = self._seconds(edge.min_lag, name, ("precedence", index, "min_lag"))
        add_link(one, edge, self.actions[edge.before], lag)

    def _add_assignments(self) -> None:
        parent = ElementTree.SubElement(self.book.root, "Assignments")
        for uid, action in enumerate(self.task.actions, 1):
            seconds = Fraction(self.task.number(_length(action))) * self.task.clock.unit
            held: dict[str, int] = {}
            for use in action.uses:
                name = use.alternatives[0]
                held[name] = held.get(name, 0) + use.amount
            for name, amount in held.items():
                fields: dict[str, Value] = {
                    "UID": len(parent) + 1,
                    "TaskUID": uid,
                    "ResourceUID": self.resources[name],
                    "Units": amount,
                    "Work": length_text(seconds * amount),
                }
                add(ElementTree.SubElement(parent, "Assignment"), fields)


def _length(action: Action) -> Instant:
    """The duration of an action that has neither modes nor a range of durations."""
    assert action.duration is not None
    assert not isinstance(action.duration, DurationRange)
    return action.duration


def _constraints(action: Action) -> list[str]:
    """The names of the fields that limit when an action happens."""
    free = {"release": 0}
    return [name for name in _CONSTRAINTS if getattr(action, name) not in (None, free.get(name))]


def task_fields(uid: int, name: str, seconds: Fraction, format: int) -> dict[str, Value]:
    """The fields that each task has, in the order of the schema; more may stand between them."""
    return {
        "UID": uid,
        "ID": uid,
        "Name": name,
        "Active": 1,
        "Manual": 0,
        "Type": 1,
        "IsNull": 0,
        "WBS": str(uid),
        "OutlineNumber": str(uid),
        "OutlineLevel": 1,
        "Priority": 500,
        "Start": None,
        "Finish": None,
        "Duration": length_text(seconds),
        "ManualStart": None,
        "ManualFinish": None,
        "ManualDuration": None,
        "DurationFormat": format,
        "EffortDriven": 0,
        "Estimated": 0,
        "Milestone": int(seconds == 0),
        "Summary": 0,
    }


def add_link(one: ElementTree.Element, edge: Precedence, before: int, lag: Fraction) -> None:
    """Adds a link from a task, with its lag in seconds, which passes at all hours."""
    fields: dict[str, Value] = {
        "PredecessorUID": before,
        "Type": TYPES[edge.type],
        "CrossProject": 0,
        "LinkLag": int(lag / _STEP),
        "LagFormat": ELAPSED_MINUTES,
    }
    add(ElementTree.SubElement(one, "PredecessorLink"), fields)


def add_resources(book: Book, bases: int) -> None:
    """Adds the renewable resources, whose calendars have the UIDs after those of `bases`."""
    parent = ElementTree.SubElement(book.root, "Resources")
    for uid, resource in enumerate(book.task.resources, 1):
        one = ElementTree.SubElement(parent, "Resource")
        fields: dict[str, Value] = {
            "UID": uid,
            "ID": uid,
            "Name": resource.id,
            "Type": 1,
            "IsNull": 0,
            "MaxUnits": resource.capacity,
            "CalendarUID": bases + uid,
            "Notes": resource.description,
        }
        add(one, fields)
        add_label(one, RESOURCE_LABEL, resource.label)
