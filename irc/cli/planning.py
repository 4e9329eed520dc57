"""Shared parts of the online commands: how they plan, and the inputs."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from irc.checks import run_checks
from irc.cli.exit_codes import EXIT_DONE, EXIT_USE
from irc.cli.output import Format, fail, print_notes
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Source
from irc.execution.execution import Execution, Presume
from irc.frontends.files import read_task
from irc.frontends.json.document import read_document
from irc.frontends.texts import STANDARD_INPUT, read_text
from irc.model import Task
from irc.model.canonical import task_sha256
from irc.model.quantities import Number
from irc.outcome import EXIT_STATUS
from irc.schedule import Schedule, Status
from irc.schedule.reading import schedule_from_json
from irc.targets import SolveOptions, get_backend


def require_engine(options: SolveOptions) -> None:
    """Raises `UnknownTarget` if there is no such target or engine."""
    get_backend(options.target).engine(options.engine)


def execution_of(
    task: Task,
    schedule: Schedule,
    options: SolveOptions,
    at: Number = 0,
    source: Source | None = None,
    presume: Presume = "assume",
) -> Execution:
    """The execution of a task by a schedule (read from `source`, if given), as of `at`.

    Raises `InputError` if the schedule does not fit the task.
    """
    try:
        return Execution(task, schedule, at, presume=presume, options=options)
    except InputError as error:
        raise InputError(Report(error.report.diagnostics, source)) from None


def one_standard_input(format: Format, *names: str | None) -> None:
    """Exits with wrong use if more than one of the inputs is standard input."""
    if sum(name == STANDARD_INPUT for name in names) > 1:
        fail(EXIT_USE, "only one of the inputs can be standard input", format)


def read_schedule(path: str) -> tuple[Schedule, Source]:
    """The schedule in a file, and its text. Raises `InputError`, also for one without entries."""
    document = read_document(*read_text(path))
    schedule = schedule_from_json(document.content, document.source)
    if not schedule.answered:
        raise _unsuited(
            f"this schedule has no plan: its status is {schedule.status}",
            "status",
            "give the previous schedule",
            document.source,
        )
    return schedule, document.source


def require_task(schedule: Schedule, source: Source, task: Task) -> None:
    """Raises `InputError` if a schedule belongs to another task."""
    if schedule.task_sha256 in (None, task_sha256(task)):
        return
    raise _unsuited(
        "this schedule was made for another task, or the task has changed since",
        "task_sha256",
        "give the task that it was made for (`irc replan --task-output` writes the task in force), "
        "or remove 'task_sha256' from the schedule to continue all the same",
        source,
    )


def _unsuited(message: str, field: str, hint: str, source: Source) -> InputError:
    return InputError(Report((Diagnostic(Code.BAD_SCHEDULE, message, (field,), hint),), source))


def schedule_to_begin_with(path: str, task: Task) -> tuple[Schedule, Source]:
    """The schedule in a file, which must belong to the task. Raises `InputError`."""
    schedule, source = read_schedule(path)
    require_task(schedule, source, task)
    return schedule, source


def read_sound_task(file: str, format: Format) -> Task:
    """The task in a file; prints notes on its text. Raises `InputError` for its faults.

    Whether the task has a schedule is not checked here: planning finds that.
    """
    reading = read_task(file)
    if format is Format.text:
        print_notes(reading.notes, reading.task.source)
    report = run_checks(reading.task, lint=False).report
    if any(not d.code.id.startswith("IRC3") for d in report.errors):
        raise InputError(report)
    return reading.task


def end_with(statuses: Sequence[Status]) -> None:
    """Exits if a step found no schedule, with the code for the first such step."""
    for status in statuses:
        if EXIT_STATUS[status] != EXIT_DONE:
            sys.exit(EXIT_STATUS[status])
