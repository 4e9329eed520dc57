"""Writes a schedule as a calendar (iCalendar, RFC 5545): an event for each entry."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from fractions import Fraction
from hashlib import sha256
from importlib.util import find_spec
from typing import Any

from irc.frontends.exporters.refusal import Refusals
from irc.model import Action, Task
from irc.model.times import format_number, in_utc
from irc.schedule import Entry, Schedule
from irc.targets import EngineMissing

_STAMP = datetime(2000, 1, 1, tzinfo=UTC)
"""RFC 5545 wants the time at which an event was made; a fixed one keeps equal schedules equal."""


def write_icalendar(task: Task, schedule: Schedule, baseline: bool = False) -> str:
    """The text of a schedule as a calendar; `baseline` is for other formats.

    Raises `InputError` for a task without an `origin`, and `EngineMissing` without icalendar
    (`pip install 'irc-compiler[files]'`).
    """
    refusals = Refusals(task, "a calendar")
    if task.origin is None:
        hint = 'write "origin": the date-time of t = 0, such as "2026-03-02T08:00:00+01:00"'
        refusals.add("a calendar needs dates, and the task has no 'origin'", (), hint)
    refusals.raise_any()
    icalendar = _icalendar()
    calendar = icalendar.Calendar()
    calendar.add("prodid", "-//irc-compiler//schedule//EN")
    calendar.add("version", "2.0")
    calendar.add("x-wr-calname", task.name or "schedule")
    actions = {action.id: action for action in task.actions}
    for entry in schedule:
        event = icalendar.Event()
        for name, value in _fields(task, entry, actions[entry.id]):
            event.add(name, value)
        calendar.add_component(event)
    text: str = calendar.to_ical().decode()
    return text


def _icalendar() -> Any:
    if find_spec("icalendar") is None:
        raise EngineMissing("calendars need icalendar: pip install 'irc-compiler[files]'")
    import icalendar

    return icalendar


def _fields(task: Task, entry: Entry, action: Action) -> Iterator[tuple[str, Any]]:
    """The properties of an event, in order."""
    yield "uid", _uid(task, entry)
    yield "dtstamp", _STAMP
    name = action.label or entry.id
    yield "summary", name if entry.occurrence == 1 else f"{name} ({entry.occurrence})"
    yield "dtstart", _date(task, Fraction(entry.start))
    yield "dtend", _date(task, Fraction(entry.end))
    if entry.resources:
        labels = {resource.id: resource.label or resource.id for resource in task.resources}
        held = [labels.get(id, id) for id in entry.resources]
        yield "location", ", ".join(held)
        yield "categories", held
    if description := "\n".join(_lines(task, entry, action)):
        yield "description", description


def _lines(task: Task, entry: Entry, action: Action) -> Iterator[str]:
    if action.description is not None:
        yield action.description
    for id, amount in entry.resources.items():
        if amount > 1:
            yield f"{id}: {amount}"
    if entry.mode is not None:
        yield f"mode: {entry.mode}"
    if entry.paused:
        yield f"paused: {format_number(entry.paused)} {task.time_unit}"
    if entry.status is not None:
        yield f"status: {entry.status}"
    for field in ("due", "deadline"):
        limit = getattr(action, field)
        if limit is not None:
            yield f"{field}: {_date(task, Fraction(task.number(limit))).isoformat(' ')}"


def _uid(task: Task, entry: Entry) -> str:
    """The same for the same occurrence of the same task, so that a new plan moves its events."""
    said = "\0".join([task.name or "", entry.id, str(entry.occurrence)])
    return f"{sha256(said.encode()).hexdigest()[:32]}@irc-compiler"


def _date(task: Task, time: Fraction) -> datetime:
    """A time as a date: in UTC where the origin, or the calendars, have a zone, else without."""
    origin, zone = task.origin, task.clock.zone
    assert origin is not None
    if zone is not None:
        origin = in_utc(origin, zone)
    passed = timedelta(microseconds=round(time * task.clock.unit * 1_000_000))
    found = (origin if origin.tzinfo is None else origin.astimezone(UTC)) + passed
    return found.replace(microsecond=0)
