"""The time that an option names."""

from __future__ import annotations

from irc.cli.exit_codes import EXIT_USE
from irc.cli.output import Format, fail
from irc.model import Task
from irc.model.quantities import Number, TimeError
from irc.model.times import parse_instant


def moment_of(task: Task, at: str, format: Format) -> Number:
    """The time that --at names, in the task's unit; ends with wrong use where it names none."""
    try:
        moment = task.number(parse_instant(at))
    except TimeError as error:
        fail(EXIT_USE, f"--at {at}: {error}", format)
    if moment < 0:
        fail(EXIT_USE, f"--at {at}: the task begins at 0, so nothing can happen before", format)
    return moment
