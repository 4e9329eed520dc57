"""Schedules for people: on the console, and in files of every kind."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from io import StringIO
from pathlib import Path
from typing import Any

from rich.console import Console

from irc.checks import run_checks
from irc.cli.output import Format
from irc.cli.page import PIPED_WIDTH, answer_console, in_a_file
from irc.cli.plans import read_schedule
from irc.cli.render import print_answer
from irc.cli.times import TimesStyle
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.driver.judge import Answer, validate_schedule
from irc.model import Task
from irc.model.times import json_number
from irc.reporting.analysis import analyse
from irc.reporting.files import Shown, write_shown
from irc.reporting.tables import Table, tables_of
from irc.schedule import Schedule


def known_schedule(path: str, task: Task) -> Answer:
    """The schedule in a file, with a note for each rule that it breaks.

    Raises `InputError` where the task has faults, or the schedule is of another task: it says so,
    or it names actions that the task does not have.
    """
    schedule, source = read_schedule(path, task)
    verdict = validate_schedule(task, schedule, source)
    known = {action.id for action in task.actions}
    strange = [k for k, entry in enumerate(schedule.entries) if entry.id not in known]
    if strange:
        name = schedule.entries[strange[0]].id
        more = f" and {len(strange) - 1} more" if len(strange) > 1 else ""
        message = f"this schedule is of another task: there is no action {name!r}{more}"
        hint = "give the task that it was made for"
        found = Diagnostic(Code.BAD_SCHEDULE, message, ("actions", strange[0], "id"), hint)
        raise InputError(Report((found,), source))
    notes = [
        Diagnostic(Code.BAD_SCHEDULE, f"the schedule is not valid: {violation}")
        for violation in (verdict.violations if schedule.answered else ())
    ]
    shown = replace(schedule.of(task), task=task.name, time_unit=task.time_unit)
    return Answer(shown, run_checks(task, lint=False).problem, tuple(notes))


def put_schedule(
    answer: Answer, shown: Shown, output: Path | None, times: TimesStyle | None, format: Format
) -> None:
    """Writes the file that is asked for, or else prints the schedule as text."""
    if output is not None:
        write_output(output, shown, answer, times)
    elif format is Format.text:
        print_answer(answer, answer_console(), times, all_rows=in_a_file())


def write_output(
    output: Path, shown: Shown, answer: Answer | None, times: TimesStyle | None = None
) -> None:
    """Writes a file of the kind that its ending names."""

    def text() -> str:
        return str(shown.schedule) if answer is None else text_of(answer, times)

    write_shown(output, replace(shown, text=text))


def text_of(answer: Answer, times: TimesStyle | None, width: int = PIPED_WIDTH) -> str:
    """The text of an answer with all of its rows, as in a file."""
    file = StringIO()
    print_answer(answer, Console(file=file, width=width), times, all_rows=True)
    return file.getvalue()


def tables_document(task: Task, schedule: Schedule) -> dict[str, Any]:
    """The document that `irc show --format json` prints: the rows of each table."""
    analysis = analyse(task, schedule)
    return {
        "irc_tables": "1",
        "task": task.name,
        "time_unit": task.time_unit,
        **({} if analysis.dates is None else analysis.dates.to_dict()),
        **{
            table.name: [_row(table, k) for k in range(len(table.rows))]
            for table in tables_of(analysis)
        },
    }


def _row(table: Table, k: int) -> dict[str, Any]:
    return {name: _json(table.rows[k][name]) for name in table.columns}


def _json(value: Any) -> Any:
    if isinstance(value, Fraction):
        return json_number(value)
    return value.isoformat() if hasattr(value, "isoformat") else value
