"""Small random tasks for the search over lists: calendars, pauses, set-ups, due dates, modes."""

from __future__ import annotations

import random

from builders import Document, act

OBJECTIVES = (
    "minimize_makespan",
    "minimize_tardiness",
    "minimize_tardy",
    "minimize_max_tardiness",
    "minimize_flow_time",
    "minimize_setup_time",
    "minimize_setup_cost",
    {"sum": [[2, "minimize_makespan"], [3, "minimize_tardiness"], [1, "minimize_setup_cost"]]},
    {"sum": [[1, "minimize_cost"], [1, "minimize_flow_time"], [2, "minimize_setup_time"]]},
)
FAMILIES = ("red", "blue", "green")


def list_task(seed: int, size: int = 7) -> Document:
    """A task with some of all that the search knows, and one of its objectives."""
    rng = random.Random(seed)
    resources = [_line("m", rng), _line("n", rng), _crew(rng)]
    actions = [_action(f"a{k}", rng) for k in range(size)]
    arcs = [
        {
            "before": f"a{i}",
            "after": f"a{j}",
            "min_lag": rng.choice((0, 0, 2)),
            "type": rng.choice(("finish-start", "finish-start", "start-start")),
        }
        for j in range(size)
        for i in range(j)
        if rng.random() < 0.2
    ]
    task: Document = {
        "resources": resources,
        "actions": actions,
        "precedence": arcs,
        "calendars": [
            {"id": "day", "every": 10, "open": [{"from": 1, "to": 7}]},
            {"id": "two", "every": 12, "open": [{"from": 0, "to": 4}, {"from": 5, "to": 10}]},
        ],
        "objective": [OBJECTIVES[seed % len(OBJECTIVES)]],
    }
    if rng.random() < 0.4:
        group = {"id": "g", "actions": ["a0", "a1"], "due": rng.randint(2, 12), "weight": 2}
        task["groups"] = [group]
    return task


def _line(name: str, rng: random.Random) -> Document:
    """A resource of one unit, perhaps with set-ups, perhaps with a calendar."""
    found: Document = {"id": name}
    if rng.random() < 0.6:
        rows = [
            {"from": a, "to": b, "time": rng.randint(0, 3), "cost": rng.randint(0, 4)}
            for a in FAMILIES
            for b in FAMILIES
            if a != b or rng.random() < 0.3
        ]
        found["setups"] = {"times": rows}
        if rng.random() < 0.5:
            found["setups"]["initial"] = rng.choice(FAMILIES)
    if rng.random() < 0.5:
        found["calendar"] = rng.choice(("day", "two"))
    return found


def _crew(rng: random.Random) -> Document:
    """A resource of several units, perhaps with another capacity at times."""
    found: Document = {"id": "crew", "capacity": 3}
    if rng.random() < 0.5:
        found["availability"] = [
            {"from": 4, "to": 6, "capacity": 0},
            {"from": 9, "to": 13, "capacity": 2},
        ]
    return found


def _action(name: str, rng: random.Random) -> Document:
    more: Document = {}
    if rng.random() < 0.4:
        more["breaks"] = "pause"
        if rng.random() < 0.5:
            more["max_pause"] = rng.randint(5, 12)
    if rng.random() < 0.2:
        more["calendar"] = "two"
    if rng.random() < 0.3:
        more["release"] = rng.randint(1, 6)
    if rng.random() < 0.6:
        more |= {"due": rng.randint(2, 14), "weight": rng.randint(1, 3)}
    line = {"resource": rng.choice("mn"), "family": rng.choice(FAMILIES)}
    crew = {"resource": "crew", "amount": rng.randint(1, 2)}
    kind = rng.randrange(4)
    if kind == 0:
        modes = [
            {"id": "one", "duration": rng.randint(1, 4), "uses": [line], "cost": rng.randint(0, 3)},
            {"id": "other", "duration": rng.randint(1, 4), "uses": [crew]},
        ]
        return {"id": name, "modes": modes, **more}
    if kind == 1:
        either = {"one_of": ["m", "n"], "family": rng.choice(FAMILIES)}
        return act(name, rng.randint(1, 4), uses=[either], **more)
    return act(name, rng.randint(0, 4), uses=[line, crew] if kind == 2 else [line], **more)
