"""Arguments and options that several commands take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irc.cli.output import Format

FileArgument = Annotated[
    str, typer.Argument(help="A task: JSON, the DSL, or English; '-' is standard input.")
]
FormatOption = Annotated[Format, typer.Option("--format", help="The format of the output.")]
OutOption = Annotated[
    Path | None, typer.Option("-o", "--output", help="The file or folder to write.")
]

TargetOption = Annotated[str, typer.Option("--target", "-t", help="cpsat, pddl21, …")]
EngineOption = Annotated[str, typer.Option("--engine", "-e", help="An engine of the target.")]
TimeLimitOption = Annotated[
    float, typer.Option(min=0.01, max=1e9, help="Wall-clock seconds, all engines together.")
]
MemoryLimitOption = Annotated[
    int | None, typer.Option(min=16, max=2**30, help="Memory limit of the engine in MB.")
]
SeedOption = Annotated[
    int, typer.Option(min=0, max=2**31 - 1, help="Random seed, for engines that have one.")
]
WorkersOption = Annotated[
    int | None, typer.Option(min=1, max=10_000, help="Threads of the engine.")
]

StepTimeLimitOption = Annotated[
    float, typer.Option(min=0.01, max=1e9, help="Wall-clock seconds for each step.")
]
StabilityOption = Annotated[
    float,
    typer.Option(
        min=0.0,
        max=1e6,
        metavar="PERCENT",
        help="How much worse the last objective may get so that fewer occurrences move.",
    ),
]
