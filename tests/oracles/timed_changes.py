"""Timed changes of state, judged by trying everything: times, ranks, and which actions happen.

Written from docs/semantics.md, rule 6 with its timed changes, and rule 7.1, for tasks of a few
actions with whole durations, without resources, precedence or repetition. A change has a rank of
its own that no schedule says: here all of them are tried.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

Document = Mapping[str, Any]
Placing = Mapping[str, tuple[int, int]]
"""The start and the rank of each action that happens."""

Point = tuple[int, int]


def best_makespan(task: Document, horizon: int) -> int | None:
    """The least makespan of a valid schedule that ends by the horizon; None if there is none."""
    found: int | None = None
    for placing in _placings(task, horizon if found is None else found - 1):
        makespan = _makespan(task, placing)
        if (found is None or makespan < found) and holds(task, placing):
            found = makespan
    return found


def _placings(task: Document, horizon: int) -> Iterator[Placing]:
    actions = task["actions"]
    ranks = range(len(actions) + 2)
    choices: list[list[tuple[int, int] | None]] = []
    for action in actions:
        last = horizon - action["duration"]
        own: list[tuple[int, int] | None] = list(product(range(last + 1), ranks))
        if action.get("occurs") == "optional":
            own.append(None)
        choices.append(own)
    for chosen in product(*choices):
        yield {a["id"]: p for a, p in zip(actions, chosen, strict=True) if p is not None}


def _makespan(task: Document, placing: Placing) -> int:
    return max((placing[a["id"]][0] + a["duration"] for a in _present(task, placing)), default=0)


def _present(task: Document, placing: Placing) -> list[Document]:
    return [action for action in task["actions"] if action["id"] in placing]


def holds(task: Document, placing: Placing) -> bool:
    """Whether a placing is valid with some ranks of the timed changes."""
    last = _makespan(task, placing)
    changes = [
        (variable["id"], change["at"], change["value"])
        for variable in task["state"]
        for change in variable.get("changes", ())
        if change["at"] <= last
    ]
    ranks = range(-1, len(task["actions"]) + 3)
    return any(
        _plays(task, placing, list(zip(changes, own, strict=True)))
        for own in product(ranks, repeat=len(changes))
    )


def _plays(
    task: Document, placing: Placing, changes: Sequence[tuple[tuple[str, int, Any], int]]
) -> bool:
    reads: list[tuple[str, Point, str, Any]] = []
    writes: list[tuple[str, Point, str, Any]] = []
    spans: list[tuple[Point, Point, str, Any]] = []
    for (var, at, value), rank in changes:
        writes.append((f"{var} {at}", (at, rank), var, value))
    for action in _present(task, placing):
        name = action["id"]
        time, rank = placing[name]
        start, end = (time, rank), (time + action["duration"], rank)
        touched = set()
        for c in action.get("conditions", ()):
            touched.add(c["var"])
            if c["at"] == "all" and start != end:
                spans.append((start, end, c["var"], c["value"]))
            else:
                point = end if c["at"] == "end" else start
                reads.append((f"{name}{point}", point, c["var"], c["value"]))
        for e in action.get("effects", ()):
            touched.add(e["var"])
            point = end if e["at"] == "end" else start
            writes.append((f"{name}{point}", point, e["var"], e["value"]))
        for (var, at, _), own in changes:
            if var in touched and at == start[0] and start[1] < own:
                return False
    for one in writes:
        for other in (*writes, *reads):
            if one[1:3] == other[1:3] and one[0] != other[0]:
                return False
        if any(o[0] == one[0] and o[2] == one[2] and o[3] != one[3] for o in writes):
            return False
    world = {v["id"]: v.get("initial", False) for v in task["state"]}

    def before(point: Point, var: str) -> Any:
        earlier = [(p, value) for _, p, v, value in writes if v == var and p < point]
        return max(earlier)[1] if earlier else world[var]

    if any(before(point, var) != value for _, point, var, value in reads):
        return False
    for start, end, var, value in spans:
        if before((start[0], start[1] + 1), var) != value:
            return False
        if any(v == var and start < p < end and x != value for _, p, v, x in writes):
            return False
    final = (_makespan(task, placing) + 1, 0)
    return all(before(final, g["var"]) == g["value"] for g in task.get("goals", ()))


def random_task(rng: random.Random) -> dict[str, Any]:
    """Two or three actions that touch one or two variables, which the world changes, too."""
    variables = ["p", "q"][: rng.choice([1, 1, 2])]
    most = 2 if len(variables) == 1 else 1
    state = []
    for var in variables:
        times = sorted(rng.sample(range(5), rng.choice([0, 1, 1, 2][: most + 2])))
        state.append(
            {
                "id": var,
                "initial": rng.random() < 0.5,
                "changes": [{"at": t, "value": rng.random() < 0.5} for t in times],
            }
        )

    def facts(places: Sequence[str], most: int) -> list[dict[str, Any]]:
        found = {
            (rng.choice(places), rng.choice(variables)): rng.random() < 0.5
            for _ in range(rng.randint(0, most))
        }
        return [{"at": at, "var": var, "value": value} for (at, var), value in found.items()]

    actions = []
    for name in "ab"[: rng.choice([1, 2, 2])]:
        action: dict[str, Any] = {
            "id": name,
            "duration": rng.choice([0, 1, 2, 2, 3]),
            "conditions": facts(("start", "all", "end"), 2),
            "effects": facts(("start", "end"), 2),
        }
        if rng.random() < 0.3:
            action["occurs"] = "optional"
        actions.append(action)
    task: dict[str, Any] = {"state": state, "actions": actions}
    if rng.random() < 0.5:
        task["goals"] = [{"var": rng.choice(variables), "value": rng.random() < 0.5}]
    return task
