"""Arguments and options that several commands take."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Annotated

import typer

from irc.cli.output import Format

FileArgument = Annotated[
    str, typer.Argument(help="A task: JSON, the DSL, or English; '-' is standard input.")
]
FormatOption = Annotated[Format, typer.Option("--format", help="How to answer.")]
OutOption = Annotated[Path | None, typer.Option("-o", "--output", help="Where to write.")]

TargetOption = Annotated[str, typer.Option("--target", "-t", help="cpsat, pddl21, …")]
EngineOption = Annotated[str, typer.Option("--engine", "-e", help="One of the target's.")]
TimeLimitOption = Annotated[
    float, typer.Option(min=0.01, max=1e9, help="Wall-clock seconds, all engines together.")
]
MemoryLimitOption = Annotated[
    int | None, typer.Option(min=16, max=2**30, help="MB for the engine.")
]
SeedOption = Annotated[int, typer.Option(min=0, max=2**31 - 1, help="For engines that draw.")]
WorkersOption = Annotated[
    int | None, typer.Option(min=1, max=10_000, help="Threads of the engine.")
]

StepTimeLimitOption = Annotated[
    float, typer.Option(min=0.01, max=1e9, help="Wall-clock seconds for each planning.")
]


def _share(text: str | Fraction) -> Fraction:
    from irc.errors import OptionError
    from irc.targets import read_share

    try:
        return read_share(text)
    except OptionError as error:
        raise typer.BadParameter(str(error)) from None


StabilityOption = Annotated[
    Fraction,
    typer.Option(
        parser=_share,
        metavar="FRACTION",
        help="How much worse the objective may get so that less moves: 0.05 or 5%.",
    ),
]
