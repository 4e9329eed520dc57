"""The Planner's answers: a JSON of steps with the makespan that the model states, or plan lines."""

from __future__ import annotations

from irc.diagnostics import Report
from irc.frontends.importers.json_answer import placed_object
from irc.frontends.importers.plan_lines import no_plan, read_plan
from irc.frontends.importers.planner import EXPECTED, read_planner_json, stated_makespan
from irc.frontends.json.document import json_source
from irc.methods.answer import Answer, AnswerState
from irc.methods.written_answer import graph_answer, unreadable


def read_planner(text: str) -> Answer:
    """The step graph that the model wrote, and the makespan that it states."""
    found = placed_object(text)
    if found is None:
        return unreadable(text, EXPECTED)
    content, start = found
    graph, document, findings = read_planner_json(content)
    report = Report(tuple(findings.items), json_source("answer", text, start))
    return graph_answer(text, graph, document, report, stated_makespan(content))


def read_plan_answer(text: str) -> Answer:
    """The plan that a model wrote as lines, as a schedule."""
    plan = read_plan(text)
    if plan:
        return Answer(AnswerState.OK, text, plan=plan)
    state = AnswerState.MALFORMED if text.strip() else AnswerState.EMPTY
    return Answer(state, text, report=no_plan(text, "answer"))
