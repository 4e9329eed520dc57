"""The PDDL Formalizer's JSON: a domain, a problem and, in some answers, the action of each step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.frontends.importers.json_answer import find_object
from irc.methods.answer import Answer, AnswerState
from irc.methods.written_answer import unreadable, unreadable_state


@dataclass(frozen=True)
class PddlAnswer:
    """The texts of an answer; `step_actions[k]` is the name of the action of step k + 1."""

    state: AnswerState
    domain: str | None = None
    problem: str | None = None
    step_actions: tuple[str, ...] | None = None


def read_pddl_answer(text: str) -> PddlAnswer:
    """The first response of the answer's JSON, or the object itself."""
    content = find_object(text)
    if content is None:
        return PddlAnswer(unreadable_state(text))
    response = _first_response(content)
    domain, problem = _text(response, "domain"), _text(response, "problem")
    steps = response.get("step_actions")
    named = tuple(map(str, steps)) if isinstance(steps, list) else None
    state = AnswerState.OK if domain and problem else AnswerState.INVALID
    return PddlAnswer(state, domain, problem, named)


EXPECTED = '{"domain": "(define (domain …", "problem": "(define (problem …"}'


def read_pddl_task(text: str) -> Answer:
    """The task of the domain and problem that a model wrote, with what the importer finds.

    Habits that PDDL does not allow are read, each with a warning.
    """
    if find_object(text) is None:
        return unreadable(text, EXPECTED)
    written = read_pddl_answer(text)
    if written.domain is None or written.problem is None:
        missing = "domain" if written.domain is None else "problem"
        findings = Findings()
        message = f"the answer has no '{missing}', a text in PDDL"
        findings.add(Code.MISSING_FIELD, message, offset=0, hint=f"expected {EXPECTED}")
        report = Report(tuple(findings.items), Source("answer", text))
        return Answer(AnswerState.INVALID, text, report=report)
    from irc.frontends.importers.pddl import read_pddl
    from irc.model.canonical import written_task

    sources = (written.domain, "domain"), (written.problem, "problem")
    try:
        task, warnings = read_pddl(*sources, lenient=True)
    except InputError as error:
        return Answer(AnswerState.INVALID, text, report=error.report)
    return Answer(AnswerState.OK, text, document=written_task(task), report=warnings)


def _first_response(content: dict[str, Any]) -> dict[str, Any]:
    responses = content.get("responses")
    if isinstance(responses, list) and responses and isinstance(responses[0], dict):
        return responses[0]
    return content


def _text(response: dict[str, Any], kind: str) -> str | None:
    value = response.get(f"{kind}_pddl", response.get(kind))
    return value if isinstance(value, str) else None
