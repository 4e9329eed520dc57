"""Importer for AsyncPlan-XXL: task graphs of a planning benchmark → one IR task each.

Format: a list of instances with `id`, `task_title` and `graph`, where `graph.edges` are pairs of
nodes, `graph.durations` integer seconds by node, `graph.step_to_node` the node of each step.
Source: repository jiayizx/async_planning (Zhang et al. 2026).
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report
from irc.model import Task

_STEP = re.compile(r"^\s*Step\s+(\d+)\.\s*(.+?)\s*(?:\([^()]*\))?\s*$", re.MULTILINE)


def import_asyncplan(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of every instance. Raises `InputError` naming the instance at fault."""
    try:
        instances = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise _refused(f"{name} is not JSON: {error}") from None
    if isinstance(instances, Mapping):
        instances = [instances]
    if not isinstance(instances, list):
        raise _refused(f"{name} does not hold a list of instances")
    for position, instance in enumerate(instances):
        where = f"{name}, instance {position + 1}"
        if not isinstance(instance, Mapping) or not isinstance(instance.get("graph"), Mapping):
            raise _refused(f"{where}: expected an object with 'graph'")
        task = _task(instance, where)
        size = instance.get("n_steps", len(task.actions))
        yield f"nodes{size}_{instance.get('id', position + 1)}", task


def _task(instance: Mapping[str, Any], where: str) -> Task:
    graph = instance["graph"]
    durations, edges = graph.get("durations"), graph.get("edges")
    steps = graph.get("step_to_node")
    if not isinstance(durations, list) or not isinstance(edges, list):
        raise _refused(f"{where}: 'graph' needs the lists 'durations' and 'edges'")
    if not isinstance(steps, Mapping):
        steps = {str(i + 1): i for i in range(len(durations))}
    texts = dict(_STEP.findall(str(instance.get("question", ""))))
    try:
        step_of = {node: step for step, node in steps.items()}
        if sorted(step_of) != list(range(len(durations))):
            raise _refused(f"{where}: 'step_to_node' does not name each node once")
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
        raise _refused(f"{where}: {str(error).splitlines()[0]}") from None


def _refused(message: str) -> InputError:
    findings = Findings()
    findings.add(Code.NOT_AN_IMPORT, message)
    return InputError(Report(tuple(findings.items)))
