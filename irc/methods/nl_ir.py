"""NL IR: a task that a model wrote in the IR itself; `dependencies` means `precedence`."""

from __future__ import annotations

from irc.diagnostics import Findings
from irc.methods.answer import Answer
from irc.methods.json_answer import find_object, unreadable
from irc.methods.written_graph import check_names, graph_answer, read_graph

EXPECTED = 'a task of the IR: {"actions": […], "precedence": […]}'


def read_nl_ir(text: str) -> Answer:
    """The task that the model wrote."""
    content = find_object(text)
    if content is None:
        return unreadable(text, EXPECTED)
    findings = Findings()
    graph = read_graph(content, ("precedence", "dependencies"), findings)
    check_names(graph, "precedence", findings)
    document = {"irc": "1", **content}
    if "dependencies" in document:
        document["precedence"] = document.pop("dependencies")
    return graph_answer(text, graph, document, findings)
