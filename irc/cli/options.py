"""Arguments and options that several commands take."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Annotated

import typer

from irc.cli.output import Format
from irc.cli.times import TimesStyle

FileArgument = Annotated[
    str, typer.Argument(help="A task: JSON, the DSL, or English; '-' is standard input.")
]
ProblemOption = Annotated[
    str | None, typer.Option("--problem", help="The problem file; FILE is a PDDL domain then.")
]
FormatOption = Annotated[Format, typer.Option("--format", help="The format of the output.")]
OutOption = Annotated[
    Path | None, typer.Option("-o", "--output", help="The file or folder to write.")
]

FileOutOption = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        help="The file to write, by its ending: .json, .html, .svg, .png, .pdf, .xlsx, .csv, .ics, "
        ".md or .txt.",
    ),
]
TimesOption = Annotated[
    TimesStyle | None,
    typer.Option(
        "--times",
        help="clock: times as dates (where the task has an origin); unit: as numbers of its unit.",
    ),
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
SchedulerOption = Annotated[
    str | None, typer.Option("--scheduler", help="A Dask scheduler: tcp://HOST:8786.")
]
DeterministicOption = Annotated[
    bool,
    typer.Option("--deterministic", help="Count work instead of time: the same answer every time."),
]
WorkLimitOption = Annotated[
    float | None,
    typer.Option(
        min=0.001, max=1e6, help="With --deterministic, the units of work, of a few seconds each."
    ),
]

StepTimeLimitOption = Annotated[
    float, typer.Option(min=0.01, max=1e9, help="Wall-clock seconds for each step.")
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
        help="How much worse the last objective may get so that fewer move: 0.05 or 5%.",
    ),
]

PlanToWriteOption = Annotated[
    str | None,
    typer.Option("--schedule", help="Write this schedule of the task (ms-project, icalendar)."),
]
BaselineOption = Annotated[
    bool, typer.Option("--baseline", help="Keep the schedule as the baseline of ms-project.")
]
