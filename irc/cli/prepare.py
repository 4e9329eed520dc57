"""`irc prepare`: compiles local search before the first task that needs it."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from typing import Any

from irc.driver.compile import lower_for
from irc.local_search.search import search_of
from irc.model import Task
from irc.targets import Budget, get_backend

_SIZE = 40
"""Activities of each task: enough that each part of a search is called."""

_SECONDS = 1.0
"""Time of a search after its first step, in which what is rare is compiled, too."""


def compile_searches() -> Iterator[tuple[str, float]]:
    """(name, seconds) of each search, as it is compiled."""
    for name, task in _tasks():
        whole = Budget(math.inf)
        search = search_of(lower_for(task, get_backend("cpsat")))
        search.step()
        rest = Budget(_SECONDS)
        while not rest.is_over:
            search.step()
        yield name, whole.elapsed


def _tasks() -> Iterator[tuple[str, Task]]:
    """A task for each search, and for each kind of profile of resources."""
    rng = random.Random(0)
    yield "shops", _shop(rng)
    yield "projects", _project(rng, 9)
    yield "projects with long activities", _project(rng, 9_000)
    yield "due dates, set-ups, calendars", _orders(rng)


def _shop(rng: random.Random) -> Task:
    machines = [f"m{k}" for k in range(5)]
    actions: list[dict[str, Any]] = []
    precedence = []
    for job in range(_SIZE // 5):
        for step in range(5):
            uses = [{"one_of": rng.sample(machines, rng.choice([1, 2]))}]
            actions.append({"id": f"{job}.{step}", "duration": rng.randint(1, 99), "uses": uses})
            if step:
                precedence.append({"before": f"{job}.{step - 1}", "after": f"{job}.{step}"})
    resources = [{"id": name} for name in machines]
    return Task(actions=actions, precedence=precedence, resources=resources)


def _project(rng: random.Random, longest: int) -> Task:
    actions = [
        {
            "id": f"a{k}",
            "duration": rng.randint(1, longest),
            "uses": [
                {"resource": name, "amount": rng.randint(1, 5)} for name in rng.sample("rst", 2)
            ],
        }
        for k in range(_SIZE)
    ]
    precedence = [
        {"before": f"a{rng.randrange(max(0, k - 9), k)}", "after": f"a{k}"} for k in range(5, _SIZE)
    ]
    resources = [{"id": name, "capacity": 8} for name in "rst"]
    return Task(actions=actions, precedence=precedence, resources=resources)


def _orders(rng: random.Random) -> Task:
    rows = [{"from": a, "to": b, "time": rng.randint(1, 9)} for a in "fg" for b in "fg" if a != b]
    times = [{"from": 0, "to": 8}, {"from": 9, "to": 17}]
    return Task(
        time_unit="h",
        calendars=[{"id": "shift", "every": "1 day", "open": times}],
        resources=[
            {"id": "m", "setups": {"times": rows}, "calendar": "shift"},
            {"id": "r", "capacity": 3},
        ],
        actions=[
            {
                "id": f"a{k}",
                "duration": rng.randint(1, 5),
                "due": rng.randint(1, 99),
                "breaks": "pause",
                "uses": [{"resource": "m", "family": rng.choice("fg")}, {"resource": "r"}],
            }
            for k in range(_SIZE)
        ],
        objective=["minimize_tardiness", "minimize_makespan"],
    )
