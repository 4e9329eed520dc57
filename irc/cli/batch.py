"""`irc batch`: many tasks for several targets and engines, on all cores or a cluster."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irc.cli.exit_codes import EXIT_USE
from irc.cli.options import (
    FormatOption,
    MemoryLimitOption,
    OutOption,
    SchedulerOption,
    SeedOption,
    TimeLimitOption,
)
from irc.cli.output import Format, fail, put, put_json, reporting_errors, say

if TYPE_CHECKING:
    from irc.batches.batch import Batch
    from irc.batches.result import BatchResult
    from irc.batches.summary import Summary

LINES_SHOWN = 20
"""Longer lists of trials without a schedule end in "and N more"."""


TasksArgument = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="FILE...",
        help="Tasks: files, folders, patterns, JSON lines; '-': JSON lines on standard input.",
    ),
]
TargetsOption = Annotated[
    list[str] | None, typer.Option("--target", "-t", help="cpsat, pddl21, …; several times.")
]
EnginesOption = Annotated[
    list[str] | None,
    typer.Option("--engine", "-e", help="An engine of the targets that have it; several times."),
]
SourceOption = Annotated[
    str, typer.Option("--from", help="The format of the tasks, as in `irc convert`.")
]
DomainOption = Annotated[
    str | None, typer.Option("--domain", help="With --from pddl: the domain of all problems.")
]
ProcessesOption = Annotated[
    int | None,
    typer.Option("--processes", "-j", min=1, max=4096, help="Default: one for each core."),
]
FinishOption = Annotated[
    bool,
    typer.Option(
        "--finish-locally/--no-finish-locally",
        help="If the cluster goes away: go on here, or stop.",
    ),
]
ThreadsOption = Annotated[
    int, typer.Option("--workers", min=1, max=10_000, help="Threads of the engine, per process.")
]
ShortcutOption = Annotated[
    bool,
    typer.Option(
        "--shortcut/--no-shortcut",
        help="Solve by the critical path alone if there is no contention.",
    ),
]
AgainOption = Annotated[
    list[str] | None,
    typer.Option("--again", help="Solve again what ended with this status; several times."),
]
SchedulesOption = Annotated[
    bool, typer.Option("--schedules", help="Put the schedule into each result.")
]
ResultsOption = Annotated[
    Path | None,
    typer.Option("--results", help="Only summarise this file of results; solve nothing."),
]
PlotOption = Annotated[Path | None, typer.Option("--plot", help="Write the cactus plot as SVG.")]


def batch(
    inputs: TasksArgument = None,
    targets: TargetsOption = None,
    engines: EnginesOption = None,
    source: SourceOption = "irc",
    domain: DomainOption = None,
    processes: ProcessesOption = None,
    scheduler: SchedulerOption = None,
    finish_locally: FinishOption = True,
    time_limit: TimeLimitOption = 60.0,
    memory_limit: MemoryLimitOption = None,
    workers: ThreadsOption = 1,
    seed: SeedOption = 0,
    shortcut: ShortcutOption = True,
    again: AgainOption = None,
    schedules: SchedulesOption = False,
    results: ResultsOption = None,
    plot: PlotOption = None,
    output: OutOption = None,
    format: FormatOption = Format.text,
) -> None:
    """Solve many tasks for each target and engine; with -o, go on where a batch has ended."""
    from irc.batches.batch import Batch, BatchOptions
    from irc.batches.inputs import InputOptions
    from irc.batches.trial import AUTO, TrialOptions
    from irc.cli.interruption import INTERRUPTION
    from irc.driver.files import require_file

    with reporting_errors(format), INTERRUPTION.planning() as cancel:
        require_file(plot, (".svg",))
        if results is not None:
            _summarise(results, inputs, format, plot)
            return
        if not inputs:
            fail(EXIT_USE, "name tasks to solve, or results to summarise (--results)", format)
        options = BatchOptions(
            targets or ("cpsat",),
            engines or (AUTO,),
            InputOptions(source, domain),
            TrialOptions(time_limit, memory_limit, workers, seed, shortcut),
            processes,
            scheduler,
            finish_locally,
            output,
            again or (),
            schedules,
            cancel,
            lambda text: say(f"warning: {text}"),
        )
        summary = _run(Batch(inputs, options), format)
        if output is not None:
            summary = _summary_of(output)
        _show(summary, plot, format)


def _run(batch: Batch, format: Format) -> Summary:
    """The summary of a batch, whose results are shown as they come."""
    from irc.batches.summary import Summary

    summary, unsolved = Summary(), _Unsolved(format)
    with _quiet_cluster(), _progress_shown(batch) as advance:
        for result in batch:
            summary.add(result)
            if format is Format.json:
                put(result.line())
            unsolved.add(result)
            advance()
    unsolved.end()
    if batch.kept and format is Format.text:
        say(f"{batch.kept:,} of {batch.total:,} trials had a result already")
    if not batch.is_complete:
        say("interrupted: the same command with the same -o goes on from here")
    return summary


class _Unsolved:
    """The trials without a schedule that are named on standard error."""

    def __init__(self, format: Format) -> None:
        self.count = 0
        self.format = format

    def add(self, result: BatchResult) -> None:
        if result.outcome.answered or result.proven or self.format is Format.json:
            return
        self.count += 1
        if self.count <= LINES_SHOWN:
            shown = [d.to_dict().get("message") for d in result.outcome.diagnostics[:1]]
            say(f"{_plain(str(result))}: {_plain(str((shown or [result.outcome.message])[0]))}")

    def end(self) -> None:
        if self.count > LINES_SHOWN:
            say(f"… and {self.count - LINES_SHOWN:,} more without a schedule")


def _plain(text: str) -> str:
    """A text without control characters, which a file's name may have."""
    return "".join(c if c.isprintable() else "�" for c in text)


def _summary_of(path: Path) -> Summary:
    from irc.batches.results_file import read_results
    from irc.batches.summary import Summary

    return Summary(read_results(path))


def _summarise(path: Path, inputs: list[str] | None, format: Format, plot: Path | None) -> None:
    if inputs:
        fail(EXIT_USE, "--results summarises a file and solves nothing: name no tasks", format)
    try:
        summary = _summary_of(path)
    except OSError as error:
        fail(EXIT_USE, f"cannot read {str(path)!r}: {error.strerror or error}", format)
    except ValueError as error:
        fail(EXIT_USE, f"{str(path)!r} is no results file: {error}", format)
    if format is Format.json:
        put_json(summary.to_dict())
    _show(summary, plot, format)


def _show(summary: Summary, plot: Path | None, format: Format) -> None:
    """The table and the plot."""
    from irc.batches.cactus import cactus_svg, cactus_text

    rows = summary.rows
    if format is Format.text:
        put(str(summary))
        drawn = cactus_text(rows)
        if drawn:
            put(f"\n{drawn}")
    if plot is not None:
        from irc.driver.files import write_whole

        write_whole(plot, cactus_svg(rows))


@contextmanager
def _quiet_cluster() -> Iterator[None]:
    """Without the log of the cluster's connections: what matters of it is reported."""
    import logging

    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(before)


@contextmanager
def _progress_shown(batch: Batch) -> Iterator[Callable[[], None]]:
    """A bar on standard error, if that is a terminal; the function is called for each result."""
    if not sys.stderr.isatty():
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn

    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        bar = progress.add_task("batch", total=None)

        def advance() -> None:
            total = batch.total if batch.all_read else None
            progress.update(bar, completed=batch.kept + batch.done, total=total)

        yield advance
