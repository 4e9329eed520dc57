"""Writes a schedule as a project whose tasks stay at their dates.

Each entry is a manually scheduled task with its start, finish and resources; the calendar of the
project is open at all hours, so that a duration is the time from start to finish.
"""

from __future__ import annotations

from fractions import Fraction
from xml.etree import ElementTree

from irc.frontends.exporters.refusal import Refusals
from irc.frontends.ms_project.book import (
    ALWAYS_OPEN,
    MINUTES,
    TASK_LABEL,
    Book,
    Value,
    add,
    add_calendars,
    add_label,
    length_text,
)
from irc.frontends.ms_project.writer import (
    add_link,
    add_resources,
    require_writable,
    task_fields,
)
from irc.model import Action, Task
from irc.schedule import Entry, Schedule


def write_planned_project(task: Task, schedule: Schedule, baseline: bool) -> str:
    """The text of a schedule as a project; with `baseline` its dates are baseline 0, too.

    Links of tasks that are both in the schedule are written with their least lags. Raises
    `InputError` for names that XML cannot hold.
    """
    refusals = Refusals(task, "MS Project")
    require_writable(task, refusals)
    refusals.raise_any()
    book, entries = Book(task), list(schedule)
    unit = Fraction(task.clock.unit)
    book.head(book.wall(Fraction(schedule.makespan) * unit))
    add_calendars(book.root, [ALWAYS_OPEN], [(resource.id, 1) for resource in task.resources])
    _add_tasks(book, entries, unit, baseline=baseline)
    add_resources(book, 1)
    _add_assignments(book, entries, unit)
    return book.text()


def _add_tasks(book: Book, entries: list[Entry], unit: Fraction, *, baseline: bool) -> None:
    parent = ElementTree.SubElement(book.root, "Tasks")
    actions = {action.id: action for action in book.task.actions}
    uids = {entry.id: uid for uid, entry in enumerate(entries, 1) if entry.occurrence == 1}
    for uid, entry in enumerate(entries, 1):
        one = ElementTree.SubElement(parent, "Task")
        add(one, _task(book, entry, actions[entry.id], uid, unit))
        for edge in book.task.precedence if entry.occurrence == 1 else ():
            if edge.after == entry.id and edge.before in uids:
                lag = Fraction(book.task.number(edge.min_lag)) * unit
                add_link(one, edge, uids[edge.before], lag)
        add_label(one, TASK_LABEL, actions[entry.id].label)
        if baseline:
            add(ElementTree.SubElement(one, "Baseline"), _baseline(book, entry, unit))


def name_of(entry: Entry) -> str:
    """The id of the entry's action, with the number of a later occurrence."""
    return entry.id if entry.occurrence == 1 else f"{entry.id} ({entry.occurrence})"


def _task(book: Book, entry: Entry, action: Action, uid: int, unit: Fraction) -> dict[str, Value]:
    start, finish = (book.wall(Fraction(time) * unit) for time in (entry.start, entry.end))
    seconds = Fraction(entry.duration) * unit
    due = None if action.due is None else Fraction(book.task.number(action.due)) * unit
    return {
        **task_fields(uid, name_of(entry), seconds, MINUTES),
        "Manual": 1,
        "Start": start,
        "Finish": finish,
        "ManualStart": start,
        "ManualFinish": finish,
        "ManualDuration": length_text(seconds),
        "ConstraintType": 0,
        "CalendarUID": -1,
        "Deadline": None if due is None else book.wall(due),
        "Notes": action.description,
    }


def _baseline(book: Book, entry: Entry, unit: Fraction) -> dict[str, Value]:
    return {
        "Number": 0,
        "Start": book.wall(Fraction(entry.start) * unit),
        "Finish": book.wall(Fraction(entry.end) * unit),
        "Duration": length_text(Fraction(entry.duration) * unit),
        "DurationFormat": MINUTES,
    }


def _add_assignments(book: Book, entries: list[Entry], unit: Fraction) -> None:
    parent = ElementTree.SubElement(book.root, "Assignments")
    resources = {resource.id: uid for uid, resource in enumerate(book.task.resources, 1)}
    for uid, entry in enumerate(entries, 1):
        for name, amount in entry.resources.items():
            if name not in resources:
                continue
            fields: dict[str, Value] = {
                "UID": len(parent) + 1,
                "TaskUID": uid,
                "ResourceUID": resources[name],
                "Finish": book.wall(Fraction(entry.end) * unit),
                "Start": book.wall(Fraction(entry.start) * unit),
                "Units": amount,
                "Work": length_text(Fraction(entry.duration) * unit * amount),
            }
            add(ElementTree.SubElement(parent, "Assignment"), fields)
