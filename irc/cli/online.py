"""The commands that follow a task while it runs. Their bodies are loaded when they run."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Annotated

import typer

from irc.cli.options import (
    EngineOption,
    FileArgument,
    FormatOption,
    MemoryLimitOption,
    OutOption,
    SeedOption,
    StabilityOption,
    StepTimeLimitOption,
    TargetOption,
    WorkersOption,
)
from irc.cli.output import Format


def replan(
    file: FileArgument,
    schedule: Annotated[
        str, typer.Option("--schedule", "-s", help="The schedule in force; '-': standard input.")
    ],
    at: Annotated[str, typer.Option("--at", metavar="TIME", help='When: 12, "2 min", "1/3", …')],
    event: Annotated[
        list[str] | None,
        typer.Option(
            "--event",
            metavar="EVENT",
            help="A file with an event or several, JSON or DSL ('-': standard input), or #id for "
            "one of the task's own; as often as needed. Without it: the task's own at that time.",
        ),
    ] = None,
    target: TargetOption = "cpsat",
    engine: EngineOption = "auto",
    time_limit: StepTimeLimitOption = 60.0,
    memory_limit: MemoryLimitOption = None,
    seed: SeedOption = 0,
    workers: WorkersOption = None,
    stability: StabilityOption = Fraction(0),
    output: OutOption = None,
    task_output: Annotated[
        Path | None,
        typer.Option("--task-output", help="Where to write the task as the events revise it."),
    ] = None,
    format: FormatOption = Format.text,
) -> None:
    """Plan the rest of a running schedule again, after what has happened at a time."""
    from irc.cli.planning import Planning
    from irc.cli.replan import replan_file

    planning = Planning(target, engine, time_limit, memory_limit, seed, workers, stability)
    replan_file(file, schedule, at, event or [], planning, output, task_output, format)


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
    output: OutOption = None,
    steps: Annotated[
        Path | None, typer.Option("--steps", help="A folder for the document of each step.")
    ] = None,
    format: FormatOption = Format.text,
) -> None:
    """Run a task through all of its own events, planning again after each."""
    from irc.cli.planning import Planning
    from irc.cli.simulate import simulate_file

    planning = Planning(target, engine, time_limit, memory_limit, seed, workers, stability)
    simulate_file(file, schedule, planning, output, steps, format)


def run(
    file: FileArgument,
    stdio: Annotated[
        bool, typer.Option("--stdio", help="Requests from standard input, answers to output.")
    ] = False,
    schedule: Annotated[
        str | None,
        typer.Option("--schedule", "-s", help="The schedule to begin with; without it, the best."),
    ] = None,
    journal: Annotated[
        Path | None,
        typer.Option("--journal", "-j", help="Where to keep what was accepted, for a restart."),
    ] = None,
    target: TargetOption = "cpsat",
    engine: EngineOption = "auto",
    time_limit: StepTimeLimitOption = 60.0,
    memory_limit: MemoryLimitOption = None,
    seed: SeedOption = 0,
    workers: WorkersOption = None,
    stability: StabilityOption = Fraction(0),
) -> None:
    """Hold a running task open: a JSON request on each line in, an answer on each line out."""
    from irc.cli.planning import Planning
    from irc.cli.run import run_file

    planning = Planning(target, engine, time_limit, memory_limit, seed, workers, stability)
    run_file(file, stdio, schedule, journal, planning)
