"""Random tasks with state, choices, stock, calendars and rewards; the same for the same seed.

Small ones are for `oracles.state_brute_force`; `reward_task`, and the larger of `crowded_task`,
are beyond it and meant for comparing solvers with each other.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import Any

from irc.model import Task
from irc.model.canonical import written_task

Document = dict[str, Any]

MIXES: Mapping[str, frozenset[str]] = {
    "state": frozenset(),
    "ranges": frozenset({"ranges", "lags"}),
    "stock": frozenset({"stock"}),
    "choices": frozenset({"modes", "resources", "calendars"}),
    "orders": frozenset({"groups", "due", "resources"}),
    "rewards": frozenset({"groups", "rewards", "stock", "deadline"}),
    "repeats": frozenset({"repeats", "resources", "stock"}),
    "everything": frozenset(
        [
            *("ranges", "lags", "stock", "modes", "resources", "calendars"),
            *("groups", "due", "rewards", "repeats", "deadline"),
        ]
    ),
}
"""What random state tasks have besides state; the seed picks one of these."""

_VALUES: tuple[list[Any], ...] = (
    [False, True],
    [False, True],
    ["raw", "cooked", "served"],
    ["left", "right"],
)


@dataclass
class _Draft:
    """A task in the making, and the world after its actions so far, done one after another."""

    features: frozenset[str]
    values: dict[str, list[Any]] = field(default_factory=dict)
    world: dict[str, Any] = field(default_factory=dict)
    levels: dict[str, int] = field(default_factory=dict)
    state: list[Document] = field(default_factory=list)
    resources: list[Document] = field(default_factory=list)
    actions: list[Document] = field(default_factory=list)
    precedence: list[Document] = field(default_factory=list)
    skipped: set[str] = field(default_factory=set)


def state_task(seed: int) -> Task:
    """At most 6 actions, 4 variables; conditions are mostly such that some schedule meets them."""
    rng = random.Random(f"state {seed}")
    draft = _Draft(list(MIXES.values())[seed % len(MIXES)])
    _draw_world(rng, draft)
    # Modes and repetitions multiply what the oracle has to look at.
    most = (5 if "groups" in draft.features else 6, 4, 3)[
        len(draft.features & {"repeats", "modes"})
    ]
    for i in range(rng.randint(2, most)):
        _draw_action(rng, draft, i)
    document: Document = {
        "resources": draft.resources,
        "state": draft.state,
        "actions": draft.actions,
        "precedence": draft.precedence,
        "goals": _draw_goals(rng, draft),
        "groups": _draw_groups(rng, draft),
        "objective": _draw_objective(rng, draft),
    }
    total = sum(_longest(action) for action in draft.actions)
    if "deadline" in draft.features or rng.random() < 0.15:
        document["deadline"] = max(1, rng.randint(total // 2, total + 3))
    for part in ("actions", "precedence", "groups", "state", "goals"):
        rng.shuffle(document[part])
    # (Last of all, so that a seed draws all else as it did before there were any.)
    for action in draft.actions:
        if rng.random() < 0.08:
            action["latest_start"] = rng.randint(0, 9)
    return Task.model_validate({key: part for key, part in document.items() if part})


def number_task(seed: int, mix: str | None = None) -> Task:
    """A random state task (see `state_task`) of fewer actions, which also touch some numbers.

    `mix` is one of `MIXES`; without it the seed picks one.
    """
    rng = random.Random(f"numbers {seed}")
    k = list(MIXES).index(mix) if mix is not None else seed % len(MIXES)
    document = written_task(state_task(seed * len(MIXES) + k))
    actions = document["actions"][:5]
    kept = {action["id"] for action in actions}
    document["actions"] = actions
    document["precedence"] = [
        arc for arc in document.get("precedence", ()) if {arc["before"], arc["after"]} <= kept
    ]
    groups = [g for g in document.get("groups", ()) if kept.issuperset(g["actions"])]
    document["groups"] = groups
    document["goals"] = [
        g for g in document.get("goals", ()) if not isinstance(g, str) or g in kept
    ]
    if rng.random() < 0.6:
        # Numbers alone, so that other state does not keep everything apart.
        document["state"], document["goals"] = [], []
        for action in actions:
            action.pop("conditions", None)
            action.pop("effects", None)
    numbers = [_draw_number(rng, f"n{i + 1}") for i in range(rng.choice((1, 1, 2)))]
    document["state"] = [*document.get("state", ()), *numbers]
    unit = rng.choice((1, 1, 1, Fraction(1, 2)))
    world = {number["id"]: number["initial"] for number in numbers}
    for action in sorted(actions, key=lambda action: rng.random()):
        _draw_levels(rng, action, numbers, world, unit)
    for name, level in world.items():
        if rng.random() < 0.4:
            document["goals"].append({"var": name, **_draw_test(rng, level, unit)})
    return Task.model_validate({key: part for key, part in document.items() if part})


def _draw_number(rng: random.Random, name: str) -> Document:
    number: Document = {"id": name, "kind": "number", "initial": rng.randint(0, 3)}
    if rng.random() < 0.7:
        number["min"] = number["initial"] - rng.randint(0, 3)
    if rng.random() < 0.6:
        number["max"] = number["initial"] + rng.randint(0, 3)
    return number


def _draw_test(rng: random.Random, level: Any, unit: Any) -> Document:
    """A test, which a level mostly meets."""
    if rng.random() < 0.12:
        level += unit * rng.choice((-1, 1))
    kind = rng.choice(("at_least", "at_least", "at_most", "at_most", "equals", "both"))
    if kind == "both":
        return {"at_least": level - unit * rng.randint(0, 1), "at_most": level + unit}
    slack = 0 if kind == "equals" else unit * rng.randint(0, 1)
    return {kind: level - slack if kind == "at_least" else level + slack}


def _draw_levels(
    rng: random.Random, action: Document, numbers: list[Document], world: dict[str, Any], unit: Any
) -> None:
    """Conditions on numbers, and changes of them; `world` becomes what the action leaves behind."""
    for number in numbers:
        name = number["id"]
        part = action
        if action.get("modes") and "occurs" not in action and rng.random() < 0.5:
            part = rng.choice(action["modes"])
        steps = [("ask", "start", 0.3), ("give", "start", 0.3), ("ask", "all", 0.2)]
        steps += [("ask", "end", 0.1), ("give", "end", 0.45)]
        level = world[name]
        for step, at, chance in steps:
            if rng.random() > chance:
                continue
            if step == "ask":
                condition = {"at": at, "var": name, **_draw_test(rng, level, unit)}
                part.setdefault("conditions", []).append(condition)
                continue
            amount = unit * rng.choice((-2, -1, -1, 1, 1, 2))
            inside = number.get("min", -99) <= level + amount <= number.get("max", 99)
            if not inside and rng.random() < 0.85:
                amount = -amount
            inside = number.get("min", -99) <= level + amount <= number.get("max", 99)
            sets = rng.random() < 0.2 and inside
            effect = {"set": level + amount} if sets else {"add": amount}
            part.setdefault("effects", []).append({"at": at, "var": name, **effect})
            level += amount
        if "occurs" not in action or rng.random() < 0.5:
            world[name] = level


def _draw_world(rng: random.Random, draft: _Draft) -> None:
    for i in range(rng.randint(1, 4)):
        name, values = f"v{i + 1}", rng.choice(_VALUES)
        draft.values[name], draft.world[name] = values, rng.choice(values)
        draft.state.append({"id": name, "values": values, "initial": draft.world[name]})
    if "stock" in draft.features:
        initial = rng.randint(0, 3)
        stock: Document = {"id": "flour", "kind": "reservoir", "initial": initial}
        if rng.random() < 0.4:
            stock["max"] = initial + rng.randint(0, 2)
        if rng.random() < 0.2:
            stock["min"] = rng.randint(-1, min(initial, 1))
        draft.levels["flour"] = initial
        draft.resources.append(stock)
    if "resources" in draft.features:
        draft.resources.append({"id": "oven", "capacity": rng.choice((1, 1, 2))})
        draft.resources += [{"id": "ann"}, {"id": "bob"}]
    if "calendars" in draft.features:
        begin = rng.randint(0, 4)
        window = {"from": begin, "to": begin + rng.randint(1, 3), "capacity": rng.choice((0, 0, 2))}
        draft.resources[-1 - 2]["availability"] = [window]


def _draw_action(rng: random.Random, draft: _Draft, i: int) -> None:
    """One more action; its conditions mostly hold in the world as the ones before leave it."""
    action: Document = {"id": f"a{i + 1}", "duration": rng.choice((0, 1, 1, 2, 2, 3, 4))}
    if "ranges" in draft.features and rng.random() < 0.4:
        least = rng.choice((0, 0, 1, 2))
        action["duration"] = {"min": least, "max": least + rng.randint(1, 2)}
    _draw_occurs(rng, draft, action)
    world = dict(draft.world)
    conditions, effects = _draw_state(rng, draft, world)
    if isinstance(action.get("occurs"), dict) and rng.random() < 0.5:
        # Its own effects would often keep it from happening again.
        conditions = []
    if conditions:
        action["conditions"] = conditions
    if effects:
        action["effects"] = effects
    if action["id"] not in draft.skipped:
        draft.world = world
    _draw_stock(rng, draft, action)
    _draw_use(rng, draft, action)
    _draw_arcs(rng, draft, action)
    _draw_dates(rng, draft, action)
    if "modes" in draft.features and rng.random() < 0.4:
        _split_into_modes(rng, draft, action)
    draft.actions.append(action)


def _draw_occurs(rng: random.Random, draft: _Draft, action: Document) -> None:
    if rng.random() < 0.25:
        action["occurs"] = "optional"
    elif "repeats" in draft.features and rng.random() < 0.5:
        least = rng.choice((0, 1, 2))
        action["occurs"] = {"min": least, "max": rng.randint(max(1, least), 3 if not least else 2)}
    if "occurs" in action and rng.random() < 0.4:
        draft.skipped.add(action["id"])


def _draw_state(
    rng: random.Random, draft: _Draft, world: dict[str, Any]
) -> tuple[list[Document], list[Document]]:
    """Conditions and effects; `world` becomes what the action leaves behind."""
    conditions: list[Document] = []
    effects: list[Document] = []
    names = list(draft.values)

    def ask(at: str) -> None:
        var = rng.choice(names)
        value = world[var] if rng.random() < 0.88 else rng.choice(draft.values[var])
        conditions.append({"at": at, "var": var, "value": value})

    def give(at: str) -> None:
        var = rng.choice(names)
        value = rng.choice(draft.values[var])
        if all((e["at"], e["var"]) != (at, var) for e in effects):
            effects.append({"at": at, "var": var, "value": value})
            world[var] = value

    for chance, step, at in (
        (0.55, ask, "start"),
        (0.4, give, "start"),
        (0.4, ask, "all"),
        (0.15, ask, "end"),
        (0.6, give, "end"),
        (0.2, give, "end"),
    ):
        if rng.random() < chance:
            step(at)
    return conditions, effects


def _draw_stock(rng: random.Random, draft: _Draft, action: Document) -> None:
    if "stock" not in draft.features or rng.random() < 0.4:
        return
    repeats = isinstance(action.get("occurs"), dict)
    takes = rng.random() < (0.2 if repeats else 0.55)
    amount = rng.randint(1, 3 if takes and "repeats" in draft.features else 2)
    change: Document = {"resource": "flour", "amount": amount}
    if rng.random() < 0.3:
        change["at"] = rng.choice(("start", "end"))
    action["consumes" if takes else "produces"] = [change]


def _draw_use(rng: random.Random, draft: _Draft, action: Document) -> None:
    if "resources" not in draft.features:
        return
    uses: list[Document] = []
    if rng.random() < 0.6:
        uses.append({"resource": "oven"})
    if rng.random() < 0.4:
        uses.append({"one_of": ["ann", "bob"]})
    if uses:
        action["uses"] = uses


def _draw_arcs(rng: random.Random, draft: _Draft, action: Document) -> None:
    chance = 0.6 if "lags" in draft.features else 0.2
    single = [a["id"] for a in draft.actions if not isinstance(a.get("occurs"), dict)]
    if isinstance(action.get("occurs"), dict) or not single or rng.random() > chance:
        return
    arc: Document = {"before": rng.choice(single), "after": action["id"]}
    if "lags" in draft.features:
        kinds = ("finish-start", "finish-start", "start-start", "finish-finish", "start-finish")
        arc["type"] = rng.choice(kinds)
        arc["min_lag"] = rng.choice((0, 0, 0, 1, 2, -1, -2))
        if rng.random() < 0.3:
            arc["max_lag"] = arc["min_lag"] + rng.randint(0, 3)
    draft.precedence.append(arc)


def _draw_dates(rng: random.Random, draft: _Draft, action: Document) -> None:
    if rng.random() < 0.12:
        action["release"] = rng.randint(1, 4)
    elif rng.random() < 0.05 and not isinstance(action.get("occurs"), dict):
        action["start"] = rng.randint(0, 5)
    if rng.random() < 0.08:
        action["deadline"] = rng.randint(4, 14)
    if "due" in draft.features and rng.random() < 0.6:
        action["due"] = rng.randint(0, 7)
        if rng.random() < 0.5:
            action["weight"] = rng.randint(0, 3)
    if "rewards" in draft.features and rng.random() < 0.6:
        action["reward"] = rng.randint(-1, 6)
    if "rewards" in draft.features and rng.random() < 0.6:
        action["cost"] = rng.randint(0, 5)


def _split_into_modes(rng: random.Random, draft: _Draft, action: Document) -> None:
    duration = action.pop("duration")
    hasty: Document = {"id": "hasty", "duration": 1}
    if "resources" in draft.features:
        hasty["uses"] = [{"resource": rng.choice(("ann", "bob"))}]
    action["modes"] = [{"id": "steady", "duration": duration}, hasty]


def _draw_goals(rng: random.Random, draft: _Draft) -> list[Any]:
    goals: list[Any] = []
    for var, values in draft.values.items():
        if rng.random() < 0.5:
            value = draft.world[var] if rng.random() < 0.85 else rng.choice(values)
            goals.append({"var": var, "value": value})
    optional = [a["id"] for a in draft.actions if "occurs" in a]
    if optional and rng.random() < 0.15:
        goals.append(rng.choice(optional))
    return goals


def _draw_groups(rng: random.Random, draft: _Draft) -> list[Document]:
    if "groups" not in draft.features:
        return []
    free = [a for a in draft.actions if not isinstance(a.get("occurs"), dict)]
    rng.shuffle(free)
    groups: list[Document] = []
    while free and len(groups) < 2:
        members, free = free[: rng.randint(1, 2)], free[2:]
        group: Document = {"id": f"g{len(groups) + 1}", "actions": [a["id"] for a in members]}
        if rng.random() < 0.75:
            group["required"] = False
            for member in members:
                member.pop("occurs", None)
        if rng.random() < 0.6:
            group["reward"] = rng.randint(1, 9)
        if rng.random() < 0.25:
            group["deadline"] = rng.randint(3, 12)
        if "due" in draft.features and rng.random() < 0.6:
            group.update(due=rng.randint(0, 8), weight=rng.randint(0, 3))
        groups.append(group)
    return groups


def _draw_objective(rng: random.Random, draft: _Draft) -> list[str]:
    names = ["minimize_makespan"]
    if "due" in draft.features:
        names.append("minimize_tardiness")
    if draft.features & {"rewards", "groups"}:
        names.append("maximize_reward")
    if "rewards" in draft.features:
        names.append("minimize_cost")
    rng.shuffle(names)
    return names[: rng.randint(1, len(names))]


def _longest(action: Document) -> int:
    ways: list[Any] = [mode["duration"] for mode in action.get("modes", ())] or [action["duration"]]
    return max(int(way["max"] if isinstance(way, dict) else way) for way in ways)


# --- rewards ------------------------------------------------------------------------------------


def reward_task(seed: int) -> Task:
    """15 to 40 optional orders that share stations, robots and stock under one deadline.

    Every seventh has a deadline in which nothing fits: there the answer is to do nothing.
    """
    rng = random.Random(f"rewards {seed}")
    orders = rng.randint(15, 40)
    stations = [f"station{i + 1}" for i in range(rng.randint(2, 4))]
    robots = [f"robot{i + 1}" for i in range(rng.randint(1, 3))]
    stocks = [f"stock{i + 1}" for i in range(rng.randint(1, 3))]
    actions: list[Document] = []
    precedence: list[Document] = []
    groups: list[Document] = []
    for k in range(orders):
        steps = _order_steps(rng, k, stations, robots, stocks)
        actions += steps
        precedence += _order_arcs(rng, steps)
        group: Document = {
            "id": f"order{k + 1}",
            "actions": [step["id"] for step in steps],
            "required": False,
            "reward": rng.randint(1, 20),
        }
        if rng.random() < 0.1:
            group["deadline"] = rng.randint(15, 40)
        groups.append(group)
    resources: list[Document] = [{"id": s, "capacity": rng.choice((1, 1, 2))} for s in stations]
    resources += [{"id": robot} for robot in robots]
    resources += [
        {"id": s, "kind": "reservoir", "initial": rng.randint(orders // 5, orders // 2)}
        for s in stocks
    ]
    work = sum(action["duration"] for action in actions) / (len(stations) + len(robots))
    deadline = max(6, round(work * rng.uniform(0.25, 0.7)))
    if seed % 7 == 6:
        deadline = min(min(_chain(group, actions) for group in groups) - 1, 5)
    rng.shuffle(groups)
    return Task.model_validate(
        {
            "resources": resources,
            "actions": actions,
            "precedence": precedence,
            "groups": groups,
            "deadline": max(1, deadline),
            "objective": rng.choice(
                (["maximize_reward"], ["maximize_reward", "minimize_makespan"])
            ),
        }
    )


def _order_steps(
    rng: random.Random, k: int, stations: list[str], robots: list[str], stocks: list[str]
) -> list[Document]:
    steps: list[Document] = []
    for i in range(rng.randint(1, 3)):
        uses: list[Document] = [{"resource": rng.choice(stations)}]
        if rng.random() < 0.6:
            uses.append({"one_of": robots})
        step: Document = {"id": f"step{k + 1}_{i + 1}", "duration": rng.randint(2, 7), "uses": uses}
        if rng.random() < 0.5:
            step["consumes"] = [{"resource": rng.choice(stocks), "amount": rng.choice((1, 1, 2))}]
        steps.append(step)
    return steps


def _order_arcs(rng: random.Random, steps: list[Document]) -> list[Document]:
    arcs = []
    for before, after in pairwise(steps):
        arc: Document = {"before": before["id"], "after": after["id"]}
        if rng.random() < 0.3:
            arc["min_lag"] = rng.randint(1, 3)
        arcs.append(arc)
    return arcs


def _chain(group: Document, actions: list[Document]) -> int:
    """The least time an order takes: its steps follow each other."""
    members = set(group["actions"])
    return sum(int(action["duration"]) for action in actions if action["id"] in members)


# --- contention ---------------------------------------------------------------------------------


def crowded_task(seed: int) -> Task:
    """6 to 20 jobs on stations of capacity 1 to 3, most with one of the robots, with lags.

    Feasible as it is: nothing has a deadline, and maximal lags leave room for any order.
    """
    rng = random.Random(f"crowded {seed}")
    jobs = rng.randint(6, 20)
    robots = [f"robot{i + 1}" for i in range(rng.randint(1, 3))]
    stations = [f"station{i + 1}" for i in range(rng.randint(1, max(2, jobs // 4)))]
    actions: list[Document] = []
    precedence: list[Document] = []
    for i in range(jobs):
        uses: list[Document] = [{"resource": rng.choice(stations)}]
        if rng.random() < 0.7:
            uses.append({"one_of": rng.sample(robots, rng.randint(1, len(robots)))})
        action: Document = {"id": f"job{i + 1}", "duration": rng.randint(1, 9), "uses": uses}
        if rng.random() < 0.15:
            action["release"] = rng.randint(1, 10)
        actions.append(action)
        for before in rng.sample(range(i), min(i, rng.choice((0, 0, 1, 1, 2)))):
            arc: Document = {"before": f"job{before + 1}", "after": f"job{i + 1}"}
            if rng.random() < 0.4:
                arc["min_lag"] = rng.randint(1, 5)
            elif rng.random() < 0.15:
                arc["type"] = "start-start"
                arc["min_lag"] = rng.randint(0, 3)
            precedence.append(arc)
    resources: list[Document] = [{"id": robot} for robot in robots]
    resources += [{"id": s, "capacity": rng.randint(1, 3)} for s in stations]
    rng.shuffle(actions)
    rng.shuffle(precedence)
    return Task.model_validate(
        {"resources": resources, "actions": actions, "precedence": precedence}
    )


# --- two happenings at one instant --------------------------------------------------------------


def match_cellar(seed: int) -> Task:
    """Fuses to mend by the light of matches, one match at a time (Fox and Long).

    A fuse is mended by light alone, which must be there when work begins: it begins at the very
    instant at which the match is struck, one rank later, and the report at the instant of the
    last mend. A tick between any of these makes the makespan greater, for the report takes longer
    than a match burns. Every third cellar has one match too few.
    """
    rng = random.Random(f"cellar {seed}")
    burns, matches, too_few = rng.randint(3, 6), rng.randint(1, 2), seed % 3 == 2
    fuses = matches + too_few
    actions = [_match(f"light{k + 1}", burns) for k in range(matches)]
    for k in range(fuses):
        longest = burns - 1
        length = longest if too_few or k == 0 else rng.randint(1, longest)
        actions.append(_mend(k + 1, length))
    actions.append(
        {
            "id": "report",
            "duration": burns + rng.randint(1, 3),
            "conditions": [
                {"at": "start", "var": f"mended{k + 1}", "value": True} for k in range(fuses)
            ],
        }
    )
    rng.shuffle(actions)
    return Task.model_validate(
        {
            "state": [{"id": "lit"}, *({"id": f"mended{k + 1}"} for k in range(fuses))],
            "resources": [{"id": "hands"}],
            "actions": actions,
            "goals": [{"var": f"mended{k + 1}"} for k in range(fuses)],
        }
    )


def _match(name: str, burns: int) -> Document:
    return {
        "id": name,
        "duration": burns,
        "occurs": "optional",
        "conditions": [{"at": "start", "var": "lit", "value": False}],
        "effects": [
            {"at": "start", "var": "lit", "value": True},
            {"at": "end", "var": "lit", "value": False},
        ],
    }


def _mend(number: int, length: int) -> Document:
    return {
        "id": f"mend{number}",
        "duration": length,
        "uses": [{"resource": "hands"}],
        "conditions": [{"at": at, "var": "lit", "value": True} for at in ("start", "all")],
        "effects": [{"at": "end", "var": f"mended{number}", "value": True}],
    }
