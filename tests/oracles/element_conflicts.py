"""Checks conflicts of whole tasks: alone they have no schedule, without any one of them they have.

What is left out is left out of the document, by code of its own; the rest is solved, and a schedule
counts only because the validator has accepted it.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator
from typing import Any

import irc
from irc.explanation import Explanation
from irc.model import Task
from oracles.combined import combined_document
from oracles.state_brute_force import TooLargeError, optimum

Document = dict[str, Any]

ENDLESS = 1000


def faults_of_elements(document: Document, explanation: Explanation) -> list[str]:
    """What is wrong with the conflict of a document that has no schedule."""
    conflict = explanation.conflict
    if not conflict or not explanation.minimal:
        return ["no minimal conflict"]
    here = {s.pointer for s in conflict}
    alone = _marked(document, [e for e in _restricting(document) if e[1] not in here])
    if _status(alone) != "infeasible":
        return ["alone it has a schedule"]
    return [
        f"{s.text}: not needed"
        for s in conflict
        if _status(_marked(alone, [(s.kind, s.pointer)])) == "infeasible"
    ]


def _status(document: Document) -> str:
    return str(irc.solve(Task.model_validate(_cleared(document)), time_limit=30).status)


def _restricting(document: Document) -> Iterator[tuple[str, tuple[str | int, ...]]]:
    """(kind, pointer) of each thing whose absence only makes more possible."""
    if document.get("deadline") is not None:
        yield "task_deadline", ("deadline",)
    for k, resource in enumerate(document.get("resources", ())):
        at = ("resources", k)
        if resource.get("kind") == "reservoir":
            yield "stock_min", (*at, "min")
            if resource.get("max") is not None:
                yield "stock_max", (*at, "max")
            continue
        kind = "setups" if resource.get("setups") else "capacity"
        if not document.get("sequences"):
            yield kind, (*at, kind)
        if resource.get("kind") == "batch":
            yield "batch", (*at, "kind")
        for w, window in enumerate(resource.get("availability", ())):
            if window["capacity"] <= resource.get("capacity", 1):
                yield "window", (*at, "availability", w)
    for k, action in enumerate(document["actions"]):
        at = ("actions", k)
        for name in ("release", "deadline", "latest_start", "start"):
            if action.get(name) is not None:
                yield name, (*at, name)
        parts = [(at, action)]
        parts += [((*at, "modes", m), mode) for m, mode in enumerate(action.get("modes", ()))]
        for place, part in parts:
            if part.get("duration") is not None:
                yield "duration", (*place, "duration")
            for u in range(len(part.get("uses", ()))):
                yield "use", (*place, "uses", u)
            for c in range(len(part.get("conditions", ()))):
                yield "condition", (*place, "conditions", c)
    for field, kind in (
        ("precedence", "precedence"),
        ("goals", "goal"),
        ("sequences", "sequence"),
        ("select", "selection"),
    ):
        for k in range(len(document.get(field, ()))):
            yield kind, (field, k)
    for k, group in enumerate(document.get("groups", ())):
        if group.get("deadline") is not None:
            yield "group_deadline", ("groups", k, "deadline")


def _marked(document: Document, left_out: Iterable[tuple[str, tuple[str | int, ...]]]) -> Document:
    """The document with a hole (None) in the place of each thing that is left out."""
    changed = copy.deepcopy(document)
    for kind, pointer in left_out:
        *path, last = pointer
        owner: Any = changed
        for part in path:
            owner = owner[part]
        if isinstance(owner, dict) and kind not in _REPLACED:
            owner.pop(last, None)
        else:
            owner[last] = copy.deepcopy(_REPLACED.get(kind))
    return changed


_REPLACED: dict[str, Any] = {
    "duration": {"min": 0, "max": ENDLESS},
    "capacity": ENDLESS,
    "stock_min": -ENDLESS,
    "batch": "renewable",
}


def _cleared(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _cleared(inner) for key, inner in value.items()}
    return [_cleared(i) for i in value if i is not None] if isinstance(value, list) else value


def impossible(seeds: Iterable[int]) -> Iterator[Document]:
    """Random tasks with several features that brute force finds impossible."""
    for seed in seeds:
        document = combined_document(seed)
        try:
            task = Task.model_validate(document)
            report = irc.check(task)
            if (report.ok or report.contradicts) and optimum(task, max_situations=50_000) is None:
                yield document
        except (TooLargeError, ValueError):
            continue
