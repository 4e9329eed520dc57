"""Reads tasks in any language from files, standard input or text."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Source
from irc.frontends.formats import IMPORTERS, MS_PROJECT, TABLES, format_of, load_importer
from irc.frontends.json.document import RawDocument, read_document
from irc.frontends.language import language_of
from irc.frontends.mistaken import half_of_pddl
from irc.frontends.texts import STANDARD_INPUT, read_text
from irc.frontends.typed import typed
from irc.model import Task

_HEAD = 10_000
"""The characters at the beginning of a text in which PDDL is recognised."""

COLUMNS_FROM = 1_000_000
"""Characters: a shorter text is read quickly enough without columns."""


class Reading(NamedTuple):
    """A task that was read, with the notes on its text."""

    task: Task
    notes: tuple[Diagnostic, ...]


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
    if len(text) >= COLUMNS_FROM:
        from irc.frontends.json.columns import read_columns

        if (task := read_columns(text, name)) is not None:
            return Reading(task, ())
    return _typed(read_document(text, name, mend=True))


def _typed(document: RawDocument) -> Reading:
    task, report = typed(document)
    if task is None:
        raise InputError(report)
    return Reading(task, report.diagnostics)


def read_task(path: str | Path, problem: str | None = None) -> Reading:
    """The task of a file in the format that its suffix names. Raises `InputError`.

    With a `problem` file it is the task of a PDDL domain.
    """
    format = format_of(path)
    if format == TABLES:
        from irc.frontends.tables.reader import read_tables

        return Reading(read_tables(str(path)), ())
    text, name = read_text(path)
    if format == MS_PROJECT:
        from irc.frontends.ms_project.reader import read_ms_project

        return _noted(*read_ms_project(text, name))
    if format in IMPORTERS:
        return Reading(_only_one(format, text, name), ())
    if problem is not None:
        from irc.frontends.importers.pddl import read_pddl

        return _noted(*read_pddl((text, name), read_text(problem)))
    if "(" in text[:_HEAD] and (half := half_of_pddl(text[:_HEAD])) is not None:
        raise InputError(Report((half,), Source(name, text)))
    return parse_task(text, name, None if str(path) == STANDARD_INPUT else Path(path))


def _noted(task: Task, report: Report) -> Reading:
    return Reading(task, tuple(replace(d, within=report.source) for d in report.located()))


def _only_one(format: str, text: str, name: str) -> Task:
    """The task of a file with one instance. Raises `InputError` where it has more."""
    tasks = [task for _, task in load_importer(format)(text, name)]
    if len(tasks) == 1:
        return tasks[0]
    message = f"{name} holds {len(tasks)} instances"
    hint = f"irc convert --from {format} writes each of them into a file"
    raise InputError(Report((Diagnostic(Code.NOT_AN_IMPORT, message, hint=hint),)))
