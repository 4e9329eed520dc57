"""Small random tasks that local search knows: shops, flexible shops, projects, stock."""

from __future__ import annotations

import random
from itertools import pairwise

from builders import Document, act


def use(resource: str, amount: int = 1) -> Document:
    """A use of one resource."""
    return {"resource": resource, "amount": amount}


def chain(*names: str) -> list[Document]:
    """Each of these before the next one."""
    return [{"before": a, "after": b} for a, b in pairwise(names)]


def job_shop(seed: int, *, flexible: bool = False) -> Document:
    """Three jobs of two operations on two machines, with a release and a lag; or with choices."""
    rng = random.Random(seed)
    machines = ["m0", "m1", "m2"] if flexible else ["m0", "m1"]
    actions, arcs = [], list[Document]()
    for job in range(3):
        names = [f"{job}.{k}" for k in range(2)]
        for k, name in enumerate(names):
            own = {"release": rng.randint(1, 4)} if job == 2 and not k and not flexible else {}
            if flexible:
                asked = sorted(rng.sample(machines, 2))
                modes = [{"id": m, "duration": rng.randint(1, 4), "uses": [use(m)]} for m in asked]
                actions.append({"id": name, "modes": modes})
            else:
                uses = [use(rng.choice(machines))]
                actions.append(act(name, rng.randint(1, 4), uses=uses, **own))
        arcs += chain(*names)
    arcs[0]["min_lag"] = rng.randint(0, 2)
    return {"resources": [{"id": m} for m in machines], "actions": actions, "precedence": arcs}


def larger_shop(*, flexible: bool = False) -> Document:
    """Twelve jobs of five operations on five machines, or on any of two of them."""
    rng = random.Random(7)
    machines = [f"m{k}" for k in range(5)]
    actions, arcs = [], list[Document]()
    for job in range(12):
        names = [f"{job}.{k}" for k in range(5)]
        for name, machine in zip(names, rng.sample(machines, 5), strict=True):
            other = rng.choice([m for m in machines if m != machine])
            uses = [{"one_of": [machine, other]} if flexible else use(machine)]
            actions.append(act(name, rng.randint(1, 9), uses=uses))
        arcs += chain(*names)
    return {"resources": [{"id": m} for m in machines], "actions": actions, "precedence": arcs}


def project(seed: int) -> Document:
    """Six activities that hold some of two resources, in a random order of precedence."""
    rng = random.Random(seed)
    actions = [
        act(
            f"a{i}",
            rng.randint(1, 4),
            uses=[use(r, rng.randint(1, 3)) for r in ("r", "s") if rng.random() < 0.8],
        )
        for i in range(6)
    ]
    arcs = [
        {"before": f"a{i}", "after": f"a{j}", "min_lag": rng.choice((0, 0, 1))}
        for j in range(6)
        for i in range(j)
        if rng.random() < 0.25
    ]
    resources = [{"id": "r", "capacity": 4}, {"id": "s", "capacity": 3}]
    return {"resources": resources, "actions": actions, "precedence": arcs}


def with_stock(seed: int) -> Document:
    """Three activities with a quick and a slow mode; the quick ones use up a stock."""
    rng = random.Random(seed)
    actions: list[Document] = [
        {
            "id": f"a{i}",
            "modes": [
                {
                    "id": "quick",
                    "duration": rng.randint(1, 2),
                    "uses": [use("r", rng.randint(1, 2))],
                    "consumes": [use("n", rng.randint(1, 3))],
                },
                {"id": "slow", "duration": rng.randint(3, 5), "uses": [use("r")]},
            ],
        }
        for i in range(3)
    ]
    stock = {"id": "n", "kind": "reservoir", "initial": 4}
    return {
        "resources": [{"id": "r", "capacity": 2}, stock],
        "actions": actions,
        "precedence": chain("a0", "a2"),
    }
