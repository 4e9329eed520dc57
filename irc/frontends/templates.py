"""A first task to begin with: in the DSL, in JSON, or as tables."""

from __future__ import annotations

from pathlib import Path

from irc.driver.files import write_folder, write_whole
from irc.errors import IrcError
from irc.frontends.formats import DSL_SUFFIX
from irc.outcome import MISUSED

FIRST_TASK = """\
# A first task. `irc check FILE` looks for faults, `irc solve FILE` plans it.
# The language is described in docs/dsl.md.

task "first plan"
unit min                            # what a number without a unit counts

resource saw                        # one thing that can be used by one action at a time
resource Ana, Bo
pool people = Ana, Bo               # either of them will do

cut     30      on saw by people    # an action, its duration, and what it needs
glue    45      by people after cut
dry     2 h     after glue
paint   1 h     by Bo after dry
varnish 20 min  by Ana after paint + 15 min .. 1 h    # at least 15 min later, at most 1 h

minimize makespan
"""


class AlreadyThere(IrcError):
    """A file or folder that would be overwritten."""

    ends_as = MISUSED


def write_template(output: Path) -> list[Path]:
    """Writes a first task in the format that the suffix names; without one, a folder of CSV files.

    Returns the written files. Raises `AlreadyThere`, `WriteError`, or `LibraryMissing` for a
    workbook without openpyxl.
    """
    if output.exists():
        raise AlreadyThere(f"{str(output)!r} is already there; choose another name")
    suffix = output.suffix.lower()
    if suffix == ".xlsx":
        from irc.frontends.tables.files import workbook_bytes
        from irc.frontends.tables.writer import template_sheets

        write_whole(output, workbook_bytes(template_sheets()))
    elif not suffix:
        from irc.frontends.tables.files import csv_text
        from irc.frontends.tables.writer import template_sheets

        files = {f"{sheet.name}.csv": csv_text(sheet) for sheet in template_sheets()}
        write_folder(output, files)
        return [output / name for name in files]
    elif suffix == DSL_SUFFIX:
        write_whole(output, FIRST_TASK)
    else:
        from irc.frontends.convert import written_as
        from irc.frontends.files import parse_task

        write_whole(output, written_as(output, parse_task(FIRST_TASK, "first.irc").task))
    return [output]
