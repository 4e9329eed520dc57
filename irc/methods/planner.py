"""The Planner's JSON: actions, dependencies, and the makespan that the model states."""

from __future__ import annotations

from irc.diagnostics import Findings
from irc.methods.answer import Answer
from irc.methods.json_answer import find_object, unreadable
from irc.methods.written_graph import check_names, graph_answer, number, precedence, read_graph

EXPECTED = (
    '{"actions": [{"id", "duration"}], "dependencies": [{"before", "after"}], '
    '"final_answer_seconds": N}'
)


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
    stated = number(content.get("final_answer_seconds"))
    return graph_answer(text, graph, document, findings, stated)
