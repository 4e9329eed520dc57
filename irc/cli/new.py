"""`irc new`: a first task to begin with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irc.cli.options import FormatOption
from irc.cli.output import Format, put_json, reporting_errors, say


def new(
    output: Annotated[
        Path,
        typer.Argument(
            help="The file to write: .irc, .json or .xlsx; without a suffix, a folder of CSV files."
        ),
    ],
    format: FormatOption = Format.text,
) -> None:
    """Write a first task to begin with: with comments in the DSL, or as a template of tables."""
    from irc.frontends.templates import write_template

    with reporting_errors(format):
        written = write_template(output)
        if format is Format.json:
            put_json({"written": [str(path) for path in written]})
        else:
            say(f"wrote {output}; `irc solve` plans it" if output.suffix else f"wrote {output}")
