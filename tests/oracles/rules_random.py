"""Random tasks in which the three rules of an instant meet: resources respect ranks, the past comes
first, and stock changes one happening after another.

Few actions on few resources, reservoirs with tight bounds and two variables, so that much happens
at one instant; and an event that changes the world just when the plan has something start or end.
"""

from __future__ import annotations

import random
from typing import Any

import irc
from irc.model import Event, Task
from irc.schedule import Schedule

Document = dict[str, Any]


def rules_task(seed: int, *, state: bool = True) -> Task:
    """At most 4 actions that read, change, hold, take and give; the same for the same seed.

    Tasks in which `irc.check` finds a fault are drawn again. Without `state` only resources and
    stock are left.
    """
    rng = random.Random(f"rules {seed}")
    while True:
        document = _drawn(rng)
        task = Task.model_validate(document if state else _without_state(document))
        if irc.check(task).ok:
            return task


def _without_state(document: Document) -> Document:
    actions = [
        {key: part for key, part in action.items() if key not in ("conditions", "effects")}
        for action in document["actions"]
    ]
    return {**document, "actions": actions, "state": [], "goals": []}


def _drawn(rng: random.Random) -> Document:
    return {
        "resources": [
            {"id": "press", "capacity": rng.choice([1, 1, 2])},
            {"id": "shelf", "kind": "reservoir", "initial": 1, "max": rng.choice([1, 2, 3])},
            {"id": "coins", "kind": "reservoir", "initial": rng.choice([0, 1, 2])},
        ],
        "state": [
            {"id": "x", "initial": rng.random() < 0.5},
            {"id": "y", "initial": rng.random() < 0.5},
        ],
        "actions": [_action(rng, name) for name in "abcd"[: rng.randint(3, 4)]],
        "precedence": [["a", "b"]] if rng.random() < 0.3 else [],
        "goals": [_fact(rng)] if rng.random() < 0.2 else [],
    }


def _action(rng: random.Random, name: str) -> Document:
    low = rng.choice([0, 1, 1, 2, 2, 3])
    action: Document = {"id": name, "duration": low}
    if rng.random() < 0.2:
        action["duration"] = {"min": low, "max": low + 1}
    if rng.random() < 0.2:
        action["release"] = rng.randint(1, 3)
    if rng.random() < 0.15:
        action["occurs"] = {"min": 0, "max": 2}
    if rng.random() < 0.6:
        action["uses"] = [{"resource": "press"}]
    action["conditions"] = [
        {"at": rng.choice(["start", "start", "all", "end"]), **_fact(rng)}
        for _ in range(rng.choice([0, 1, 1, 2]))
    ]
    action["effects"] = [
        {"at": rng.choice(["start", "end"]), **_fact(rng)} for _ in range(rng.choice([0, 1, 1]))
    ]
    if rng.random() < 0.5:
        kinds = rng.choice([["consumes"], ["produces"], ["consumes", "produces"]])
        for kind in kinds:
            change = {"resource": rng.choice(["shelf", "coins"]), "amount": rng.choice([1, 1, 2])}
            if rng.random() < 0.4:
                change["at"] = rng.choice(["start", "end"])
            action[kind] = [change]
    return {key: part for key, part in action.items() if part != []}


def _fact(rng: random.Random) -> Document:
    return {"var": rng.choice(["x", "x", "y"]), "value": rng.random() < 0.5}


def rules_event(seed: int, schedule: Schedule, *, state: bool = True) -> Event | None:
    """The world changes at an instant of the plan, but not at its very beginning.

    Without state something is added that has to do with nothing.
    """
    rng = random.Random(f"rules event {seed}")
    instants = sorted({t for e in schedule.entries for t in (e.start, e.end) if t > 0})
    if not instants:
        return None
    change: Document = {"op": "set_state", **_fact(rng)}
    if not state:
        change = {"op": "add_actions", "actions": [{"id": "tidy", "duration": 1}]}
    return Event.model_validate(
        {"id": "the world", "at": rng.choice(instants), "changes": [change]}
    )
