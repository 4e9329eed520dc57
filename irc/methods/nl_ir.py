"""NL IR: a task that a model wrote in the IR itself; `dependencies` means `precedence`."""

from __future__ import annotations

from irc.checks import run_checks
from irc.diagnostics import Findings, Report
from irc.frontends.importers.json_answer import placed_object
from irc.frontends.importers.step_graph import read_graph
from irc.frontends.json.document import json_source
from irc.frontends.partial import further_findings
from irc.methods.answer import Answer
from irc.methods.written_answer import graph_answer, unreadable
from irc.model.from_document import to_task
from irc.model.nulls import without_nulls

EXPECTED = 'a task of the IR: {"actions": […], "precedence": […]}'


def read_nl_ir(text: str) -> Answer:
    """The task that the model wrote, with everything that `irc check` finds in it."""
    found = placed_object(text)
    if found is None:
        return unreadable(text, EXPECTED)
    content, start = found
    document = {"irc": "1", **without_nulls(content)}
    if "dependencies" in document and "precedence" not in document:
        document["precedence"] = document.pop("dependencies")
    findings = Findings()
    task = to_task(document, findings)
    if task is None:
        findings.items += further_findings(document, findings)
    else:
        findings.items += run_checks(task, lint=False).report
    graph = read_graph(document, ("precedence",), Findings())
    report = Report(tuple(findings.items), json_source("answer", text, start))
    return graph_answer(text, graph, document, report)
