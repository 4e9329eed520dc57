"""Reads the time in an option."""

from __future__ import annotations

from irc.cli.exit_codes import EXIT_USE
from irc.cli.output import Format, fail
from irc.model import Task
from irc.model.quantities import Number, TimeError
from irc.model.times import parse_instant


def moment_of(task: Task, at: str, format: Format) -> Number:
    """The time in --at, in the task's unit; exits with wrong use if it is not a time."""
    try:
        moment = task.number(parse_instant(at))
    except TimeError as error:
        fail(EXIT_USE, f"--at {at}: {error}", format)
    if moment < 0:
        fail(EXIT_USE, f"--at {at}: the task begins at 0; give a time of 0 or later", format)
    return moment
