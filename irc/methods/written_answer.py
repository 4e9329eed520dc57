"""Answers of which a reader takes a graph of steps, or nothing: their states and reports."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.frontends.importers.step_graph import Duration, StepGraph
from irc.methods.answer import Answer, AnswerState


def unreadable_state(text: str) -> AnswerState:
    """Why no object can be read: the text is empty, cut off, or malformed."""
    trimmed = text.rstrip()
    if not trimmed:
        return AnswerState.EMPTY
    whole = trimmed.endswith(("}", "```"))
    return AnswerState.MALFORMED if whole else AnswerState.TRUNCATED


REASONS = {
    AnswerState.EMPTY: "the answer is empty",
    AnswerState.TRUNCATED: "the answer is cut off: it ends before its JSON object does",
    AnswerState.MALFORMED: "the answer holds no JSON object that can be read",
}
"""The first message of an answer in which no object can be read."""


def unreadable(text: str, expected: str) -> Answer:
    """The answer in which no object can be read, with every fault of its text."""
    state = unreadable_state(text)
    return Answer(state, text, report=unreadable_report(text, state, expected))


def unreadable_report(text: str, state: AnswerState, expected: str) -> Report:
    """The report of an answer in which no object can be read."""
    findings = Findings()
    code = Code.UNREADABLE if state is AnswerState.EMPTY else Code.SYNTAX
    findings.add(code, REASONS[state], offset=len(text.rstrip()), hint=f"expected {expected}")
    if "{" in text:
        findings.items += _faults_of_text(text)
    return Report(tuple(findings.items), Source("answer", text))


def _faults_of_text(text: str) -> list[Any]:
    from irc.frontends.json.document import read_document

    try:
        read_document(text, "answer")
    except InputError as error:
        return [d for d in error.report if d.offset is not None]
    return []


def graph_answer(
    text: str,
    graph: StepGraph,
    document: Mapping[str, Any],
    report: Report,
    stated_makespan: Duration | None = None,
) -> Answer:
    """The answer with this graph: ok, or invalid where there are errors."""
    if not report.ok:
        return Answer(
            AnswerState.INVALID, text, graph, stated_makespan=stated_makespan, report=report
        )
    return Answer(AnswerState.OK, text, graph, document, stated_makespan, report=report)


def checked(answer: Answer) -> Answer:
    """The answer, invalid where `irc check` finds an error in the task that it holds."""
    from irc.checks import run_checks
    from irc.model.from_document import to_task

    if answer.state is not AnswerState.OK or answer.document is None:
        return answer
    findings = Findings()
    task = to_task(answer.document, findings)
    if task is not None:
        findings.items += run_checks(task, lint=False).report
    if not findings.has_errors:
        return answer
    report = answer.report + findings.items
    return replace(answer, state=AnswerState.INVALID, document=None, report=report)
