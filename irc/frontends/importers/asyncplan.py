"""Importer for AsyncPlan-XXL: makes one IR task of each task graph of a planning benchmark.

Format: a list of instances with `id`, `task_title` and `graph`, where `graph.edges` are pairs of
nodes, `graph.durations` integer seconds by node, `graph.step_to_node` the node of each step.
Source: repository jiayizx/async_planning (Zhang et al. 2026).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Pointer, Source
from irc.frontends.importers.instances import read_json
from irc.model import Task

_STEP = re.compile(r"^\s*Step\s+(\d+)\.\s*(.+?)\s*(?:\([^()]*\))?\s*$", re.MULTILINE)

_EXPECTED = "expected AsyncPlan-XXL: a list of instances, each with a 'graph'"


def import_asyncplan(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of every instance. Raises `InputError` with the faulty instance."""
    content, faults = read_json(text, name, hint=_EXPECTED)
    source = faults.source
    single = isinstance(content, Mapping)
    instances = [content] if single else content
    for position, instance in enumerate(instances):
        at: Pointer = () if single else (position,)
        where = f"{name}, instance {position + 1}"
        if not isinstance(instance, Mapping) or not isinstance(instance.get("graph"), Mapping):
            raise _refused(f"{where}: expected an object with 'graph'", at, source)
        task = _task(instance, where, at, source)
        size = instance.get("n_steps", len(task.actions))
        yield f"nodes{size}_{instance.get('id', position + 1)}", task


def _task(instance: Mapping[str, Any], where: str, at: Pointer, source: Source) -> Task:
    graph = instance["graph"]
    at = (*at, "graph")
    durations, edges = graph.get("durations"), graph.get("edges")
    steps = graph.get("step_to_node")
    if not isinstance(durations, list) or not isinstance(edges, list):
        message = f"{where}: 'graph' needs the lists 'durations' and 'edges'"
        raise _refused(message, at, source)
    if not isinstance(steps, Mapping):
        steps = {str(i + 1): i for i in range(len(durations))}
    texts = dict(_STEP.findall(str(instance.get("question", ""))))
    try:
        step_of = {node: step for step, node in steps.items()}
        if sorted(step_of) != list(range(len(durations))):
            message = f"{where}: 'step_to_node' does not name each node once"
            raise _refused(message, (*at, "step_to_node"), source)
        return Task.model_validate(
            {
                "name": str(instance.get("task_title") or f"instance {instance.get('id')}"),
                "metadata": {k: instance[k] for k in ("id", "answer") if k in instance},
                "actions": [
                    {
                        "id": f"step{step}",
                        "duration": durations[node],
                        **({"label": texts[step]} if step in texts else {}),
                    }
                    for step, node in sorted(steps.items(), key=lambda s: (len(s[0]), s[0]))
                ],
                "precedence": [
                    {"before": f"step{step_of[a]}", "after": f"step{step_of[b]}"} for a, b in edges
                ],
            }
        )
    except (ValueError, KeyError, TypeError) as error:
        raise _refused(f"{where}: {_reason(error)}", at, source) from None


def _reason(error: Exception) -> str:
    if isinstance(error, KeyError):
        return f"an edge names the node {error}, which has no duration"
    return str(error).splitlines()[0]


def _refused(message: str, pointer: Pointer, source: Source) -> InputError:
    findings = Findings()
    findings.add(Code.NOT_AN_IMPORT, message, pointer, hint=_EXPECTED)
    return InputError(Report(tuple(findings.items), source))
