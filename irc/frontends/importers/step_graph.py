"""Actions and edges as language models write them in JSON; every fault as a diagnostic."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any

from irc.diagnostics import Code, Findings, did_you_mean

Duration = int | float


@dataclass(frozen=True)
class WrittenAction:
    """An action as the answer has it; `duration` is None where no number stands there."""

    id: str
    duration: Duration | None
    fields: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Edge:
    """One action before another, by at least `lag`."""

    before: str
    after: str
    lag: Duration = 0


@dataclass(frozen=True)
class StepGraph:
    """The actions and edges of an answer, in the order of the text."""

    actions: tuple[WrittenAction, ...]
    edges: tuple[Edge, ...]


BEFORE = ("before", "predecessor")
AFTER = ("after", "successor")
LAG = ("min_lag", "lag")


def read_graph(
    content: Mapping[str, Any], edges_in: Sequence[str], findings: Findings
) -> StepGraph:
    """The actions and the edges of the first field of `edges_in` that is there."""
    written = content.get("actions")
    if not isinstance(written, list):
        findings.add(Code.MISSING_FIELD, "the answer has no list 'actions'")
        written = []
    elif not written:
        findings.add(Code.MISSING_FIELD, "the answer has no actions", ("actions",))
    found = (_action(item, k, findings) for k, item in enumerate(written))
    actions = tuple(action for action in found if action is not None)
    field = next((name for name in edges_in if name in content), edges_in[0])
    return StepGraph(actions, _edges(content.get(field), field, findings))


def _action(item: object, k: int, findings: Findings) -> WrittenAction | None:
    if not isinstance(item, Mapping) or not isinstance(item.get("id"), (str, int)):
        shown = json.dumps(item, ensure_ascii=False, default=str)
        message = f"action {k + 1} has no 'id': {shown if len(shown) < 60 else shown[:57] + '...'}"
        findings.add(Code.MISSING_FIELD, message, ("actions", k), hint='add "id": …')
        return None
    duration = number(item.get("duration"))
    name = str(item["id"])
    if duration is None:
        given = item.get("duration")
        found = "" if given is None else f", found {given!r}"
        message = f"action {name!r} has no duration that is a number{found}"
        findings.add(Code.WRONG_TYPE, message, ("actions", k), hint='write "duration": 60')
    elif duration < 0:
        message = f"the duration of action {name!r} is negative"
        findings.add(Code.NEGATIVE_TIME, message, ("actions", k, "duration"))
    return WrittenAction(name, duration, item)


def number(value: object) -> Duration | None:
    """The value if it is a finite number; None for anything else."""
    if isinstance(value, float):
        return value if isfinite(value) else None
    return value if isinstance(value, int) and not isinstance(value, bool) else None


def _edges(written: object, field: str, findings: Findings) -> tuple[Edge, ...]:
    if written is None:
        return ()
    if not isinstance(written, list):
        findings.add(Code.WRONG_TYPE, f"'{field}' is not a list", (field,))
        return ()
    edges: list[Edge] = []
    for k, item in enumerate(written):
        edge = _edge(item)
        if edge is None:
            shown = json.dumps(item, ensure_ascii=False, default=str)
            message = f"entry {k + 1} of '{field}' has no two ends: {shown[:60]}"
            hint = 'write {"before": "…", "after": "…"}'
            findings.add(Code.WRONG_TYPE, message, (field, k), hint=hint)
        else:
            edges.append(edge)
    return tuple(edges)


def _edge(item: object) -> Edge | None:
    if isinstance(item, Mapping):
        before, after = (_first(item, names) for names in (BEFORE, AFTER))
        lag = number(_first(item, LAG)) or 0
    elif isinstance(item, list) and len(item) == 2:
        (before, after), lag = item, 0
    else:
        return None
    if not isinstance(before, (str, int)) or not isinstance(after, (str, int)):
        return None
    return Edge(str(before), str(after), lag)


def _first(item: Mapping[str, Any], names: Sequence[str]) -> Any:
    return next((item[name] for name in names if item.get(name) is not None), None)


def check_names(graph: StepGraph, field: str, findings: Findings) -> None:
    """Records the edges to actions that are not there."""
    known = {action.id for action in graph.actions}
    for k, edge in enumerate(graph.edges):
        for name in (edge.before, edge.after):
            if name not in known:
                message = f"an edge names {name!r}, which is no action"
                hint = did_you_mean(name, known) or "name an action by its 'id'"
                findings.add(Code.UNKNOWN_NAME, message, (field, k), hint=hint)


def precedence(graph: StepGraph) -> list[dict[str, Any]]:
    """The edges as the IR's precedence."""
    return [
        {
            "before": edge.before,
            "after": edge.after,
            **({"min_lag": edge.lag} if edge.lag else {}),
        }
        for edge in graph.edges
    ]
