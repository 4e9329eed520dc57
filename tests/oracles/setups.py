"""Exact optima of small tasks with set-ups, by trying everything.

Written from docs/semantics.md, rules 1 to 4 and the objectives, for tasks of a few actions with
whole times: which optional actions are present, their modes, the resources that they take, whether
a range that begins at 0 is used at all, and the order on each resource. Each of these choices
leaves lower bounds between points in time, of which the least solution is the best for every
objective that looks at ends. Set-ups depend on the order alone.

Known: durations fixed or in a range, `optional`, modes, `one_of`, families, resources of capacity 1
with windows of capacity 0 or without idle time, all precedences and lags, releases, latest starts,
deadlines, due dates.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations, product
from typing import Any

Document = Mapping[str, Any]

_HORIZON = 400


@dataclass(frozen=True)
class Way:
    """One way to carry out an action: the bounds of its duration, and a family by resource."""

    name: str
    least: int
    most: int
    held: tuple[tuple[str, str | None], ...]
    action: Document
    mode: str | None = None


def best(task: Document) -> tuple[int, ...] | None:
    """The best values of the task's objectives, in order (a reward counts negative); None: none."""
    found: tuple[int, ...] | None = None
    for ways in _selections(task):
        for orders in _orders(ways):
            value = _value(task, ways, orders)
            if value is not None and (found is None or value < found):
                found = value
    return found


def setup_of(resource: Document, before: str | None, after: str | None) -> tuple[int, int]:
    """The time and cost of a set-up: the row that names most, the family before before the one
    after."""
    rows = {(r["from"], r["to"]): r for r in resource["setups"].get("times", ())}
    if before == after:
        named = [] if before is None else [(before, after)]
    else:
        named = [(before, after), (before, "*"), ("*", after), ("*", "*")]
    for key in named:
        if key in rows:
            return rows[key].get("time", 0), rows[key].get("cost", 0)
    return 0, 0


# --- choices ------------------------------------------------------------------------------------


def _selections(task: Document) -> Iterator[list[Way]]:
    options: list[list[Way | None]] = []
    for action in task["actions"]:
        own: list[Way | None] = list(_ways(action))
        if action.get("occurs") == "optional":
            own.append(None)
        options.append(own)
    for chosen in product(*options):
        yield [way for way in chosen if way is not None]


def _ways(action: Document) -> Iterator[Way]:
    modes = action.get("modes") or [{"id": None, "duration": action.get("duration")}]
    for mode in modes:
        duration = mode["duration"]
        low, high = (
            (duration["min"], duration["max"]) if isinstance(duration, dict) else (duration,) * 2
        )
        uses = [*action.get("uses", ()), *mode.get("uses", ())]
        for taken in product(*(u.get("one_of") or [u["resource"]] for u in uses)):
            held = tuple((r, u.get("family")) for r, u in zip(taken, uses, strict=True))
            if len({r for r, _ in held}) < len(held) and high > 0:
                # Twice the same unit: only without a length.
                if low == 0:
                    yield Way(action["id"], 0, 0, held, action, mode["id"])
                continue
            if low == 0:
                yield Way(action["id"], 0, 0, held, action, mode["id"])
                low_used = 1
            else:
                low_used = low
            if high >= low_used:
                yield Way(action["id"], low_used, high, held, action, mode["id"])


def _orders(ways: Sequence[Way]) -> Iterator[dict[str, tuple[Way, ...]]]:
    users: dict[str, list[Way]] = {}
    for way in ways:
        for resource, _ in way.held:
            if way.most > 0:
                users.setdefault(resource, []).append(way)
    names = sorted(users)
    for chosen in product(*(permutations(users[name]) for name in names)):
        yield dict(zip(names, chosen, strict=True))


# --- the least times ----------------------------------------------------------------------------


def _value(
    task: Document, ways: Sequence[Way], orders: Mapping[str, Sequence[Way]]
) -> tuple[int, ...] | None:
    time = cost = 0
    gaps: list[tuple[str | None, str, int, bool]] = []
    for resource in task.get("resources", ()):
        before: Way | None = None
        for way in orders.get(resource["id"], ()):
            gap = 0
            if "setups" in resource:
                family = dict(way.held)[resource["id"]]
                if before is not None:
                    of = dict(before.held)[resource["id"]]
                    gap, price = setup_of(resource, of, family)
                elif "initial" in resource["setups"]:
                    gap, price = setup_of(resource, resource["setups"]["initial"], family)
                else:
                    price = 0
                time, cost = time + gap, cost + price
            idle = not resource.get("no_idle", False)
            gaps.append((None if before is None else before.name, way.name, gap, idle))
            before = way
    spans = _least(task, ways, gaps)
    if spans is None or not _keeps_limits(task, ways, spans):
        return None
    return _values(task, ways, spans, time, cost)


def _least(
    task: Document, ways: Sequence[Way], gaps: Sequence[tuple[str | None, str, int, bool]]
) -> dict[str, tuple[int, int]] | None:
    start = {w.name: max(0, w.action.get("release", 0), w.action.get("start", 0)) for w in ways}
    end = {w.name: start[w.name] + w.least for w in ways}
    closed = {
        r["id"]: [(w["from"], w["to"]) for w in r.get("availability", ()) if w["capacity"] == 0]
        for r in task.get("resources", ())
    }
    arcs = [a for a in task.get("precedence", ()) if {a["before"], a["after"]} <= start.keys()]
    while True:
        before = dict(start), dict(end)
        for way in ways:
            name = way.name
            end[name] = max(end[name], start[name] + way.least)
            start[name] = max(start[name], end[name] - way.most)
            for resource, _ in way.held:
                for begin, until in closed[resource]:
                    if start[name] < until and begin < end[name] and start[name] < end[name]:
                        start[name] = until
        for first, name, gap, idle in gaps:
            start[name] = max(start[name], gap + (0 if first is None else end[first]))
            if first is not None and not idle:
                end[first] = max(end[first], start[name] - gap)
        for arc in arcs:
            of, to = arc.get("type", "finish-start").split("-")
            tail = end if of == "finish" else start
            head = end if to == "finish" else start
            a, b = arc["before"], arc["after"]
            head[b] = max(head[b], tail[a] + arc.get("min_lag", 0))
            if arc.get("max_lag") is not None:
                tail[a] = max(tail[a], head[b] - arc["max_lag"])
        if (start, end) == before:
            return {name: (start[name], end[name]) for name in start}
        if max(end.values()) > _HORIZON:
            return None


def _keeps_limits(
    task: Document, ways: Sequence[Way], spans: Mapping[str, tuple[int, int]]
) -> bool:
    for way in ways:
        start, end = spans[way.name]
        limits = [limit for limit in (way.action.get("deadline"), task.get("deadline")) if limit]
        if any(end > limit for limit in limits):
            return False
        if start > way.action.get("latest_start", start):
            return False
        if start > way.action.get("start", start):
            return False
    return True


def _values(
    task: Document,
    ways: Sequence[Way],
    spans: Mapping[str, tuple[int, int]],
    time: int,
    cost: int,
) -> tuple[int, ...]:
    late = sum(
        w.action.get("weight", 1) * max(0, spans[w.name][1] - w.action["due"])
        for w in ways
        if "due" in w.action
    )
    values = {
        "minimize_makespan": max((end for _, end in spans.values()), default=0),
        "minimize_tardiness": late,
        "maximize_reward": -sum(w.action.get("reward", 0) for w in ways),
        "minimize_cost": sum(w.action.get("cost", 0) for w in ways),
        "minimize_setup_time": time,
        "minimize_setup_cost": cost,
    }
    named = task.get("objective", ["minimize_makespan"])
    return tuple(
        values[level]
        if isinstance(level, str)
        else sum(weight * values[name] for weight, name in level["sum"])
        for level in ([named] if isinstance(named, (str, dict)) else named)
    )


# --- random tasks -------------------------------------------------------------------------------

_FAMILIES = ("red", "blue", "green")


def random_task(rng: random.Random) -> dict[str, Any]:
    """A task of 2 to 5 actions on resources with set-ups, with some other elements of the IR."""
    names = "abcde"[: rng.choice((2, 3, 3, 4, 4, 5))]
    resources = [_random_resource(rng, name) for name in "mn"[: rng.choice((1, 1, 2))]]
    if rng.random() < 0.2:
        resources.append({"id": "p"})
    actions = [_random_action(rng, name, resources) for name in names]
    task: dict[str, Any] = {"resources": resources, "actions": actions}
    if rng.random() < 0.5:
        task["precedence"] = [_random_arc(rng, names) for _ in range(rng.randint(1, 2))]
    if rng.random() < 0.15:
        task["deadline"] = rng.randint(8, 25)
    objectives = ["minimize_makespan", "minimize_setup_time", "minimize_setup_cost"]
    objectives += ["minimize_tardiness"] * any("due" in a for a in actions)
    objectives += ["maximize_reward"] * any("reward" in a for a in actions)
    task["objective"] = rng.sample(objectives, rng.randint(1, len(objectives)))
    if any("reward" in a for a in actions) and "maximize_reward" not in task["objective"]:
        task["objective"].insert(0, "maximize_reward")
    for resource in resources:
        if rng.random() < 0.2:
            resource["no_idle"] = True
    return task


def _random_resource(rng: random.Random, name: str) -> dict[str, Any]:
    ends = [(a, b) for a in (*_FAMILIES, "*") for b in (*_FAMILIES, "*")]
    rows = []
    for before, after in rng.sample(ends, rng.randint(1, 8)):
        row: dict[str, Any] = {"from": before, "to": after, "time": rng.randint(0, 6)}
        if rng.random() < 0.5:
            row["cost"] = rng.randint(0, 4)
        rows.append(row)
    resource: dict[str, Any] = {"id": name, "setups": {"times": rows}}
    if rng.random() < 0.5:
        resource["setups"]["initial"] = rng.choice(("red", "blue", "clean"))
    if rng.random() < 0.25:
        begin = rng.randint(0, 8)
        window = {"from": begin, "to": begin + rng.randint(1, 4), "capacity": 0}
        resource["availability"] = [window]
    return resource


def _random_action(rng: random.Random, name: str, resources: Sequence[Document]) -> dict[str, Any]:
    action: dict[str, Any] = {"id": name}
    use = _random_use(rng, resources)
    if rng.random() < 0.2:
        other = _random_use(rng, resources)
        action["modes"] = [
            {"id": "one", "duration": _random_duration(rng), "uses": [use]},
            {"id": "two", "duration": _random_duration(rng), "uses": [other]},
        ]
    else:
        action["duration"] = _random_duration(rng)
        if rng.random() < 0.95:
            action["uses"] = [use]
    if rng.random() < 0.2:
        action["occurs"] = "optional"
        action["reward"] = rng.randint(0, 3)
    if rng.random() < 0.4:
        action["due"] = rng.randint(1, 12)
        action["weight"] = rng.randint(1, 3)
    kind = rng.choice(("release", "latest_start", "deadline", None, None, None, None))
    if kind is not None:
        action[kind] = rng.randint(1, 5) + (0 if kind == "release" else 8)
    return action


def _random_duration(rng: random.Random) -> Any:
    if rng.random() < 0.2:
        least = rng.randint(0, 2)
        return {"min": least, "max": least + rng.randint(0, 3)}
    return rng.choice((0, 1, 2, 3, 4))


def _random_use(rng: random.Random, resources: Sequence[Document]) -> dict[str, Any]:
    ids = [r["id"] for r in resources]
    use: dict[str, Any] = {"resource": rng.choice(ids)}
    if len(ids) > 1 and rng.random() < 0.5:
        use = {"one_of": rng.sample(ids, 2)}
    if rng.random() < 0.9:
        use["family"] = rng.choice(_FAMILIES)
    return use


def _random_arc(rng: random.Random, names: str) -> dict[str, Any]:
    before, after = rng.sample(names, 2)
    arc: dict[str, Any] = {"before": before, "after": after}
    if rng.random() < 0.4:
        arc["type"] = rng.choice(("start-start", "finish-finish", "start-finish"))
    if rng.random() < 0.5:
        arc["min_lag"] = rng.choice((-1, 0, 1, 2))
    if rng.random() < 0.3:
        arc["max_lag"] = max(0, arc.get("min_lag", 0)) + rng.randint(0, 8)
    return arc
