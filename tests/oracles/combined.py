"""Small random tasks that combine two or three features of the IR at a time.

A feature is a function that adds something to a document that already has a few plain actions. Each
seed draws two or three of them, so that every pair meets often, and few other things are in the
way. `document_with` draws a task with given features, such as each of `pairs`. Nearly all tasks are
small enough for `oracles.exhaustive`, which knows every feature.

A new element of the IR takes part with one entry of `FEATURES`; the deep tests and the benchmark
need nothing else. What seeds draw changes with it.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from itertools import combinations, pairwise
from typing import Any

Document = dict[str, Any]
Feature = Callable[[random.Random, Document], None]

_BOOLEANS = [False, True]


def combined_document(seed: int, most: int = 3) -> Document:
    """A task of 2 to 4 actions with 2 or `most` features; the same for the same seed."""
    rng = random.Random(f"combined {seed}")
    names = "abcd"[: rng.choice((2, 3, 3, 4))]
    actions = [{"id": name, "duration": rng.choice((0, 1, 2, 3))} for name in names]
    rng.shuffle(actions)
    document: Document = {"actions": actions}
    for name in rng.sample(sorted(FEATURES), rng.randint(2, most)):
        FEATURES[name](rng, document)
    return document


def features_of(seed: int, most: int = 3) -> list[str]:
    """The features that a seed draws."""
    rng = random.Random(f"combined {seed}")
    names = "abcd"[: rng.choice((2, 3, 3, 4))]
    for _ in names:
        rng.choice((0, 1, 2, 3))
    rng.shuffle(list(names))
    return rng.sample(sorted(FEATURES), rng.randint(2, most))


def pairs() -> list[tuple[str, ...]]:
    """Each feature alone, and every pair of features."""
    names = sorted(FEATURES)
    return [*((name,) for name in names), *combinations(names, 2)]


def document_with(features: Sequence[str], seed: int) -> Document:
    """A task of 2 to 4 actions with some features, in an order of the seed's own."""
    rng = random.Random(f"{sorted(features)} {seed}")
    names = "abcd"[: rng.choice((2, 3, 3, 3, 4))]
    document: Document = {
        "actions": [{"id": name, "duration": rng.choice((0, 1, 1, 2, 2, 3))} for name in names]
    }
    for name in rng.sample(sorted(features), len(features)):
        FEATURES[name](rng, document)
    if "deadline" not in document and rng.random() < 0.3:
        document["deadline"] = rng.randint(6, 12)
    return document


def _some(rng: random.Random, document: Document, chance: float = 0.5) -> list[Document]:
    """Some of the actions, at least one."""
    actions = document["actions"]
    return [a for a in actions if rng.random() < chance] or [rng.choice(actions)]


def _ranges(rng: random.Random, document: Document) -> None:
    for action in _some(rng, document):
        if "modes" not in action:
            least = rng.choice((0, 0, 1, 2))
            action["duration"] = {"min": least, "max": least + rng.randint(0, 2)}


def _unit(rng: random.Random, document: Document) -> None:
    """One resource that several actions use."""
    document.setdefault("resources", []).append({"id": "r", "capacity": rng.choice((1, 1, 2, 3))})
    for action in _some(rng, document, 0.7):
        uses = action.setdefault("uses", [])
        for _ in range(rng.choice((1, 1, 1, 2))):
            uses.append({"resource": "r", "amount": rng.choice((1, 1, 2))})


def _alternatives(rng: random.Random, document: Document) -> None:
    document.setdefault("resources", []).extend([{"id": "p"}, {"id": "q", "capacity": 2}])
    for action in _some(rng, document, 0.7):
        use: Document = rng.choice(
            ({"one_of": ["p", "q"]}, {"one_of": ["p", "q"]}, {"resource": "p"}, {"one_of": ["q"]})
        )
        if rng.random() < 0.2:
            use = {**use, "amount": 2}
        action.setdefault("uses", []).append(use)


def _calendar(rng: random.Random, document: Document) -> None:
    begin = rng.choice((0, 1, 2, 3))
    window = {"from": begin, "to": begin + rng.randint(1, 3), "capacity": rng.choice((0, 0, 1, 2))}
    document.setdefault("resources", []).append({"id": "k", "availability": [window]})
    for action in _some(rng, document, 0.6):
        action.setdefault("uses", []).append({"resource": "k"})


def _modes(rng: random.Random, document: Document) -> None:
    document.setdefault("resources", []).append({"id": "m"})
    for action in _some(rng, document, 0.4):
        duration = action.pop("duration", 1)
        slow = {"id": "slow", "duration": rng.choice((2, 3, duration))}
        quick = {"id": "quick", "duration": rng.choice((0, 1, {"min": 0, "max": 2}))}
        quick["uses"] = [{"resource": "m"}]
        action["modes"] = [slow, quick]


def _stock(rng: random.Random, document: Document) -> None:
    initial = rng.randint(0, 2)
    stock: Document = {"id": "s", "kind": "reservoir", "initial": initial}
    if rng.random() < 0.5:
        stock["max"] = initial + rng.randint(0, 2)
    if rng.random() < 0.2:
        stock["min"] = rng.randint(0, initial)
    document.setdefault("resources", []).append(stock)
    for action in _some(rng, document, 0.8):
        change: Document = {"resource": "s", "amount": rng.choice((1, 1, 2))}
        if rng.random() < 0.4:
            change["at"] = rng.choice(("start", "end"))
        action.setdefault(rng.choice(("consumes", "produces")), []).append(change)


def _state(rng: random.Random, document: Document) -> None:
    names = ["x", "y"][: rng.randint(1, 2)]
    for name in names:
        document.setdefault("state", []).append({"id": name, "initial": rng.random() < 0.5})
    for action in _some(rng, document, 0.8):
        for _ in range(rng.randint(1, 2)):
            fact = {"var": rng.choice(names), "value": rng.choice(_BOOLEANS)}
            if rng.random() < 0.5:
                at = rng.choice(("start", "all", "end"))
                action.setdefault("conditions", []).append({"at": at, **fact})
            else:
                at = rng.choice(("start", "end"))
                action.setdefault("effects", []).append({"at": at, **fact})
    if rng.random() < 0.3:
        document.setdefault("goals", []).append(
            {"var": rng.choice(names), "value": rng.choice(_BOOLEANS)}
        )


def _optional(rng: random.Random, document: Document) -> None:
    grouped = _grouped(document)
    for action in _some(rng, document, 0.6):
        if action["id"] not in grouped and "occurs" not in action:
            action["occurs"] = "optional"
    if rng.random() < 0.3:
        _goal(rng, document)


def _goal(rng: random.Random, document: Document) -> None:
    document.setdefault("goals", []).append(rng.choice(document["actions"])["id"])


def _repeats(rng: random.Random, document: Document) -> None:
    bound = {p for arc in document.get("precedence", ()) for p in (arc["before"], arc["after"])}
    bound |= _grouped(document) | {a["id"] for a in document["actions"] if "start" in a}
    free = [a for a in document["actions"] if a["id"] not in bound and "occurs" not in a]
    if free:
        least = rng.choice((0, 1, 2))
        rng.choice(free)["occurs"] = {"min": least, "max": rng.randint(max(1, least), 3)}


def _grouped(document: Document) -> set[str]:
    return {name for group in document.get("groups", ()) for name in group["actions"]}


def _groups(rng: random.Random, document: Document) -> None:
    names = [a["id"] for a in document["actions"] if "occurs" not in a]
    if not names:
        return
    rng.shuffle(names)
    cut = rng.randint(1, len(names))
    for k, members in enumerate((names[:cut], names[cut:])):
        if not members or (k and rng.random() < 0.5):
            continue
        group: Document = {"id": f"g{k}", "actions": members, "required": rng.random() < 0.3}
        if rng.random() < 0.3:
            group["reward"] = rng.randint(1, 4)
        if rng.random() < 0.2:
            group["deadline"] = rng.randint(2, 8)
        document.setdefault("groups", []).append(group)


def _arcs(rng: random.Random, document: Document) -> None:
    """Precedences of all types, minimum lags that may be negative, and maximum lags."""
    ids = _single(document)
    for _ in range(rng.randint(1, 3)):
        if len(ids) < 2:
            return
        before, after = rng.sample(ids, 2)
        arc: Document = {"before": before, "after": after}
        if rng.random() < 0.6:
            arc["type"] = rng.choice(
                ("finish-start", "start-start", "finish-finish", "start-finish")
            )
        if rng.random() < 0.5:
            arc["min_lag"] = rng.choice((-2, -1, 0, 1, 2))
        if rng.random() < 0.4:
            arc["max_lag"] = max(0, arc.get("min_lag", 0)) + rng.choice((0, 0, 1, 2))
        document.setdefault("precedence", []).append(arc)


def _single(document: Document) -> list[str]:
    """The actions that happen at most once."""
    return [a["id"] for a in document["actions"] if not isinstance(a.get("occurs"), dict)]


def _chain(rng: random.Random, document: Document) -> None:
    """Plain precedences; a cycle of them among optional actions keeps one of those out."""
    ids = _single(document)
    rng.shuffle(ids)
    pairs = list(pairwise(ids))
    if rng.random() < 0.2 and len(ids) > 1:
        pairs.append((ids[-1], ids[0]))
    for before, after in pairs:
        document.setdefault("precedence", []).append({"before": before, "after": after})


def _windows(rng: random.Random, document: Document) -> None:
    """Releases, deadlines, fixed and latest starts."""
    for action in _some(rng, document):
        kind = rng.choice(("release", "deadline", "start", "latest_start", "earliest_end"))
        if kind == "start" and isinstance(action.get("occurs"), dict):
            kind = "release"
        action[kind] = rng.randint(0, 4) + (3 if kind == "deadline" else 0)


def _deadline(rng: random.Random, document: Document) -> None:
    document["deadline"] = rng.randint(3, 9)


def _rewards(rng: random.Random, document: Document) -> None:
    for action in _some(rng, document):
        action["reward"] = rng.randint(1, 5)
    _objective(rng, document, "maximize_reward")


def _costs(rng: random.Random, document: Document) -> None:
    for action in _some(rng, document):
        action["cost"] = rng.randint(-1, 5)
    _objective(rng, document, "minimize_cost")


def _due(rng: random.Random, document: Document) -> None:
    for action in _some(rng, document):
        action["due"] = rng.randint(0, 5)
        if rng.random() < 0.3:
            action["weight"] = rng.randint(1, 3)
    _objective(rng, document, "minimize_tardiness")


def _objective(rng: random.Random, document: Document, name: str) -> None:
    objectives = document.get("objective", ["minimize_makespan"] if rng.random() < 0.6 else [])
    if name not in objectives:
        objectives.insert(rng.randint(0, len(objectives)), name)
    document["objective"] = objectives


def _fractions(rng: random.Random, document: Document) -> None:
    """Times that need a finer tick than one unit."""
    factor = rng.choice(("0.5", "1/3", "2.5"))
    for action in _some(rng, document, 0.4):
        if isinstance(action.get("duration"), int):
            action["duration"] = factor if rng.random() < 0.5 else f"{action['duration']}.5"


def _mode_elements(rng: random.Random, document: Document) -> None:
    """Costs, stock and state of modes."""
    document.setdefault("resources", []).append({"id": "n", "kind": "reservoir", "initial": 1})
    document.setdefault("state", []).append({"id": "mixed"})
    if not any("modes" in action for action in document["actions"]):
        _modes(rng, document)
    fact = {"var": "mixed", "value": rng.random() < 0.5}
    for action in document["actions"]:
        for mode in action.get("modes", ()):
            kind = rng.choice(("cost", "consumes", "produces", "conditions", "effects"))
            mode[kind] = {
                "cost": rng.randint(0, 3),
                "consumes": [{"resource": "n"}],
                "produces": [{"resource": "n"}],
                "conditions": [{"at": rng.choice(("start", "all", "end")), **fact}],
                "effects": [{"at": rng.choice(("start", "end")), "var": "mixed", "value": True}],
            }[kind]


def _numbers(rng: random.Random, document: Document) -> None:
    number: Document = {"id": "level", "kind": "number", "initial": rng.randint(0, 2), "min": 0}
    if rng.random() < 0.5:
        number["max"] = 3
    document.setdefault("state", []).append(number)
    for action in _some(rng, document, 0.7):
        if rng.random() < 0.5:
            test = {rng.choice(("at_least", "at_most", "equals")): rng.randint(0, 2)}
            at = rng.choice(("start", "all", "end"))
            action.setdefault("conditions", []).append({"at": at, "var": "level", **test})
        if rng.random() < 0.7:
            change = (
                {"set": rng.randint(0, 2)} if rng.random() < 0.2 else {"add": rng.choice((-1, 1))}
            )
            at = rng.choice(("start", "end"))
            action.setdefault("effects", []).append({"at": at, "var": "level", **change})
    if rng.random() < 0.2:
        document.setdefault("goals", []).append({"var": "level", "at_least": 1})


def _timed_changes(rng: random.Random, document: Document) -> None:
    times = sorted(rng.sample(range(6), rng.choice((1, 2))))
    changes = [{"at": time, "value": rng.random() < 0.5} for time in times]
    door = {"id": "door", "initial": rng.random() < 0.5, "changes": changes}
    document.setdefault("state", []).append(door)
    for action in _some(rng, document):
        condition = {"at": rng.choice(("start", "all", "end")), "var": "door"}
        action.setdefault("conditions", []).append({**condition, "value": rng.random() < 0.7})


def _set_ups(rng: random.Random, document: Document) -> None:
    ends = ("red", "blue", "*")
    rows = {(rng.choice(ends), rng.choice(ends)): rng.randint(0, 3) for _ in range(3)}
    times = [{"from": a, "to": b, "time": time} for (a, b), time in rows.items()]
    setups = {"times": times, **({"initial": "red"} if rng.random() < 0.5 else {})}
    document.setdefault("resources", []).append({"id": "press", "setups": setups})
    for action in _some(rng, document, 0.7):
        use = {"resource": "press", "family": rng.choice(("red", "blue"))}
        action.setdefault("uses", []).append(use)


def _pauses(rng: random.Random, document: Document) -> None:
    """A calendar in a cycle, which some actions keep clear of or pause at."""
    shift = {"from": rng.choice((0, 1)), "to": rng.choice((2, 3))}
    calendar = {"id": "shift", "every": 4, "open": [shift]}
    document.setdefault("calendars", []).append(calendar)
    for action in _some(rng, document):
        action["calendar"] = "shift"
        if rng.random() < 0.6:
            action["breaks"] = "pause"
            if rng.random() < 0.3:
                action["max_pause"] = rng.randint(1, 4)


def _orders(rng: random.Random, document: Document) -> None:
    """Uses one directly after another, or in one order on two resources."""
    document.setdefault("resources", []).extend([{"id": "o1"}, {"id": "o2"}])
    users = []
    for action in document["actions"]:
        if not isinstance(action.get("occurs"), dict) and rng.random() < 0.8:
            both = [{"resource": "o1"}, {"resource": "o2"}]
            chosen: list[Document] = rng.choice((both, both, both[:1], [{"one_of": ["o1", "o2"]}]))
            action.setdefault("uses", []).extend(chosen)
            users.append(action["id"])
    if len(users) < 2:
        return
    rule: Document = {"consecutive": rng.sample(users, 2), "resource": rng.choice(("o1", "o2"))}
    if rng.random() < 0.4:
        rule = {"same_order": ["o1", "o2"], "jobs": [[name, name] for name in users]}
        if len(users) > 3:
            rule["jobs"] = [users[:2], users[2:4]]
    document.setdefault("sequences", []).append(rule)


def _loads(rng: random.Random, document: Document) -> None:
    kiln: Document = {"id": "kiln", "kind": "batch", "capacity": rng.randint(1, 3)}
    if rng.random() < 0.3:
        begin = rng.randint(0, 3)
        kiln["availability"] = [{"from": begin, "to": begin + 2, "capacity": rng.randint(0, 2)}]
    document.setdefault("resources", []).append(kiln)
    for action in _some(rng, document, 0.8):
        use: Document = {"resource": "kiln"}
        if rng.random() < 0.5:
            use["family"] = rng.choice(("red", "blue"))
        action.setdefault("uses", []).append(use)


def _selections(rng: random.Random, document: Document) -> None:
    free = [
        a for a in document["actions"] if "occurs" not in a and a["id"] not in _grouped(document)
    ]
    for action in free:
        action["occurs"] = "optional"
    names = [action["id"] for action in free]
    if names:
        count = rng.randint(0, len(names))
        rule: Document = rng.choice(({"min": count}, {"max": count}, {"all_or_none": True}))
        document.setdefault("select", []).append({"actions": names, **rule})


def _couplings(rng: random.Random, document: Document) -> None:
    document.setdefault("resources", []).extend([{"id": "c1"}, {"id": "c2"}])
    names = []
    for action in document["actions"]:
        if not isinstance(action.get("occurs"), dict):
            action.setdefault("uses", []).append({"one_of": ["c1", "c2"]})
            names.append({"action": action["id"], "use": len(action["uses"]) - 1})
    if len(names) > 1:
        kind = rng.choice(("same", "different"))
        rule = {kind: "resource", "actions": rng.sample(names, 2)}
        document.setdefault("couplings", []).append(rule)


def _shifts(rng: random.Random, document: Document) -> None:
    """A resource with a calendar, at whose closed times some of its users pause."""
    first = rng.randint(0, 2)
    cycle: Document = {"id": "hours", "every": 5, "open": [{"from": first, "to": first + 2}]}
    if rng.random() < 0.3:
        cycle["open"].append({"from": first + 3, "to": first + 3 + rng.choice((1, 2)) - 5})
        cycle["open"][1]["from"] %= 5
        cycle["open"][1]["to"] %= 5
    if rng.random() < 0.3:
        cycle["closed"] = [{"from": rng.randint(0, 3), "to": rng.randint(4, 6)}]
    document.setdefault("calendars", []).append(cycle)
    crew: Document = {"id": "crew", "calendar": "hours", "capacity": rng.choice((1, 1, 2))}
    if rng.random() < 0.2:
        crew["availability"] = [{"from": 2, "to": 4, "capacity": rng.randint(0, 2)}]
    document.setdefault("resources", []).append(crew)
    for action in _some(rng, document, 0.6):
        action.setdefault("uses", []).append({"resource": "crew"})
        if rng.random() < 0.6:
            action["breaks"] = "pause"
            if rng.random() < 0.2:
                action["max_pause"] = rng.randint(0, 4)


def _no_idle(rng: random.Random, document: Document) -> None:
    document.setdefault("resources", []).append({"id": "belt", "no_idle": True})
    for action in _some(rng, document, 0.8):
        action.setdefault("uses", []).append({"resource": "belt"})
    if rng.random() < 0.5:
        rng.choice(document["actions"])["release"] = rng.randint(1, 4)


_DATED = ("tardiness", "tardy", "max_tardiness", "earliness", "flow_time", "makespan", "cost")


def _objectives(rng: random.Random, document: Document) -> None:
    """Objectives on due dates, and sums of several."""
    for action in _some(rng, document, 0.7):
        action["due"] = rng.randint(-2, 7)
        if rng.random() < 0.4:
            action["weight"] = rng.randint(0, 3)
    for group in document.get("groups", ()):
        if rng.random() < 0.5:
            group["due"] = rng.randint(0, 7)
    names = [f"minimize_{name}" for name in rng.sample(_DATED, 3)]
    levels: list[Any] = names[:2]
    if rng.random() < 0.4:
        levels = [{"sum": [[rng.randint(1, 3), name] for name in names[:2]]}, names[2]]
    document["objective"] = levels[: rng.choice((1, 2))]


def _setup_objectives(rng: random.Random, document: Document) -> None:
    """The time or the cost of the set-ups of a resource is to be small."""
    rows = [
        {"from": a, "to": b, "time": rng.randint(0, 2), "cost": rng.randint(0, 3)}
        for a, b in (("oak", "elm"), ("elm", "oak"), ("*", "oak"))
    ]
    saw = {"id": "saw", "setups": {"times": rows[: rng.randint(1, 3)]}}
    if rng.random() < 0.4:
        saw["setups"] |= {"initial": rng.choice(("oak", "elm"))}
    document.setdefault("resources", []).append(saw)
    for action in _some(rng, document, 0.8):
        use: Document = {"resource": "saw"}
        if rng.random() < 0.9:
            use["family"] = rng.choice(("oak", "elm"))
        action.setdefault("uses", []).append(use)
    _objective(rng, document, f"minimize_setup_{rng.choice(('time', 'cost'))}")


def _choices(rng: random.Random, document: Document) -> None:
    """Modes that depend on modes or resources of others."""
    document.setdefault("resources", []).extend([{"id": "d1"}, {"id": "d2"}])
    able = [a for a in document["actions"] if not isinstance(a.get("occurs"), dict)]
    for action in able:
        if "modes" not in action and rng.random() < 0.8:
            duration = action.pop("duration", 1)
            action["modes"] = [
                {"id": "fast", "duration": rng.randint(0, 2), "uses": [{"one_of": ["d1", "d2"]}]},
                {"id": "slow", "duration": duration, "cost": rng.randint(0, 2)},
            ]
    chosen = [a for a in able if "modes" in a]
    if len(chosen) < 2:
        return
    one, other = rng.sample(chosen, 2)
    kind = rng.choice(("same", "different", "if"))
    rule: Document = {kind: "mode", "actions": [one["id"], other["id"]]}
    if kind == "if":
        made = [{"action": a["id"], "mode": rng.choice(a["modes"])["id"]} for a in (one, other)]
        if rng.random() < 0.4:
            made[1] = {"action": other["id"], "resource": rng.choice(("d1", "d2"))}
        rule = {"if": made[0], "then": made[1]}
    document.setdefault("couplings", []).append(rule)


def _resolution(rng: random.Random, document: Document) -> None:
    document["resolution"] = rng.choice(("1/6", "1/12"))


FEATURES: dict[str, Feature] = {
    "ranges": _ranges,
    "unit": _unit,
    "alternatives": _alternatives,
    "calendar": _calendar,
    "modes": _modes,
    "stock": _stock,
    "state": _state,
    "optional": _optional,
    "repeats": _repeats,
    "groups": _groups,
    "arcs": _arcs,
    "chain": _chain,
    "windows": _windows,
    "deadline": _deadline,
    "rewards": _rewards,
    "costs": _costs,
    "due": _due,
    "fractions": _fractions,
    "mode elements": _mode_elements,
    "numbers": _numbers,
    "timed changes": _timed_changes,
    "set-ups": _set_ups,
    "pauses": _pauses,
    "resolution": _resolution,
    "orders": _orders,
    "loads": _loads,
    "selections": _selections,
    "couplings": _couplings,
    "shifts": _shifts,
    "no idle": _no_idle,
    "objectives": _objectives,
    "set-up objectives": _setup_objectives,
    "choices": _choices,
}
"""What a task can have, by name."""
