"""Importer for a Planner's JSON: actions, dependencies, and the makespan that the model states."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from irc.diagnostics import Findings, InputError, Report
from irc.frontends.importers.json_answer import placed_object
from irc.frontends.importers.step_graph import (
    Duration,
    StepGraph,
    check_names,
    number,
    precedence,
    read_graph,
)
from irc.frontends.json.document import json_source, read_document
from irc.model import Task
from irc.model.from_document import to_task

EXPECTED = (
    '{"actions": [{"id", "duration"}], "dependencies": [{"before", "after"}], '
    '"final_answer_seconds": N}'
)

_NUMBER = re.compile(r"\d+(?:\.\d+)?")


def import_planner(text: str, name: str) -> Task:
    """The task of a Planner's JSON; the makespan that it states is in the metadata.

    Raises `InputError` with every fault.
    """
    found = placed_object(text)
    if found is None:
        read_document(text, name)  # It raises, with every fault of the text.
    content, start = found or ({}, 0)
    _, document, findings = read_planner_json(content)
    stated = stated_makespan(content)
    if stated is not None:
        document["metadata"] = {"stated_makespan": stated}
    task = None if findings.has_errors else to_task(document, findings)
    if task is None:
        raise InputError(Report(tuple(findings.items), json_source(name, text, start)))
    return task


def read_planner_json(content: Mapping[str, Any]) -> tuple[StepGraph, dict[str, Any], Findings]:
    """(the graph of a Planner's JSON, the task as an IR document, every fault)."""
    findings = Findings()
    graph = read_graph(content, ("dependencies", "precedence"), findings)
    check_names(graph, "dependencies" if "dependencies" in content else "precedence", findings)
    document = {
        "irc": "1",
        "actions": [{"id": a.id, "duration": a.duration} for a in graph.actions],
        "precedence": precedence(graph),
    }
    return graph, document, findings


def stated_makespan(content: Mapping[str, Any]) -> Duration | None:
    """The stated makespan, also where the number stands in quotes."""
    value = content.get("final_answer_seconds")
    if isinstance(value, str) and _NUMBER.fullmatch(value.strip()):
        return number(float(value))
    return number(value)
