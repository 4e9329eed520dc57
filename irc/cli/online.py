"""The commands for running tasks. Their modules are imported when they run."""

from __future__ import annotations

from enum import StrEnum
from fractions import Fraction
from pathlib import Path
from typing import Annotated

import typer

from irc.cli.options import (
    EngineOption,
    FileArgument,
    FileOutOption,
    FormatOption,
    MemoryLimitOption,
    SeedOption,
    StabilityOption,
    StepTimeLimitOption,
    TargetOption,
    TimesOption,
    WorkersOption,
)
from irc.cli.output import Format


def replan(
    file: FileArgument,
    schedule: Annotated[
        str, typer.Option("--schedule", "-s", help="The schedule in force; '-' is standard input.")
    ],
    at: Annotated[
        str, typer.Option("--at", metavar="TIME", help='The present time: 12, "2 min", "1/3", …')
    ],
    event: Annotated[
        list[str] | None,
        typer.Option(
            "--event",
            metavar="EVENT",
            help="A file with one or more events, JSON or DSL ('-' is standard input), or #id for "
            "an event of the task. Repeat it for more. Without it: the task's events at TIME.",
        ),
    ] = None,
    target: TargetOption = "cpsat",
    engine: EngineOption = "auto",
    time_limit: StepTimeLimitOption = 60.0,
    memory_limit: MemoryLimitOption = None,
    seed: SeedOption = 0,
    workers: WorkersOption = None,
    stability: StabilityOption = Fraction(0),
    times: TimesOption = None,
    output: FileOutOption = None,
    task_output: Annotated[
        Path | None,
        typer.Option("--task-output", help="The file for the task as the events revise it."),
    ] = None,
    format: FormatOption = Format.text,
) -> None:
    """Plan the rest of a running schedule again, after events at a time."""
    from irc.cli.replan import replan_file
    from irc.targets import SolveOptions

    options = SolveOptions(
        target, engine, time_limit, memory_limit, workers, seed, stability=stability
    )
    replan_file(file, schedule, at, event or [], options, output, task_output, times, format)


def simulate(
    file: FileArgument,
    schedule: Annotated[
        str | None,
        typer.Option("--schedule", "-s", help="The schedule to begin with; without it, the best."),
    ] = None,
    target: TargetOption = "cpsat",
    engine: EngineOption = "auto",
    time_limit: StepTimeLimitOption = 60.0,
    memory_limit: MemoryLimitOption = None,
    seed: SeedOption = 0,
    workers: WorkersOption = None,
    stability: StabilityOption = Fraction(0),
    times: TimesOption = None,
    output: FileOutOption = None,
    steps: Annotated[
        Path | None, typer.Option("--steps", help="A folder for the document of each step.")
    ] = None,
    format: FormatOption = Format.text,
) -> None:
    """Run a task through all of its own events, planning again after each."""
    from irc.cli.simulate import simulate_file
    from irc.targets import SolveOptions

    options = SolveOptions(
        target, engine, time_limit, memory_limit, workers, seed, stability=stability
    )
    simulate_file(file, schedule, options, output, steps, times, format)


class PresumeName(StrEnum):
    """The facts of a running task for `irc run`: the plan, or only observations."""

    assume = "assume"
    confirm = "confirm"


def run(
    file: FileArgument,
    stdio: Annotated[
        bool,
        typer.Option(
            "--stdio", help="Read requests from standard input, answer on standard output."
        ),
    ] = False,
    schedule: Annotated[
        str | None,
        typer.Option("--schedule", "-s", help="The schedule to begin with; without it, the best."),
    ] = None,
    journal: Annotated[
        Path | None,
        typer.Option("--journal", "-j", help="The file for accepted requests, for a restart."),
    ] = None,
    presume: Annotated[
        PresumeName,
        typer.Option(
            "--presume",
            help="assume: the plan happens unless something else is observed; confirm: nothing "
            "begins or ends until it is observed.",
        ),
    ] = PresumeName.assume,
    board: Annotated[
        int | None,
        typer.Option(
            "--board",
            help="Show the run on this port in browsers on this machine; 0 takes a free port.",
            min=0,
            max=65535,
        ),
    ] = None,
    target: TargetOption = "cpsat",
    engine: EngineOption = "auto",
    time_limit: StepTimeLimitOption = 60.0,
    memory_limit: MemoryLimitOption = None,
    seed: SeedOption = 0,
    workers: WorkersOption = None,
    stability: StabilityOption = Fraction(0),
) -> None:
    """Serve a running task: read a JSON request on each line, print an answer on each line."""
    from irc.cli.run import run_file
    from irc.targets import SolveOptions

    options = SolveOptions(
        target, engine, time_limit, memory_limit, workers, seed, stability=stability
    )
    run_file(file, stdio, schedule, journal, options, presume.value, board)
