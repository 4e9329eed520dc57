"""The Planner's JSON: actions, dependencies, and the makespan that the model states."""

from __future__ import annotations

import re

from irc.diagnostics import Findings
from irc.methods.answer import Answer, Duration
from irc.methods.json_answer import find_object, unreadable
from irc.methods.written_graph import check_names, graph_answer, number, precedence, read_graph

EXPECTED = (
    '{"actions": [{"id", "duration"}], "dependencies": [{"before", "after"}], '
    '"final_answer_seconds": N}'
)

_NUMBER = re.compile(r"\d+(?:\.\d+)?")


def read_planner(text: str) -> Answer:
    """The step graph that the model wrote, and the makespan that it states."""
    content = find_object(text)
    if content is None:
        return unreadable(text, EXPECTED)
    findings = Findings()
    graph = read_graph(content, ("dependencies", "precedence"), findings)
    check_names(graph, "dependencies", findings)
    document = {
        "irc": "1",
        "actions": [{"id": a.id, "duration": a.duration} for a in graph.actions],
        "precedence": precedence(graph),
    }
    stated = _stated(content.get("final_answer_seconds"))
    return graph_answer(text, graph, document, findings, stated)


def _stated(value: object) -> Duration | None:
    """The stated makespan, also where the number stands in quotes."""
    if isinstance(value, str) and _NUMBER.fullmatch(value.strip()):
        return float(value)
    return number(value)
