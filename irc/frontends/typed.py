"""The task of a document in the form of the IR's JSON, or everything that is wrong with it."""

from __future__ import annotations

from typing import NamedTuple

from irc.diagnostics import Findings, Report
from irc.frontends.json.document import RawDocument
from irc.frontends.mistaken import mistaken_for_task
from irc.model import Task
from irc.model.from_document import to_task


class Typed(NamedTuple):
    """A task with its source, None where its document has faults, and all findings about it."""

    task: Task | None
    report: Report


def typed(document: RawDocument) -> Typed:
    """The task of a document. With faults of shape, the report has those of the rest, too.

    Of a document of another kind it says only what it is.
    """
    findings = Findings(list(document.notes.items))
    task = to_task(document.content, findings)
    if task is None and (mistaken := mistaken_for_task(document.content)) is not None:
        return Typed(None, Report((mistaken,), document.source))
    if task is not None and not document.notes.has_errors:
        report = Report(tuple(findings.items), document.source)
        return Typed(task.with_source(document.source), report)
    from irc.frontends.partial import further_findings

    findings.items += further_findings(document.content, findings)
    return Typed(None, Report(tuple(findings.items), document.source))
