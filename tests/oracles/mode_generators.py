"""Random small tasks whose modes have a cost, stock and state."""

from __future__ import annotations

import random
from typing import Any

from irc.model import Task

Document = dict[str, Any]

_OBJECTIVES = (
    ["minimize_makespan"],
    ["minimize_cost", "minimize_makespan"],
    ["minimize_makespan", "minimize_cost"],
    ["maximize_reward", "minimize_cost"],
)


def mode_task(seed: int) -> Task:
    """A task of two to four actions, of which most have modes that add something to them."""
    rng = random.Random(seed)
    names = [f"a{k}" for k in range(rng.randint(2, 4))]
    actions = [_action(rng, name) for name in names]
    edges = [
        {"before": a, "after": b}
        for k, a in enumerate(names)
        for b in names[k + 1 :]
        if rng.random() < 0.2
    ]
    document: Document = {
        "resources": [
            {"id": "oven"},
            {"id": "bench", "capacity": 2},
            {"id": "flour", "kind": "reservoir", "initial": rng.randint(0, 3), "max": 4},
        ],
        "state": [{"id": "lit", "initial": rng.random() < 0.5}],
        "actions": actions,
        "precedence": edges,
        "objective": rng.choice(_OBJECTIVES),
    }
    if rng.random() < 0.3:
        document["deadline"] = rng.randint(4, 12)
    if rng.random() < 0.3:
        document["goals"] = [{"var": "lit", "value": rng.random() < 0.5}]
    return Task.model_validate(document)


def _action(rng: random.Random, name: str) -> Document:
    action: Document = {"id": name}
    if rng.random() < 0.4:
        action |= _additions(rng)
    if rng.random() < 0.3:
        action |= {"occurs": "optional", "reward": rng.randint(1, 5)}
    if rng.random() < 0.15:
        return {**action, "duration": rng.randint(0, 4)}
    modes = []
    for k in range(rng.randint(1, 3)):
        duration: Any = rng.randint(0, 5)
        if rng.random() < 0.2:
            duration = {"min": rng.randint(0, 2), "max": rng.randint(2, 4)}
        mode: Document = {"id": f"m{k}", "duration": duration}
        if rng.random() < 0.8:
            mode |= _additions(rng)
        if rng.random() < 0.5:
            mode["uses"] = [{"resource": rng.choice(["oven", "bench"])}]
        if rng.random() < 0.5:
            mode["cost"] = rng.randint(0, 6)
        modes.append(mode)
    return {**action, "modes": modes}


def _additions(rng: random.Random) -> Document:
    fields: Document = {}
    field = rng.choice(("consumes", "produces", "conditions", "effects", "both", ""))
    if field in ("consumes", "produces"):
        change: Document = {"resource": "flour", "amount": rng.randint(1, 2)}
        if rng.random() < 0.3:
            change["at"] = rng.choice(("start", "end"))
        fields[field] = [change]
    if field in ("conditions", "both"):
        at = rng.choice(("start", "all", "end"))
        fields["conditions"] = [{"at": at, "var": "lit", "value": rng.random() < 0.5}]
    if field in ("effects", "both"):
        at = rng.choice(("start", "end"))
        fields["effects"] = [{"at": at, "var": "lit", "value": rng.random() < 0.5}]
    return fields
