"""`irc show`: a saved schedule for people, or as a file of another kind."""

from __future__ import annotations

from typing import Annotated

import typer

from irc.cli.options import (
    FileArgument,
    FileOutOption,
    FormatOption,
    ProblemOption,
    TimesOption,
)
from irc.cli.output import Format, fail, print_notes, put_json, reporting_errors, say


def show(
    file: FileArgument,
    schedule: Annotated[
        str,
        typer.Argument(help="A schedule as JSON, or a plan of a PDDL domain; '-': standard input."),
    ],
    problem: ProblemOption = None,
    previous: Annotated[
        str | None,
        typer.Option("--previous", help="The schedule before it, to show what has changed."),
    ] = None,
    times: TimesOption = None,
    output: FileOutOption = None,
    format: FormatOption = Format.text,
) -> None:
    """Show a saved schedule of a task: as text, a report, a picture, tables or a calendar."""
    from irc.cli.exit_codes import EXIT_USE
    from irc.cli.showing import known_schedule, put_schedule, tables_document
    from irc.cli.times import require_times
    from irc.frontends.files import read_task
    from irc.reporting.files import Shown, require_fit, require_output

    with reporting_errors(format):
        if [file, schedule, previous].count("-") > 1:
            fail(EXIT_USE, "only one of the inputs can be standard input", format)
        require_output(output)
        reading = read_task(file, problem)
        require_fit(output, reading.task)
        require_times(reading.task, times)
        answer = known_schedule(schedule, reading.task)
        before = None if previous is None else known_schedule(previous, reading.task).schedule
        if format is Format.text:
            print_notes(reading.notes, reading.task.source)
            print_notes(answer.notes)
        put_schedule(answer, Shown(reading.task, answer.schedule, before), output, times, format)
        if format is Format.json:
            put_json(tables_document(reading.task, answer.schedule))
        elif output is not None:
            say(f"wrote {output}")
