"""The CP-SAT Formalizer's scheduling JSON as a task of the IR.

`mode: "optimize"` names goals with rewards and no actions; the kitchen of the instance must then
supply the actions, and the answer is marked `actions_from_gold`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from irc.diagnostics import Report
from irc.frontends.importers.json_answer import placed_object
from irc.frontends.importers.schedule_spec import EXPECTED, check_goals, read_spec
from irc.frontends.json.document import json_source
from irc.methods.answer import Answer, AnswerState
from irc.methods.written_answer import graph_answer, unreadable


def read_schedule_spec(
    text: str, stations: Mapping[str, int] | None = None, robots: Sequence[str] = ()
) -> Answer:
    """The task that a scheduling JSON describes.

    `stations` are the capacities of the instance; without them each station has capacity 1.
    `robots` are those of the instance: an action with an empty `eligible_robots` takes any.
    """
    found = placed_object(text)
    if found is None:
        return unreadable(text, EXPECTED)
    content, start = found
    source = json_source("answer", text, start)
    if content.get("mode") == "optimize":
        faults = check_goals(content)
        state = AnswerState.INVALID if faults.items else AnswerState.OK
        report = Report(tuple(faults.items), source)
        return Answer(state, text, report=report, actions_from_gold=True)
    graph, document, findings = read_spec(content, stations, robots)
    return graph_answer(text, graph, document, Report(tuple(findings.items), source))
