"""Analyses one state of a text: the findings of `irc check`, and the task that was read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from irc.checks import run_checks
from irc.diagnostics import InputError, Report
from irc.diagnostics.source import Source
from irc.frontends.language import Language, language_of
from irc.frontends.typed import typed
from irc.model import Task
from irc.problem import Problem

MOST_CHARACTERS = 8_000_000
"""Longer texts are not checked while they are typed."""


@dataclass(frozen=True)
class Analysis:
    """The located findings about a text, and the parts of it that could be read.

    `content` is the document in the form of the IR's JSON, whatever its language; it may have
    faults of shape. If it has none, there are `task` and `problem`. Offsets of `source` are those
    of the text without its byte-order mark, which is `lead` characters long.
    """

    language: Language
    report: Report
    content: Mapping[str, Any] | None = None
    source: Source | None = None
    task: Task | None = None
    problem: Problem | None = None
    lead: int = 0
    too_long: bool = False

    @cached_property
    def sound(self) -> Problem | None:
        """The lowered task, if no error was found in it."""
        return self.problem if self.report.ok else None


def analyse(text: str, name: str, path: Path | None) -> Analysis:
    """Reads and checks a text as `irc check` does. Never raises for its contents."""
    if len(text) > MOST_CHARACTERS:
        return Analysis("json", Report(), too_long=True)
    language = language_of(text, name)
    read = {"dsl": _dsl, "english": _english, "json": _json}[language]
    found = read(text, name, path)
    lead = len(text) - len(found.source.text) if found.source is not None else 0
    return Analysis(
        language,
        found.report.located(),
        found.content,
        found.source,
        found.task,
        found.problem,
        lead,
    )


def _dsl(text: str, name: str, path: Path | None) -> Analysis:
    from irc.frontends.dsl.task import dsl_task

    found = dsl_task(text, name, path)
    reading = found.reading
    if found.task is None or not found.report.ok:
        return Analysis("dsl", found.report, reading.document, reading.source, found.task)
    return _checked("dsl", found.task, found.report, reading.document, reading.source)


def _english(text: str, name: str, _path: Path | None) -> Analysis:
    from irc.frontends.english.reader import read_english

    return _raw("english", read_english, text, name)


def _json(text: str, name: str, _path: Path | None) -> Analysis:
    from irc.frontends.json.document import read_document

    return _raw("json", partial(read_document, mend=True), text, name)


def _raw(language: Language, read: Any, text: str, name: str) -> Analysis:
    try:
        document = read(text, name)
    except InputError as error:
        return Analysis(language, error.report, source=error.report.source)
    task, report = typed(document)
    if task is None:
        return Analysis(language, report, document.content, document.source)
    return _checked(language, task, report, document.content, document.source)


def _checked(
    language: Language, task: Task, earlier: Report, content: Mapping[str, Any], source: Source
) -> Analysis:
    checked = run_checks(task, earlier.diagnostics)
    return Analysis(language, checked.report, content, source, task, checked.problem)
