"""Shops with late jobs, and a check of their explanations that solves everything again."""

from __future__ import annotations

import copy
import random
from typing import Any

import irc

Document = dict[str, Any]


def shop(seed: int) -> Document:
    """Jobs on two machines, most of which are due too early."""
    rng = random.Random(f"late {seed}")
    actions: list[Document] = []
    precedence = []
    for j in range(rng.randint(3, 5)):
        steps = rng.sample(["mill", "lathe"], 2)
        for k, machine in enumerate(steps):
            action = {"id": f"{j}.{k}", "duration": rng.randint(5, 20)}
            actions.append({**action, "uses": [{"resource": machine}]})
        actions[-1] |= {"due": rng.randint(15, 50), "weight": rng.randint(1, 3)}
        precedence.append([f"{j}.0", f"{j}.1"])
        if rng.random() < 0.3:
            actions[-2]["release"] = rng.randint(5, 20)
    return {
        "resources": [{"id": "mill"}, {"id": "lathe"}],
        "actions": actions,
        "precedence": precedence,
        "objective": ["minimize_tardiness", "minimize_makespan"],
    }


def _changed(document: Document, pointer: str, value: object) -> Document:
    """The document with another value at a place, or without it."""
    document = copy.deepcopy(document)
    *path, last = [int(p) if p.isdigit() else p for p in pointer.split("/")[1:]]
    owner: Any = document
    for part in path:
        owner = owner[part]
    if value is None:
        del owner[last]
    else:
        owner[last] = value
    return document


def _lateness(document: Document, name: str) -> object:
    schedule = irc.solve(document, time_limit=30)
    assert irc.validate(document, schedule).valid
    due = next(a["due"] for a in document["actions"] if a["id"] == name)
    return max(0, schedule[name].end - due)


def faults_of(document: Document) -> tuple[list[str], int]:
    """(what is wrong with the explanations of a shop's late jobs, how many jobs are late)."""
    schedule = irc.solve(document, time_limit=30)
    found: list[str] = []
    count = 0
    for action in document["actions"]:
        name = action["id"]
        if "due" not in action or schedule[name].end <= action["due"]:
            continue
        count += 1
        said = irc.explain_lateness(document, name, time_limit=30)
        possible = irc.solve(_on_time(document, name), time_limit=30).status != "infeasible"
        if said.possible is not possible:
            found.append(f"{name}: possible {said.possible}, should be {possible}")
        if not said.changes:
            found.append(f"{name}: no change")
        for change in said.changes:
            one = change.to_dict()
            if _lateness(_changed(document, one["pointer"], one["value"]), name):
                found.append(f"{name}: {change.text}: does not help")
        if said.chain is None or said.chain[-1].end != said.end:
            found.append(f"{name}: the chain ends elsewhere")
    return found, count


def _on_time(document: Document, name: str) -> Document:
    return {
        **document,
        "actions": [
            {**a, "deadline": a["due"]} if a["id"] == name else a for a in document["actions"]
        ],
    }
