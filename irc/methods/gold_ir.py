"""Gold IR: the gold task itself, without a model; no formalizer can do better."""

from __future__ import annotations

from irc.diagnostics import Findings, Report
from irc.frontends.importers.step_graph import read_graph
from irc.methods.answer import Answer
from irc.methods.instance import GoldInstance, Instance
from irc.methods.written_answer import graph_answer


def read_gold_ir(text: str, instance: Instance) -> Answer:
    """The gold task as an answer; the text is not read. Raises `TypeError` without a gold task."""
    if not isinstance(instance, GoldInstance):
        raise TypeError(f"gold-ir needs a GoldInstance, not {type(instance).__name__}")
    graph = read_graph(instance.gold, ("precedence",), Findings())
    return graph_answer(text, graph, instance.gold, Report())
