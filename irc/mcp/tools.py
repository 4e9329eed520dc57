"""The tools: each reads its input, works within a budget, and returns one JSON document.

The documents are those that the commands of the same name print with `--format json`. A fault of
the input is a result too: the diagnostics, with `outcome`.
"""

from __future__ import annotations

import json
from typing import Any

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Source
from irc.errors import IrcError, OptionError
from irc.frontends.files import Reading, parse_task
from irc.model import Task
from irc.model.quantities import Number, TimeError
from irc.model.times import parse_instant
from irc.schedule import Schedule
from irc.schedule.reading import schedule_from_json
from irc.targets import Cancellation, SolveOptions

MOST_CHARACTERS = 2**20
"""Limit on the text of one argument."""

MOST_SECONDS = 300.0
DEFAULT_SECONDS = 10.0
"""The time that a call may take to plan."""

MEMORY_MB = 2048
"""Limit on an engine that runs as a process of its own."""

Document = dict[str, Any]
Given = str | dict[str, Any]
"""A task, schedule or event: text in any language of irc, or a JSON object."""


def answered(error: IrcError) -> Document:
    """The document of a call that failed: the diagnostics, or one message."""
    if isinstance(error, InputError):
        rendered = error.report.render(notes=False)
        return {**error.report.to_dict(), "text": rendered}
    return {"irc_error": "1", "message": str(error), "outcome": error.outcome.to_dict()}


def check(task: Given) -> Document:
    """The diagnostics of a task."""
    from irc.driver.compile import check_task

    try:
        reading = _task(task)
        report = check_task(reading.task, reading.notes)
    except InputError as error:
        report = error.report
    return {**report.to_dict(), "text": report.render()}


def solve(
    task: Given, target: str, engine: str, time_limit: float, cancel: Cancellation
) -> Document:
    """The best schedule found within the time limit."""
    from irc.driver.solve import solve_task

    reading = _task(task)
    options = SolveOptions(target, engine, _seconds(time_limit), MEMORY_MB, cancel=cancel)
    return solve_task(reading.task, options).schedule.to_dict()


def validate(task: Given, schedule: Given, at: str | float | None) -> Document:
    """The verdict on a schedule: every violation by name."""
    from irc.driver.judge import validate_schedule

    known = _task(task).task
    found, source = _schedule(schedule)
    moment = None if at is None else _moment(known, at)
    return validate_schedule(known, found, source, at=moment).to_dict()


def explain(task: Given, time_limit: float, cancel: Cancellation) -> Document:
    """Why a task has no schedule, or why none is shorter."""
    from irc.explanation import explain_task

    reading = _task(task)
    return explain_task(reading.task, _seconds(time_limit), cancel=cancel).to_dict()


def replan(
    task: Given,
    schedule: Given,
    at: str | float,
    events: str | list[dict[str, Any]] | dict[str, Any] | None,
    time_limit: float,
    cancel: Cancellation,
) -> Document:
    """The step of a running task: the rest of its schedule planned again, after events."""
    from irc.execution.execution import Execution
    from irc.frontends.events import parse_events
    from irc.model.times import json_number

    known = _task(task).task
    before, _ = _schedule(schedule)
    moment = _moment(known, at)
    options = SolveOptions(time_limit=_seconds(time_limit), memory_limit=MEMORY_MB, cancel=cancel)
    execution = Execution(known, before, moment, options=options)
    notes: list[Diagnostic] = []
    if events is not None:
        placed, _, _ = parse_events(_text(events, "events"), "events", json_number(moment))
        for event in placed:
            try:
                notes += event.notes(execution.apply(event.event))
            except InputError as error:
                raise InputError(event.anchored(error.report)) from None
    step = execution.replan()
    return {"irc_step": "1", **step.to_dict()}


def schema(strict: bool, event: bool) -> Document:
    """The JSON Schema of a task, or of an event; `strict` is the small one."""
    from irc.model import Event
    from irc.model.strict_schema import strict_schema

    if strict:
        return strict_schema("event" if event else "task")
    made = (Event if event else Task).model_json_schema(by_alias=True)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **made}


# --- input --------------------------------------------------------------------------------------


def _text(given: object, name: str) -> str:
    """An argument as text. Raises `InputError` for one that is too long."""
    text = given if isinstance(given, str) else json.dumps(given, ensure_ascii=False, indent=1)
    if len(text) > MOST_CHARACTERS:
        message = f"{name} has {len(text):,} characters; at most {MOST_CHARACTERS:,} are read"
        finding = Diagnostic(Code.TOO_LARGE, message, hint="use the command `irc` on a file")
        raise InputError(Report((finding,)))
    return text


def _task(given: Given) -> Reading:
    return parse_task(_text(given, "task"), "task")


def _schedule(given: Given) -> tuple[Schedule, Source]:
    from irc.frontends.json.document import read_document

    document = read_document(_text(given, "schedule"), "schedule")
    schedule = schedule_from_json(document.content, document.source)
    if not schedule.answered:
        message = f"this schedule has no plan: its status is {schedule.status}"
        finding = Diagnostic(Code.BAD_SCHEDULE, message, ("status",), "give one that has entries")
        raise InputError(Report((finding,), document.source))
    return schedule, document.source


def _moment(task: Task, at: str | float) -> Number:
    try:
        moment = task.number(parse_instant(at))
    except TimeError as error:
        raise OptionError(f"at: {error}") from None
    if moment < 0:
        raise OptionError(f"at: {at} is before the task begins, at 0")
    return moment


def _seconds(time_limit: float) -> float:
    if not 0 < time_limit <= MOST_SECONDS:
        raise OptionError(f"time_limit is {time_limit:g}; it must be in (0, {MOST_SECONDS:g}]")
    return time_limit
