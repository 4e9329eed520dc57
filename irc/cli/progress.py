"""Progress of a long search: one line on standard error, only on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irc.model import Task
    from irc.targets import OnProgress, Progress


@contextmanager
def progress_shown(task: Task) -> Iterator[OnProgress | None]:
    """A callback for engines that updates the line; None if standard error is not a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console

    from irc.cli.page import Page

    console = Console(stderr=True)
    line = ProgressLine(Page(console).visible(task.name or "task"), task.time_unit)
    with console.status(line):
        yield line.update


class ProgressLine:
    """The line: drawn again and again, so that the seconds go on."""

    def __init__(self, name: str, unit: str) -> None:
        from irc.targets import Budget

        self.name, self.unit = name, unit
        self.budget = Budget()
        self.progress: Progress | None = None

    def update(self, progress: Progress) -> None:
        """Shows a progress from now on."""
        self.progress = progress

    def __rich__(self) -> str:
        """The line, for rich."""
        from rich.markup import escape

        return escape(str(self))

    def __str__(self) -> str:
        """Such as "supper: makespan 40 min, bound 35 (gap 12.5 %), 3 s, ortools; ^C ends it"."""
        seconds = f"{self.budget.elapsed:.0f} s"
        if self.progress is None:
            return f"{self.name}: no answer yet, {seconds}; ^C ends it"
        shown = ", ".join((self._value(self.progress), seconds, self.progress.engine))
        return f"{self.name}: {shown}; ^C ends it with this answer"

    def _value(self, progress: Progress) -> str:
        from irc.cli.page import grouped
        from irc.model.objectives import is_time

        unit = f" {self.unit}" if is_time(progress.objective) else ""
        value = f"{progress.objective} {grouped(progress.value)}{unit}"
        if progress.bound is None or progress.gap is None:
            return value
        if not progress.gap:
            return f"{value}, the best"
        return f"{value}, bound {grouped(progress.bound)} (gap {100 * progress.gap:.1f} %)"
