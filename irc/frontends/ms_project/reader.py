"""Reads a project of MS Project: its tasks are actions that pause by their calendars.

Source of the format: Microsoft, "Project XML Data Interchange Schema Reference" (mspdi_pj12.xsd).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from decimal import Decimal
from typing import Any

from irc.diagnostics import Report
from irc.frontends.importers.scheduling_files.projects import stem_of, task_of
from irc.frontends.ms_project.book import RESOURCE_LABEL, TASK_LABEL
from irc.frontends.ms_project.calendars import (
    ALWAYS,
    WorkCalendar,
    calendar_document,
    read_calendars,
)
from irc.frontends.ms_project.elements import Element, parse_project
from irc.frontends.ms_project.links import ELAPSED, read_links, time_of
from irc.frontends.ms_project.outline import Ids, Item, Outline, read_outline
from irc.frontends.ms_project.resources import Staff, read_staff
from irc.model import Task

METADATA = "ms_project"
"""The entry of the metadata for what is no part of the task: outline, baselines, materials."""

_ALWAYS = WorkCalendar("always", (ALWAYS,) * 7)
_AS_LATE_AS_POSSIBLE = 1
_FIELDS: Mapping[int, tuple[str, ...]] = {
    2: ("start",),
    3: ("earliest_end", "deadline"),
    4: ("release",),
    5: ("latest_start",),
    6: ("earliest_end",),
    7: ("deadline",),
}
"""The fields of an action that a constraint with a date sets, by its type."""


@dataclass
class _Calendars:
    """The calendars by UID, and the ids of those that the task needs."""

    by_uid: dict[int, WorkCalendar]
    usual: WorkCalendar
    ids: Ids
    named: dict[int, tuple[str, WorkCalendar]]

    def id_of(self, calendar: WorkCalendar) -> str | None:
        """The id of a calendar in the IR; None where it restricts nothing."""
        plain = calendar.plain
        if plain.is_always_open:
            return None
        if id(plain) not in self.named:
            self.named[id(plain)] = self.ids.take(plain.name, "calendar"), plain
        return self.named[id(plain)][0]

    def of_task(self, item: Item) -> WorkCalendar | None:
        """The calendar that a task names itself."""
        uid = item.element.whole("CalendarUID", -1)
        if uid >= 0 and uid not in self.by_uid:
            place = item.element.at("CalendarUID")
            place.faults.add(place, f"there is no calendar with the UID {uid}")
        return self.by_uid.get(uid)


def read_ms_project(text: str, name: str) -> tuple[Task, Report]:
    """The task of a project, and warnings about what is read differently from what it says.

    Raises `InputError` with every fault and its place, and `EngineMissing` without defusedxml
    (`pip install 'irc-compiler[files]'`).
    """
    project = parse_project(text, name)
    document = _document(project, stem_of(name))
    project.faults.raise_any()
    source = project.faults.source
    return task_of(document, source).with_source(source), project.faults.report()


def _document(project: Element, stem: str) -> dict[str, Any]:
    origin = project.date("StartDate")
    if origin is None:
        project.faults.add(project, "the project has no StartDate, from which its times count")
        origin = datetime(2000, 1, 3)
    if not project.flag("ScheduleFromStart", True):
        message = "a project that is scheduled from its finish date is not read"
        hint = "schedule it from the start, with a deadline or a finish-no-later-than constraint"
        project.faults.add(project.at("ScheduleFromStart"), message, hint)
    ids = Ids()
    outline = read_outline(project, ids)
    calendars = _calendars(project)
    staff = read_staff(project, outline, calendars.by_uid, calendars.usual)
    links = read_links(outline, _Open(origin, calendars, staff), ids)
    limits = _Limits(origin)
    actions = [_action(item, staff, calendars, limits) for item in outline.leaves]
    document = {
        "name": project.said("Title") or project.said("Name") or stem,
        "description": project.said("Subject"),
        "time_unit": "min",
        "origin": origin.isoformat(),
        "resources": [*_resources(staff, calendars)],
        "actions": actions + links.lags,
        "precedence": links.precedence,
        "groups": [*_groups(outline, limits)],
        "calendars": [],
        "metadata": _metadata(outline, staff),
    }
    _warn_of_progress(outline)
    document["calendars"] = [
        calendar_document(calendar, id, project) for id, calendar in calendars.named.values()
    ]
    return {key: value for key, value in document.items() if value not in ([], {}, "")}


def _calendars(project: Element) -> _Calendars:
    by_uid = read_calendars(project)
    uid = project.whole("CalendarUID", -1)
    if uid not in by_uid and (by_uid or uid >= 0):
        project.faults.add(project.at("CalendarUID"), "the project's own calendar is missing")
    usual = by_uid.get(uid)
    if usual is None and not by_uid and uid < 0:
        message = "the project has no calendar, so that it is read as open at all hours"
        project.faults.warn(project, message)
    return _Calendars(by_uid, usual or _ALWAYS, Ids(), {})


def _resources(staff: Staff, calendars: _Calendars) -> Iterator[dict[str, Any]]:
    for uid, one in staff.resources.items():
        capacity = int(one.capacity * staff.unit(uid))
        calendar = calendars.id_of(one.calendar)
        found: dict[str, Any] = {"id": one.id}
        if label := one.element.extended(RESOURCE_LABEL):
            found["label"] = label
        if one.element.said("Notes"):
            found["description"] = one.element.said("Notes")
        if capacity != 1:
            found["capacity"] = capacity
        yield {**found, "calendar": calendar} if calendar else found


def _action(item: Item, staff: Staff, calendars: _Calendars, limits: _Limits) -> dict[str, Any]:
    one = item.element
    found: dict[str, Any] = {"id": item.id}
    label = one.extended(TASK_LABEL) or (item.name if item.id != item.name else "")
    if label:
        found["label"] = label
    if one.said("Notes"):
        found["description"] = one.said("Notes")
    duration = _duration(item)
    found["duration"] = time_of(duration)
    if uses := staff.uses(item.uid):
        found["uses"] = uses
    if duration:
        found.update(_open_times(item, staff, calendars))
    if one.flag("Manual"):
        start = one.date("ManualStart") or one.date("Start")
        return {**found, **({"start": start.isoformat()} if start else {})}
    if one.whole("LevelingDelay"):
        one.faults.warn(
            one.at("LevelingDelay"), f"task {item.name!r}: its leveling delay is left out"
        )
    return {**found, **_limits(item, limits), **_due(item, limits)}


def _duration(item: Item) -> Decimal:
    """The duration of a task in minutes."""
    one = item.element
    seconds = one.seconds("ManualDuration") if one.flag("Manual") else None
    seconds = one.seconds("Duration") if seconds is None else seconds
    if seconds is None:
        if not one.flag("Milestone"):
            one.faults.add(one, f"task {item.name!r} has no Duration")
        return Decimal(0)
    return seconds / 60


def _open_times(item: Item, staff: Staff, calendars: _Calendars) -> dict[str, Any]:
    """The calendar of a task and its pauses.

    A task works at the open times of its own calendar and of its resources; the project's calendar
    counts where it has neither.
    """
    one, name = item.element, f"task {item.name!r}"
    own = calendars.of_task(item)
    held = [staff.resources[uid].calendar for uid in staff.held.get(item.uid, {})]
    working = [calendar for calendar in held if not calendar.is_always_open]
    if one.whole("DurationFormat", 7) in ELAPSED:
        if working:
            message = f"{name} lasts an elapsed time, but its resources have closed times"
            one.faults.add(one.at("DurationFormat"), message, "write working time")
        return {}
    if own is not None and one.flag("IgnoreResourceCalendar"):
        if any(calendar.contents != own.contents for calendar in working):
            message = f"{name} ignores the calendars of its resources, which the IR cannot say"
            one.faults.add(one.at("IgnoreResourceCalendar"), message)
    elif len({calendar.contents for calendar in working}) > 1:
        message = f"{name} is carried out when all of its resources work"
        one.faults.warn(one, message, "in MS Project each resource works by its own calendar")
    mine = own if own is not None or held else calendars.usual
    id = calendars.id_of(mine) if mine else None
    if id is None:
        return {"breaks": "pause"} if working else {}
    return {"calendar": id, "breaks": "pause"}


@dataclass
class _Open:
    """Answers the questions of the links about open times (`links.Open`)."""

    origin: datetime
    calendars: _Calendars
    staff: Staff

    def of_lag(self, item: Item) -> str | None:
        return self.calendars.id_of(self._calendar(item))

    def _calendar(self, item: Item) -> WorkCalendar:
        """The calendar of lags before a task: its own, else that of the project."""
        return self.calendars.of_task(item) or self.calendars.usual

    def is_open_before(self, befores: Sequence[Item], after: Item, lag: Decimal) -> bool:
        needed = timedelta(minutes=float(lag))
        calendar = self._calendar(after)
        ends = [self._earliest_end(item) for item in befores]
        return bool(ends) and calendar.open_time(self.origin, max(ends)) >= needed

    def works_within(self, befores: Sequence[Item], after: Item) -> bool:
        calendar = self._calendar(after)
        return all(
            _duration(item) and any(one.is_within(calendar) for one in self._of_work(item))
            for item in befores
        )

    def _of_work(self, item: Item) -> list[WorkCalendar]:
        """The calendars at whose common open times a task works; none for an elapsed time."""
        if item.element.whole("DurationFormat", 7) in ELAPSED:
            return []
        held = [self.staff.resources[uid].calendar for uid in self.staff.held.get(item.uid, {})]
        own = self.calendars.of_task(item)
        return [*held, own] if own else held or [self.calendars.usual]

    def _earliest_end(self, item: Item) -> datetime:
        """An instant before which a task surely does not end."""
        length = timedelta(minutes=float(_duration(item)))
        ends = [self.origin + length]
        ends += [one.end_of_work(self.origin, length) for one in self._of_work(item)]
        return max(ends)


class _Limits:
    """The instants that limit tasks, none of which is before the project's start."""

    def __init__(self, origin: datetime) -> None:
        self.origin = origin

    def time(self, one: Element, name: str) -> str | None:
        """A date that is not before the project starts."""
        found = one.date(name)
        if found is not None and found < self.origin:
            one.faults.add(one.at(name), f"{name}: {found} is before the project's start")
        return None if found is None else found.isoformat()


def _limits(item: Item, limits: _Limits) -> dict[str, Any]:
    """The limits from the constraints of a task and of the summary tasks above it."""
    found = _constraint(item, limits)
    above = item.parent
    while above is not None:
        kind, date = above.element.whole("ConstraintType"), above.element.date("ConstraintDate")
        if date is not None and kind == 4:
            least = max(found.get("release", ""), date.isoformat())
            if date > limits.origin:
                found["release"] = least
        elif (
            date is not None
            and kind == 7
            and (time := limits.time(above.element, "ConstraintDate"))
        ):
            found["deadline"] = min(found.get("deadline", "9999"), time)
        above = above.parent
    return found


def _constraint(item: Item, limits: _Limits) -> dict[str, Any]:
    one = item.element
    kind, name = one.whole("ConstraintType"), f"task {item.name!r}"
    if kind == _AS_LATE_AS_POSSIBLE:
        message = f"{name} is carried out as late as possible: it is read as free to be at any time"
        one.faults.warn(one.at("ConstraintType"), message)
    if kind in (0, _AS_LATE_AS_POSSIBLE):
        return {}
    date = one.date("ConstraintDate")
    if not 0 <= kind <= 7 or date is None:
        what = "ConstraintType: expected 0 to 7" if date else "its constraint has no ConstraintDate"
        one.faults.add(one.at("ConstraintType"), f"{name}: {what}")
        return {}
    if kind in (4, 6) and date <= limits.origin:
        return {}
    time = date.isoformat() if kind == 4 else limits.time(one, "ConstraintDate")
    return dict.fromkeys(_FIELDS[kind], time) if time else {}


def _due(item: Item, limits: _Limits) -> dict[str, Any]:
    due = limits.time(item.element, "Deadline")
    return {"due": due} if due else {}


def _groups(outline: Outline, limits: _Limits) -> Iterator[dict[str, Any]]:
    """A group for each summary task that has a deadline, which is due."""
    ids = Ids()
    for item in outline.items.values():
        if not item.is_summary:
            continue
        one = item.element
        if one.whole("ConstraintType") not in (0, 4, 7):
            message = f"the summary task {item.name!r} has a constraint other than SNET and FNLT"
            one.faults.add(one.at("ConstraintType"), message, "constrain the tasks under it")
        if due := _due(item, limits):
            members = [leaf.id for leaf in item.leaves()]
            yield {"id": ids.take(item.name, f"{item.uid}"), "actions": members, **due}


def _warn_of_progress(outline: Outline) -> None:
    begun = [
        item
        for item in outline.leaves
        if item.element.whole("PercentComplete") or item.element.date("ActualStart")
    ]
    if begun:
        one = begun[0].element
        place = one.at("PercentComplete" if one.whole("PercentComplete") else "ActualStart")
        message = f"{len(begun)} task(s) have begun: all are planned anew, as if none had"
        one.faults.warn(place, message, "irc step goes on with a running schedule: docs/online.md")


def _metadata(outline: Outline, staff: Staff) -> dict[str, Any]:
    """The outline, the baselines and the materials of tasks, by the ids of their actions."""
    leaves = outline.leaves
    found = {
        "outline": {item.id: item.path() for item in leaves if item.parent},
        "baselines": {item.id: rows for item in leaves if (rows := [*_baselines(item.element)])},
        "materials": {id: dict(units) for id, units in staff.materials.items()},
    }
    kept = {key: value for key, value in found.items() if value}
    return {METADATA: kept} if kept else {}


def _baselines(one: Element) -> Iterator[dict[str, Any]]:
    for baseline in one.all("Baseline"):
        start, finish = baseline.date("Start"), baseline.date("Finish")
        yield {
            "number": baseline.whole("Number"),
            **({"start": start.isoformat()} if start else {}),
            **({"finish": finish.isoformat()} if finish else {}),
            **({"duration": baseline.said("Duration")} if baseline.said("Duration") else {}),
        }
