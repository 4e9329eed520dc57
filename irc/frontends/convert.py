"""Conversion between formats: other people's tasks in, IR JSON or the DSL out."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from irc.backend import UnknownTarget
from irc.canonical import written_task
from irc.files import write_folder, write_whole
from irc.frontends.asyncplan import import_asyncplan
from irc.frontends.files import read_task, read_text
from irc.model import Task
from irc.schedule import dump_json

Importer = Callable[[str, str], Iterator[tuple[str, Task]]]

IMPORTERS: Mapping[str, Importer] = {"asyncplan": import_asyncplan}
"""Formats with many instances in a file: (text, name) → (file stem, task) of each."""

DSL_SUFFIX = ".irc"
"""What a file in the DSL is called; everything else is written as JSON."""

_UNSAFE = re.compile(r"[^\w.-]+")


def written_as(output: Path, task: Task) -> str:
    """The text of a task in the language that a file's suffix names."""
    if output.suffix.lower() == DSL_SUFFIX:
        from irc.frontends.dsl.printer import print_task

        return print_task(task)
    return dump_json(written_task(task))


def convert_file(file: str, source: str, output: Path) -> list[Path]:
    """Writes the task (or one task per instance) and returns the files written.

    A task is written in the DSL where `output` ends in `.irc`, else as JSON.

    Raises `InputError`, `WriteError`, or `UnknownTarget` for an unknown format.
    """
    if source == "irc":
        write_whole(output, written_as(output, read_task(file).task))
        return [output]
    if source not in IMPORTERS:
        raise UnknownTarget("input format", source, ["irc", *IMPORTERS])
    text, name = read_text(file)
    # All instances are read before the first file is written.
    files: dict[str, str] = {}
    for stem, task in IMPORTERS[source](text, name):
        safe = _UNSAFE.sub("_", stem)[:100]
        while f"{safe}.json" in files:
            safe += "_"
        files[f"{safe}.json"] = dump_json(written_task(task))
    write_folder(output, files)
    return [output / name for name in files]
