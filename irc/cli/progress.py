"""Progress of a long solve: one line on standard error, only on a terminal."""

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
    from rich.markup import escape

    name = escape(task.name or "task")
    with Console(stderr=True).status(f"solving {name} …") as status:

        def show(progress: Progress) -> None:
            # A gap is the same in ticks as in the task's unit.
            best = progress.makespan
            gap = "" if not best else f", gap {100 * (best - progress.bound) / best:.1f} %"
            status.update(
                f"solving {name}: {progress.engine} has an answer after "
                f"{progress.seconds:.1f} s{gap}"
            )

        yield show
