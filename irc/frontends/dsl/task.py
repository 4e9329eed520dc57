"""A text of the DSL → the typed task, or everything that is wrong with it in one run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.frontends.dsl.reader import DslReading, read_dsl
from irc.frontends.partial import further_findings
from irc.model import Task
from irc.model.from_document import to_task


@dataclass(frozen=True)
class DslTask:
    """The task of a text (None if it has faults of shape), and all findings so far.

    The findings are about text and shape; if there are any, also about the sound statements, from
    the checks. The report is not located yet.
    """

    reading: DslReading
    task: Task | None
    report: Report


def dsl_task(text: str, name: str = "<text>", path: Path | None = None) -> DslTask:
    """Reads a text as far as possible; `path` is its file, if it has one.

    Never raises for the contents of the text, so that an editor can show all findings.
    """
    folder = None if path is None else path.parent
    reading = read_dsl(text, name, folder, file=path)
    findings = Findings([*reading.notes, *reading.faults])
    task = to_task(reading.document, findings)
    if task is None:
        more = further_findings(reading.document, findings)
    elif reading.faults:
        from irc.checks import run_checks

        more = list(run_checks(task, lint=False, complete=False).report)
    else:
        more = []
    findings.items += [d for d in more if not _follows(d, reading)]
    if task is not None:
        task.with_source(reading.source)
    return DslTask(reading, task, Report(tuple(findings.items), reading.source))


def parse_dsl(text: str, name: str, path: Path | None) -> tuple[Task, tuple[Diagnostic, ...]]:
    """The task and the notes about its text. Raises `InputError` with every fault."""
    found = dsl_task(text, name, path)
    if found.task is None or not found.report.ok:
        raise InputError(found.report)
    return found.task, found.report.diagnostics


_DECLARING = ("for", "include")
"""Faulty statements of these kinds may have declared anything."""


def _follows(finding: Diagnostic, reading: DslReading) -> bool:
    """Whether a name may only be unknown because the statement that declares it is faulty."""
    if finding.code is not Code.UNKNOWN_NAME:
        return False
    name = _element_at(reading.document, finding.pointer)
    return any(
        broken.startswith(_DECLARING) or not isinstance(name, str) or name in broken
        for broken in reading.broken
    )


def _element_at(document: object, pointer: tuple[str | int, ...]) -> object:
    for part in pointer:
        try:
            document = document[part]  # type: ignore[index]
        except (KeyError, IndexError, TypeError):
            return None
    return document
