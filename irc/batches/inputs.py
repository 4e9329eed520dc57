"""The tasks of a batch: files, folders, patterns and JSON lines, read one after the other.

Nothing is held but the names: a text is read when its turn comes. A file that cannot be read is a
task too, with what is wrong.
"""

from __future__ import annotations

import glob
import gzip
import hashlib
import json
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path
from typing import Any

from irc.batches.trial import BatchTask, TaskText
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.errors import IrcError, OptionError
from irc.frontends.files import parse_task, read_task
from irc.frontends.formats import (
    IMPORTERS,
    KNOWN_SUFFIXES,
    PDDL,
    PLANNER,
    SCHEDULE_SPEC,
    SUFFIXES,
    TABLES,
    format_of,
    load_importer,
)
from irc.frontends.json.document import MAX_BYTES, decode_bytes
from irc.frontends.texts import STANDARD_INPUT, read_text
from irc.model import Task
from irc.model.built import Built
from irc.model.canonical import written_task
from irc.schedule import dump_json
from irc.targets import UnknownTarget

IRC = "irc"
FORMATS = (IRC, *IMPORTERS, PLANNER, SCHEDULE_SPEC, PDDL)
"""The formats of tasks; the other formats of `irc convert` are plans."""

LINES = (".jsonl", ".ndjson", ".jsonl.gz", ".ndjson.gz")
"""The suffixes of files with a document on each line."""

_SUFFIXES: Mapping[str, tuple[str, ...]] = {
    **{format: (*suffixes, *LINES) for format, suffixes in SUFFIXES.items()},
    IRC: (".json", ".irc", ".txt", *({*KNOWN_SUFFIXES} - {".csv"}), *LINES),
    PDDL: (".pddl",),
    PLANNER: (".json", ".txt", *LINES),
    SCHEDULE_SPEC: (".json", ".txt", *LINES),
}
_OTHERWISE = (".json", *LINES)
"""The suffixes of the files that are read of a folder."""

_INCLUDE = re.compile(r"^[ \t]*include\b", re.MULTILINE)

AnyInput = Task | Built[Task] | Mapping[str, Any] | str | Path
"""A task in code, a document, or the name of a file, folder or pattern."""


@dataclass(frozen=True, slots=True)
class InputOptions:
    """How inputs are read: their format, and the domain of PDDL problems.

    Without `domain` the one of a problem is `domain.pddl` in its folder.
    """

    format: str = IRC
    domain: str | None = None

    def __post_init__(self) -> None:
        if self.format not in FORMATS:
            raise UnknownTarget("input format", self.format, list(FORMATS))
        if self.domain is not None and self.format != PDDL:
            raise OptionError(f"--domain is for --from {PDDL}")


def listed(inputs: Iterable[AnyInput], options: InputOptions) -> list[Any]:
    """The inputs with folders and patterns replaced by the files in them, each file once.

    Raises `InputError` where a folder or a pattern has no file.
    """
    found: dict[object, Any] = {}
    for k, one in enumerate(inputs):
        if isinstance(one, (str, Path)):
            found.update((name, name) for name in _expanded(str(one), options))
        else:
            found[k] = one
    return list(found.values())


def _expanded(name: str, options: InputOptions) -> list[str]:
    path = Path(name)
    if name == STANDARD_INPUT or path.is_file():
        return [name]
    if path.is_dir():
        suffixes = _SUFFIXES.get(options.format, _OTHERWISE)
        inside = sorted(str(file) for file in path.iterdir() if file.name.endswith(suffixes))
        found = [file for file in inside if Path(file).is_file()]
        return _problems(found, options) or _nothing(f"the folder {name!r} has no task files")
    if glob.has_magic(name):
        found = sorted(file for file in glob.iglob(name, recursive=True) if Path(file).is_file())
        return _problems(found, options) or _nothing(f"no file is called {name!r}")
    return [name]  # (It cannot be read, which is the result of this task.)


def _problems(files: list[str], options: InputOptions) -> list[str]:
    """The files without the domains among them."""
    if options.format != PDDL:
        return files
    domain = options.domain and Path(options.domain).resolve()
    return [f for f in files if Path(f).name != "domain.pddl" and Path(f).resolve() != domain]


def _nothing(message: str) -> list[str]:
    hint = "name files, a folder that has some, or a pattern such as 'tasks/**/*.json'"
    raise InputError(Report((Diagnostic(Code.UNREADABLE, message, hint=hint),)))


def tasks_of(files: Iterable[AnyInput], options: InputOptions) -> Iterator[BatchTask]:
    """The tasks of the files of `listed`, each with a name of its own."""
    taken: set[str] = set()
    for one in files:
        for task in _tasks(one, options):
            name = task.name
            for k in range(2, sys.maxsize):
                if name not in taken:
                    break
                name = f"{task.name} ({k})"
            taken.add(name)
            yield task if name == task.name else replace(task, name=name)


def _tasks(one: AnyInput, options: InputOptions) -> Iterator[BatchTask]:
    if not isinstance(one, (str, Path)):
        yield _in_code(one)
        return
    name = str(one)
    try:
        if name == STANDARD_INPUT or name.endswith(LINES):
            yield from _lines(name, options)
        elif options.format == PDDL:
            yield _pddl(name, options.domain)
        elif options.format == IRC and format_of(name) == TABLES:
            yield _imported(name, read_task(name).task)
        else:
            source = format_of(name) if options.format == IRC else options.format
            yield from _in_text(*read_text(name), Path(name), source)
    except InputError as error:
        yield faulty(name, error.report)
    except IrcError as error:  # such as an extra that a format needs
        yield faulty(name, _report(str(error)))
    except Exception as error:  # noqa: BLE001 - one file must not stop the others
        yield faulty(name, _report(f"reading it broke down: {type(error).__name__}: {error}"))


def _report(message: str) -> Report:
    return Report((Diagnostic(Code.UNREADABLE, message),))


def _in_code(one: Task | Built[Task] | Mapping[str, Any]) -> BatchTask:
    document = one if isinstance(one, Mapping) else written_task(_immutable(one))
    name = document.get("name")
    shown = name if isinstance(name, str) and name else "task"
    try:
        text = dump_json(document)
    except (TypeError, ValueError, RecursionError) as error:
        message = f"the document cannot be written as JSON: {error}"
        return faulty(shown, Report((Diagnostic(Code.SYNTAX, message),)))
    return _text(shown, TaskText(IRC, text, shown))


def _immutable(task: Task | Built[Task]) -> Task:
    return task if isinstance(task, Task) else task.ir


def _text(name: str, source: TaskText) -> BatchTask:
    digest = hashlib.sha256(f"{source.format}\n{source.text}".encode("utf-8", "surrogatepass"))
    if source.problem is not None:
        digest.update(source.problem[0].encode("utf-8", "surrogatepass"))
    return BatchTask(name, digest.hexdigest(), source)


def faulty(name: str, report: Report) -> BatchTask:
    """A task that cannot be read; the digest is that of what is wrong."""
    text = "\n".join(diagnostic.message for diagnostic in report)
    digest = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()
    return BatchTask(name, digest, report)


def _in_text(
    text: str, name: str, path: Path | None, source: str, called: str | None = None
) -> Iterator[BatchTask]:
    """The task of a text, or those of its instances; they are `called` after the file or line."""
    called = called or name
    if source in IMPORTERS:
        yield from _instances(text, name, source, called)
    elif source == IRC and path is not None and _includes(text, name):
        # (An include is relative to the file, which another machine may not have.)
        task = parse_task(text, name, path).task
        yield _text(called, TaskText(IRC, dump_json(written_task(task)), f"{name}.json"))
    else:
        yield _text(called, TaskText(source, text, name))


def _includes(text: str, name: str) -> bool:
    return name.endswith(".irc") and _INCLUDE.search(text) is not None


def _instances(text: str, name: str, source: str, called: str) -> Iterator[BatchTask]:
    """The instances of a benchmark's file; a faulty one leaves the others readable."""
    importer = load_importer(source)
    position = 0
    try:
        for stem, task in importer(text, name):
            position += 1
            yield _imported(f"{called}#{stem}", task)
    except InputError as error:
        rest = _separate(text, name)[position:]
        if len(rest) + position < 2:
            raise
        for k, instance in enumerate(rest, position + 1):
            try:
                for stem, task in importer(instance, name):
                    yield _imported(f"{called}#{stem}", task)
            except InputError as fault:
                yield faulty(f"{called}#{k}", error.report if k == position + 1 else fault.report)


def _imported(name: str, task: Task) -> BatchTask:
    return _text(name, TaskText(IRC, dump_json(written_task(task)), name))


def _separate(text: str, name: str) -> list[str]:
    """Each instance of a file as a text of its own."""
    from irc.frontends.importers.instances import read_json

    content, _ = read_json(text, name)
    instances = content if isinstance(content, list) else [content]
    return [json.dumps(instance, default=_number) for instance in instances]


def _number(value: object) -> float:
    if isinstance(value, Decimal):
        return float(value)
    raise TypeError(f"{type(value).__name__} is not JSON")


def _lines(name: str, options: InputOptions) -> Iterator[BatchTask]:
    """The tasks of a file with a document on each line."""
    if options.format == PDDL:
        raise OptionError(f"--from {PDDL} reads problem files, not lines")
    try:
        for number, line in enumerate(_open_lines(name), 1):
            if line.strip():
                yield from _line(line, f"{_shown(name)}:{number}", options)
    except (OSError, EOFError, ValueError) as error:
        message = f"cannot read {name!r}: {getattr(error, 'strerror', None) or error}"
        raise InputError(_report(message)) from None


def _shown(name: str) -> str:
    return "<stdin>" if name == STANDARD_INPUT else name


def _open_lines(name: str) -> Iterator[bytes]:
    if name == STANDARD_INPUT:
        yield from _limited(sys.stdin.buffer)
        return
    with gzip.open(name) if name.endswith(".gz") else open(name, "rb") as file:
        yield from _limited(file)


def _limited(file: Any) -> Iterator[bytes]:
    while line := file.readline(MAX_BYTES + 1):
        yield line


def _line(line: bytes, called: str, options: InputOptions) -> Iterator[BatchTask]:
    try:
        # (A line is JSON, whatever the suffix of its file says.)
        text = decode_bytes(line, called)
        yield from _in_text(text, f"{called}.json", None, options.format, called)
    except InputError as error:
        yield faulty(called, error.report)


def _pddl(name: str, domain: str | None) -> BatchTask:
    beside = domain or str(Path(name).with_name("domain.pddl"))
    text, domain_name = read_text(beside)
    return _text(name, TaskText(PDDL, text, domain_name, read_text(name)))
