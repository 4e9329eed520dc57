"""Reads tasks in any language from files, standard input or text."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.frontends.json.document import MAX_BYTES, RawDocument, decode_bytes, read_document
from irc.frontends.language import language_of
from irc.model import Task
from irc.model.from_document import to_task

STANDARD_INPUT = "-"


class Reading(NamedTuple):
    """A task that was read, with the notes on its text."""

    task: Task
    notes: tuple[Diagnostic, ...]


def read_bytes(path: str | Path) -> tuple[bytes, str]:
    """The bytes of a file ("-": standard input) and its name. Raises `InputError`."""
    if not isinstance(path, (str, Path)):
        raise TypeError(f"expected a path, not {type(path).__name__}")
    if str(path) == STANDARD_INPUT:
        return sys.stdin.buffer.read(MAX_BYTES + 1), "<stdin>"
    try:
        with open(path, "rb") as file:
            return file.read(MAX_BYTES + 1), str(path)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        message = f"cannot read {str(path)!r}: {getattr(error, 'strerror', None) or error}"
        raise InputError(Report((Diagnostic(Code.UNREADABLE, message),))) from None


def read_text(path: str | Path) -> tuple[str, str]:
    """The text of a file and its name. Raises `InputError`."""
    data, name = read_bytes(path)
    return decode_bytes(data, name), name


def parse_task(text: str, name: str = "<text>", path: Path | None = None) -> Reading:
    """The task of a text: JSON (or a language model's answer around it), the DSL, or English.

    `path` is the file of the text, if it has one; included DSL files are relative to it. Raises
    `InputError` with every fault of syntax; with faults of shape, also with the findings of the
    checks in the rest of the document.
    """
    language = language_of(text, name)
    if language == "dsl":
        from irc.frontends.dsl.task import parse_dsl

        return Reading(*parse_dsl(text, name, path))
    if language == "english":
        from irc.frontends.english.reader import read_english

        return _typed(read_english(text, name))
    return _typed(read_document(text, name, mend=True))


def _typed(document: RawDocument) -> Reading:
    findings = Findings(list(document.notes.items))
    task = to_task(document.content, findings)
    if task is None or document.notes.has_errors:
        from irc.frontends.partial import further_findings

        findings.items += further_findings(document.content, findings)
        raise InputError(Report(tuple(findings.items), document.source))
    return Reading(task.with_source(document.source), tuple(findings.items))


def read_task(path: str | Path, problem: str | None = None) -> Reading:
    """The task of a file; with a `problem` file, of a PDDL domain. Raises `InputError`."""
    text, name = read_text(path)
    if problem is not None:
        from irc.frontends.importers.pddl import read_pddl

        task, report = read_pddl((text, name), read_text(problem))
        return Reading(task, tuple(replace(d, within=report.source) for d in report.located()))
    return parse_task(text, name, None if str(path) == STANDARD_INPUT else Path(path))
