"""Random tasks for `oracles.small_tasks`: objectives on due dates, couplings, selections."""

from __future__ import annotations

import random
from collections.abc import Sequence
from itertools import combinations
from typing import Any

Document = dict[str, Any]

_DATED = (
    *("minimize_tardiness", "minimize_tardy", "minimize_max_tardiness"),
    *("minimize_earliness", "minimize_flow_time"),
)
_OTHERS = ("minimize_makespan", "minimize_cost", "maximize_reward")


def objective_task(seed: int) -> Document:
    """A task with due dates, under one or two objectives, some of them sums."""
    rng = random.Random(seed)
    document = _base(rng, rng.randint(2, 4))
    for action in document["actions"]:
        if rng.random() < 0.7:
            action["due"] = rng.randint(-3, 8)
        if rng.random() < 0.5:
            action["weight"] = rng.randint(0, 3)
            action.setdefault("due", 4)
    for group in document.get("groups", ()):
        if rng.random() < 0.5:
            group |= {"due": rng.randint(0, 8), "weight": rng.randint(1, 3)}
    levels: list[Any] = [rng.choice(_DATED)]
    if rng.random() < 0.4:
        levels.append(rng.choice([o for o in (*_DATED, *_OTHERS) if o != levels[0]]))
    if rng.random() < 0.3:
        parts = rng.sample((*_DATED, *_OTHERS), 2)
        levels[0] = {"sum": [[rng.randint(1, 3), part] for part in parts]}
    rng.shuffle(levels)
    document["objective"] = levels
    return document


def _base(rng: random.Random, count: int) -> Document:
    names = [f"a{k}" for k in range(count)]
    resources = [{"id": "m1"}, {"id": "m2"}, {"id": "m3", "capacity": 2}]
    actions = [_action(rng, name, ["m1", "m2", "m3"]) for name in names]
    edges = []
    for k, before in enumerate(names):
        for after in names[k + 1 :]:
            if rng.random() < 0.2:
                edge: Document = {"before": before, "after": after}
                if rng.random() < 0.3:
                    edge["min_lag"] = rng.randint(-1, 2)
                if rng.random() < 0.2:
                    edge["max_lag"] = edge.get("min_lag", 0) + rng.randint(0, 3)
                edges.append(edge)
    document: Document = {"resources": resources, "actions": actions, "precedence": edges}
    if count > 2 and rng.random() < 0.4:
        members = rng.sample(names, 2)
        group: Document = {"id": "g", "actions": members}
        if rng.random() < 0.6:
            group |= {"required": False, "reward": rng.randint(0, 5)}
            for action in actions:
                if action["id"] in members:
                    action.pop("occurs", None)
        document["groups"] = [group]
    return document


def _action(rng: random.Random, name: str, resources: Sequence[str]) -> Document:
    action: Document = {"id": name}
    if rng.random() < 0.25:
        action["modes"] = [
            {"id": f"w{k}", "duration": rng.randint(0, 3), "cost": rng.randint(0, 4)}
            for k in range(2)
        ]
        if rng.random() < 0.5:
            action["modes"][0]["uses"] = [{"resource": rng.choice(resources)}]
    else:
        action["duration"] = rng.randint(0, 3)
    if rng.random() < 0.7:
        action["uses"] = [_use(rng, resources)]
    if rng.random() < 0.3:
        action["release"] = rng.randint(0, 3)
    if rng.random() < 0.15:
        action["deadline"] = rng.randint(3, 9)
    if rng.random() < 0.3:
        action |= {"occurs": "optional", "reward": rng.randint(0, 4)}
    if rng.random() < 0.2:
        action["cost"] = rng.randint(0, 3)
    return action


def _use(rng: random.Random, resources: Sequence[str]) -> Document:
    if rng.random() < 0.5:
        return {"one_of": rng.sample(list(resources), rng.randint(2, len(resources)))}
    return {"resource": rng.choice(resources)}


def coupling_task(seed: int) -> Document:
    """A task in which choices of resources and modes depend on each other."""
    rng = random.Random(seed)
    document = _base(rng, rng.randint(2, 4))
    actions = document["actions"]
    for action in actions:
        for part in (action, *action.get("modes", ())):
            if "duration" in part and rng.random() < 0.9:
                part["duration"] += 1
        if not action.get("uses") and rng.random() < 0.7:
            action["uses"] = [{"one_of": rng.sample(["m1", "m2", "m3"], 2)}]
        if action.get("uses") and rng.random() < 0.2:
            action["uses"].append({"resource": rng.choice(["m1", "m2", "m3"])})
    document["couplings"] = [_coupling(rng, actions) for _ in range(rng.randint(1, 2))]
    document["objective"] = rng.choice(
        ("minimize_makespan", ["minimize_cost", "minimize_makespan"], ["maximize_reward"])
    )
    return document


def _coupling(rng: random.Random, actions: list[Document]) -> Document:
    kind = rng.choice(("same", "different", "if"))
    if kind == "if":
        one, other = rng.sample(actions, 2)
        return {"if": _made(rng, one), "then": _made(rng, other)}
    chosen = rng.sample(actions, rng.randint(2, min(3, len(actions))))
    if rng.random() < 0.25 and all("modes" in action for action in chosen):
        return {kind: "mode", "actions": [action["id"] for action in chosen]}
    named: list[Any] = []
    for action in chosen:
        with_use = bool(action.get("uses")) and rng.random() < 0.6
        named.append({"action": action["id"], "use": 0} if with_use else action["id"])
    return {kind: "resource", "actions": named}


def _made(rng: random.Random, action: Document) -> Document:
    if "modes" in action and rng.random() < 0.5:
        if rng.random() < 0.3:
            return {"action": action["id"], "modes": [mode["id"] for mode in action["modes"]]}
        return {"action": action["id"], "mode": rng.choice(action["modes"])["id"]}
    made: Document = {"action": action["id"], "resource": rng.choice(["m1", "m2", "m3"])}
    if action.get("uses") and rng.random() < 0.5:
        made["use"] = 0
    return made


def selection_task(seed: int) -> Document:
    """A task in which rules say how many optional actions and groups are present."""
    rng = random.Random(seed)
    document = _base(rng, rng.randint(3, 4))
    names = [action["id"] for action in document["actions"]]
    grouped = {name for group in document.get("groups", ()) for name in group["actions"]}
    for action in document["actions"]:
        if action["id"] not in grouped and rng.random() < 0.7:
            action |= {"occurs": "optional", "reward": rng.randint(0, 4)}
    items = [*names, *(group["id"] for group in document.get("groups", ()))]
    document["select"] = []
    for _ in range(rng.randint(1, 2)):
        chosen = rng.sample(items, rng.randint(1, min(3, len(items))))
        least = rng.randint(0, len(chosen))
        rule: Document = {"actions": chosen, "min": least}
        if rng.random() < 0.6:
            rule["max"] = rng.randint(least, len(chosen))
        if rng.random() < 0.3:
            rule["if"] = rng.choice(items)
        if rng.random() < 0.3:
            rule = {key: rule[key] for key in ("actions", "if") if key in rule}
            rule["all_or_none"] = True
        document["select"].append(rule)
    document["objective"] = rng.choice(
        ("minimize_makespan", ["minimize_cost", "minimize_makespan"], ["maximize_reward"])
    )
    return document


def sequence_task(seed: int) -> Document:
    """A task with orders of uses: one next after another, or the same on two resources."""
    rng = random.Random(f"sequences {seed}")
    document = _base(rng, rng.randint(3, 4))
    actions = document["actions"]
    machines = ["m1", "m2"]
    for action in actions:
        parts = action.get("modes") or [action]
        for part in parts:
            if rng.random() < 0.85:
                part["duration"] = rng.randint(1, 3)
        action["uses"] = [{"resource": rng.choice(machines)}]
        if rng.random() < 0.3:
            action["uses"] = [{"one_of": machines}]
        elif rng.random() < 0.3:
            action["uses"] = [{"resource": name} for name in machines]
        for mode in action.get("modes", ()):
            mode.pop("uses", None)
            if rng.random() < 0.4:
                mode["uses"] = [{"resource": "m3"}]
        if rng.random() < 0.3:
            action["due"] = rng.randint(1, 8)
    if rng.random() < 0.5:
        _flow_shop(rng, document)
    names = [action["id"] for action in document["actions"]]
    document["sequences"] = document.get("sequences", [])
    for _ in range(rng.randint(0 if document["sequences"] else 1, 2)):
        rule: Document = {"consecutive": rng.sample(names, 2)}
        if rng.random() < 0.7:
            rule["resource"] = rng.choice(machines)
        document["sequences"].append(rule)
    if not any("resource" in rule or "same_order" in rule for rule in document["sequences"]):
        document["resources"][2]["capacity"] = 1
    document["objective"] = rng.choice(
        ("minimize_makespan", ["minimize_tardiness", "minimize_makespan"], ["maximize_reward"])
    )
    for rule in document["sequences"]:
        if "consecutive" in rule and "resource" not in rule:
            document["resources"][2]["capacity"] = 1
    return document


def _flow_shop(rng: random.Random, document: Document) -> None:
    """Two or three jobs on two machines, which have the same order there."""
    jobs = [f"j{k}" for k in range(rng.randint(2, 3))]
    document["actions"] = document["actions"][: 4 - len(jobs)]
    kept = {action["id"] for action in document["actions"]}
    document["precedence"] = [
        e for e in document["precedence"] if {e["before"], e["after"]} <= kept
    ]
    document.pop("groups", None)
    rows = []
    for job in jobs:
        row = [f"{job} first", f"{job} second"]
        for name, machine in zip(row, ("m1", "m2"), strict=True):
            document["actions"].append(
                {"id": name, "duration": rng.randint(1, 3), "uses": [{"resource": machine}]}
            )
        if rng.random() < 0.2:
            document["actions"][-1] |= {"occurs": "optional", "reward": rng.randint(0, 3)}
        if rng.random() < 0.8:
            document["precedence"].append({"before": row[0], "after": row[1]})
        rows.append(row)
    rule: Document = {"same_order": ["m1", "m2"]}
    if rng.random() < 0.5 and not any("occurs" in a for a in document["actions"]):
        document["groups"] = [
            {"id": job, "actions": row} for job, row in zip(jobs, rows, strict=True)
        ]
    else:
        rule["jobs"] = rows
    document["sequences"] = [rule]


def batch_task(seed: int) -> Document:
    """A task with a resource that takes loads."""
    rng = random.Random(f"batches {seed}")
    document = _base(rng, rng.randint(3, 4))
    document["resources"] = [
        {"id": "m1"},
        {"id": "m2", "kind": "batch", "capacity": rng.randint(1, 4)},
        {"id": "m3", "kind": "batch", "capacity": 2},
    ]
    families: list[str | None] = [None, "red", "blue"][: rng.randint(1, 3)]
    usual = rng.randint(1, 3)
    for action in document["actions"]:
        parts = action.get("modes") or [action]
        for part in parts:
            part["duration"] = usual if rng.random() < 0.5 else rng.randint(0, 3)
            if rng.random() < 0.25:
                least = rng.randint(0, 2)
                part["duration"] = {"min": least, "max": least + rng.randint(0, 2)}
            for use in part.get("uses", ()):
                use["family"] = "red"
        if rng.random() < 0.85:
            use = {"resource": "m2"} if rng.random() < 0.6 else {"one_of": ["m2", "m3"]}
            use["amount"] = rng.choice((1, 1, 1, 2))
            action["uses"] = [use]
        for use in action.get("uses", ()):
            family = rng.choice(families)
            if family is not None:
                use["family"] = family
        for mode in action.get("modes", ()):
            mode["uses"] = [{"resource": "m1"}] if rng.random() < 0.3 else []
        if rng.random() < 0.3:
            action["due"] = rng.randint(1, 8)
    document["objective"] = rng.choice(
        ("minimize_makespan", ["minimize_tardiness", "minimize_makespan"], ["maximize_reward"])
    )
    return document


NEW_ELEMENTS = ("sequences", "batches", "couplings", "selections", "objectives")


def pair_of(seed: int) -> tuple[str, str]:
    """The two elements of `pair_task`, each pair in its turn."""
    pairs = list(combinations(NEW_ELEMENTS, 2))
    return pairs[seed % len(pairs)]


def pair_task(seed: int) -> Document:
    """A task with two of the elements at once."""
    rng = random.Random(f"pairs {seed}")
    pair = pair_of(seed)
    makers = {"sequences": sequence_task, "batches": batch_task, "objectives": objective_task}
    first = next((name for name in pair if name in makers), "")
    document = makers[first](seed) if first else coupling_task(seed)
    actions = document["actions"]
    if "batches" in pair and first != "batches":
        document["resources"].append({"id": "kiln", "kind": "batch", "capacity": rng.randint(1, 3)})
        for action in rng.sample(actions, rng.randint(2, min(3, len(actions)))):
            use: Document = {"resource": "kiln", "family": rng.choice(("red", "red", "blue"))}
            action.setdefault("uses", []).append(use)
        for order in document.get("sequences", ()):
            if "consecutive" in order:
                order.setdefault("resource", "m1")
    if "couplings" in pair and first:
        for order in document.get("sequences", ()):
            if "consecutive" in order:
                order.setdefault("resource", "m1")
        for action in actions:
            if rng.random() < 0.6:
                action.setdefault("uses", []).append({"one_of": ["x1", "x2"]})
        document["resources"] += [{"id": "x1"}, {"id": "x2", "capacity": 2}]
        document["couplings"] = [_coupled(rng, actions) for _ in range(rng.randint(1, 2))]
    if "selections" in pair:
        grouped = {name for group in document.get("groups", ()) for name in group["actions"]}
        for action in actions:
            if action["id"] not in grouped and rng.random() < 0.6:
                action |= {"occurs": "optional", "reward": rng.randint(0, 4)}
        chosen = [a["id"] for a in rng.sample(actions, rng.randint(2, min(3, len(actions))))]
        rule: Document = {"actions": chosen, "all_or_none": True}
        if rng.random() < 0.6:
            rule = {"actions": chosen, "min": rng.randint(0, 1), "max": rng.randint(1, 2)}
        document["select"] = [rule]
    if "objectives" in pair and first != "objectives":
        for action in actions:
            action["due"] = rng.randint(0, 8)
        document["objective"] = [rng.choice(_DATED), "minimize_makespan"]
    return document


def _coupled(rng: random.Random, actions: Sequence[Document]) -> Document:
    one, other = rng.sample(list(actions), 2)
    made = [{"action": a["id"], "resource": rng.choice(("x1", "x2"))} for a in (one, other)]
    if rng.random() < 0.4:
        return {"if": made[0], "then": made[1]}
    kind = rng.choice(("same", "different"))
    return {kind: "resource", "actions": [one["id"], other["id"]]}
