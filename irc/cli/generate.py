"""`irc generate`: new instances of the benchmark families, with gold answers and English texts."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irc.cli.options import FormatOption, SeedOption
from irc.cli.output import Format, put_json, reporting_errors, say

FamilyArgument = Annotated[
    str, typer.Argument(metavar="FAMILY", help="asyncplan, robo or robo-online.")
]
FolderOption = Annotated[Path, typer.Option("-o", "--output", help="The folder to write.")]
SizesOption = Annotated[
    list[int] | None,
    typer.Option("--size", "-n", help="Steps, or items of a kitchen; several times."),
]
AxesOption = Annotated[
    list[str] | None,
    typer.Option("--axis", help="easy, medium, high-speedup, …; several times (default: all)."),
]
CountOption = Annotated[
    int, typer.Option("--count", "-c", min=1, help="Instances of each size and axis.")
]
GoldLimitOption = Annotated[
    float, typer.Option(min=0.01, max=1e9, help="Seconds for the proof of each gold answer.")
]


def generate(
    family: FamilyArgument,
    output: FolderOption,
    sizes: SizesOption = None,
    axes: AxesOption = None,
    count: CountOption = 10,
    seed: SeedOption = 0,
    time_limit: GoldLimitOption = 60.0,
    format: FormatOption = Format.text,
) -> None:
    """Write new instances of a benchmark family: its own format, IR, English and gold answers."""
    from irc.cli.interruption import INTERRUPTION
    from irc.driver.files import require_folder, write_folder
    from irc.generators.families import Request, files_of, generated

    with reporting_errors(format), INTERRUPTION.planning() as cancel:
        require_folder(output)
        asked = Request(
            family, tuple(sizes or ()), tuple(axes or ()), count, seed, time_limit, cancel
        )
        written = []
        for name, text in files_of(generated(asked)):
            path = output / name
            write_folder(path.parent, {path.name: text})
            written.append(name)
        instances = sum(name.startswith("ir/") for name in written)
        if format is Format.json:
            put_json({"folder": str(output), "instances": instances, "files": written})
        else:
            say(f"wrote {instances:,} instances to {output}")
