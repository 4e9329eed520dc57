"""Random executions about orders worth a reward: what can be earned changes while they run.

Five to twelve optional orders of one to three steps share stations, robots and stock under a
deadline. Then things happen: new orders, some of which nothing is left for; steps that take longer;
stations that fail; deadlines that come nearer; orders taken back; steps seen to start or end at
another time than planned. What happens is drawn for the plan of that time, and often meant to make
a half-done order impossible to finish.

Everything is a document, as of JSON, with times that are multiples of one half.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from types import MappingProxyType
from typing import Any

from oracles.online_orders_kitchen import Kitchen, Plan, Run

Document = dict[str, Any]

_TRIES = 30


# --- tasks ----------------------------------------------------------------------------------------


def orders_task(rng: random.Random) -> Document:
    """Optional orders under a deadline in which some of them fit; sometimes work that must be."""
    stations = [f"station{k + 1}" for k in range(rng.randint(2, 3))]
    robots = [f"robot{k + 1}" for k in range(rng.choice((0, 1, 2, 2)))]
    stocks = [f"stock{k + 1}" for k in range(rng.choice((0, 1, 1, 2)))]
    document: Document = {
        "resources": [{"id": s, "capacity": rng.choice((1, 1, 2))} for s in stations],
        "actions": [],
        "precedence": [],
        "groups": [],
        "objective": ["maximize_reward"],
    }
    document["resources"] += [{"id": robot} for robot in robots]
    if rng.random() < 0.8:
        document["objective"].append("minimize_makespan")
    number = rng.randint(5, 12)
    shop = _Shop(stations, robots, stocks)
    for k in range(number):
        for name, part in shop.order(rng, f"order{k + 1}").items():
            document[name] += part
    if rng.random() < 0.25:
        document["actions"] += [_with_id("clean", shop.step(rng))]
    if stocks and rng.random() < 0.3:
        restock = {**shop.step(rng), "produces": [{"resource": stocks[0], "amount": 2}]}
        restock.pop("consumes", None)
        document["actions"] += [_with_id("restock", restock)]
    need = dict.fromkeys(stocks, 0)
    for action in document["actions"]:
        for use in action.get("consumes", ()):
            need[use["resource"]] += use["amount"]
    document["resources"] += [
        {"id": s, "kind": "reservoir", "initial": round(need[s] * rng.uniform(0.4, 1.0))}
        for s in stocks
    ]
    work = sum(action["duration"] for action in document["actions"])
    hands = min(len(stations), len(robots) or len(stations))
    document["deadline"] = max(12, round(work / hands * rng.uniform(0.5, 0.9)))
    return document


def _with_id(name: str, step: Document) -> Document:
    return {"id": name, **step}


@dataclass(frozen=True)
class _Shop:
    """What the steps of orders are drawn from."""

    stations: Sequence[str]
    robots: Sequence[str]
    stocks: Sequence[str]

    def step(self, rng: random.Random) -> Document:
        uses: list[Document] = [{"resource": rng.choice(self.stations)}]
        if self.robots and rng.random() < 0.6:
            uses.append({"one_of": list(self.robots)})
        step: Document = {"duration": rng.randint(2, 7), "uses": uses}
        if self.stocks and rng.random() < 0.4:
            amount = rng.choice((1, 1, 2))
            step["consumes"] = [{"resource": rng.choice(self.stocks), "amount": amount}]
        return step

    def order(self, rng: random.Random, name: str) -> dict[str, list[Document]]:
        """Its actions, precedence and group."""
        count = rng.choice((1, 2, 2, 3, 3))
        actions = [_with_id(f"{name}.{k + 1}", self.step(rng)) for k in range(count)]
        arcs = []
        for before, after in pairwise(actions):
            if rng.random() < 0.1:
                continue
            arc: Document = {"before": before["id"], "after": after["id"]}
            if rng.random() < 0.2:
                arc["min_lag"] = rng.randint(1, 2)
            if rng.random() < 0.3:
                arc["max_lag"] = arc.get("min_lag", 0) + rng.randint(1, 5)
            arcs.append(arc)
        group: Document = {
            "id": name,
            "actions": [a["id"] for a in actions],
            "required": False,
            "reward": rng.randint(1, 20),
        }
        return {"actions": actions, "precedence": arcs, "groups": [group]}


# --- events ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Moment:
    """What is known at a time, and the plan that is carried out then."""

    kitchen: Kitchen
    plan: Plan
    at: Fraction
    number: int

    @property
    def begun(self) -> Plan:
        return {n: r for n, r in self.plan.items() if r.start < self.at}

    def running(self) -> list[str]:
        """Steps that run, and that nobody has ended."""
        return [n for n, r in self.begun.items() if r.end > self.at and r.status != "cancelled"]

    def half_done(self) -> list[str]:
        return self.kitchen.half_done(self.begun)

    def to_do(self, order: str) -> list[str]:
        """The steps of an order that have not begun."""
        return [n for n in self.kitchen.groups[order]["actions"] if n not in self.begun]


def _new_order(rng: random.Random, moment: Moment) -> list[Document] | None:
    """An order, and in every fourth case one that cannot be had any more."""
    kitchen = moment.kitchen
    stations = [r for r in kitchen.resources.values() if r["id"].startswith("station")]
    robots = [r for r in kitchen.resources if r.startswith("robot")]
    stocks = [r for r, d in kitchen.resources.items() if d.get("kind") == "reservoir"]
    shop = _Shop([s["id"] for s in stations], robots, stocks)
    made = shop.order(rng, f"late{moment.number}")
    group, step = made["groups"][0], rng.choice(made["actions"])
    if rng.random() < 0.25:
        if stocks and rng.random() < 0.5:
            step["consumes"] = [{"resource": stocks[0], "amount": rng.randint(20, 30)}]
        elif rng.random() < 0.5:
            step["duration"] = _whole(max(0, kitchen.deadline - moment.at)) + rng.randint(1, 5)
        else:
            group["deadline"] = _number(moment.at + 1)
        group["reward"] = 50
    elif rng.random() < 0.3:
        group["deadline"] = _number(moment.at + rng.randint(6, 20))
    return [
        {"op": "add_actions", "actions": made["actions"]},
        *([{"op": "add_precedence", "precedence": made["precedence"]}] * bool(made["precedence"])),
        {"op": "add_groups", "groups": made["groups"]},
    ]


def _longer(rng: random.Random, moment: Moment) -> list[Document] | None:
    """Something that runs, or that a half-done order still needs, takes longer."""
    names = moment.running() + [n for order in moment.half_done() for n in moment.to_do(order)]
    names = [n for n in names or moment.plan if n not in moment.begun or n in moment.running()]
    if not names:
        return None
    name = rng.choice(names)
    longer = moment.kitchen.duration(name) + rng.choice((1, 2, 3, 6, 12))
    if name in moment.begun:
        longer = max(longer, moment.plan[name].end - moment.plan[name].start)
    return [{"op": "set_duration", "action": name, "duration": _number(longer)}]


def _failure(rng: random.Random, moment: Moment) -> list[Document] | None:
    """A station fails, for a while or for good: often one that a half-done order needs."""
    kitchen = moment.kitchen
    needed = [
        use["resource"]
        for order in moment.half_done()
        for name in moment.to_do(order)
        for use in kitchen.actions[name]["uses"]
        if "resource" in use
    ]
    if not needed or rng.random() < 0.3:
        needed = [name for name in kitchen.resources if name.startswith("station")]
    change: Document = {"op": "set_capacity", "resource": rng.choice(needed), "capacity": 0}
    if rng.random() < 0.6:
        change["to"] = _number(moment.at + rng.randint(3, 15))
    return [change]


def _repair(rng: random.Random, moment: Moment) -> list[Document] | None:
    """A station that is down works again."""
    down = [
        name
        for name in moment.kitchen.resources
        if name.startswith("station") and not moment.kitchen.capacity(name, moment.at)
    ]
    if not down:
        return None
    return [{"op": "set_capacity", "resource": rng.choice(down), "capacity": 1}]


def _nearer(rng: random.Random, moment: Moment) -> list[Document] | None:
    """The deadline, or that of an order, comes nearer than the plan has the end."""
    change: Document = {"op": "set_deadline"}
    half_done = [g for g in moment.half_done() if any(n in moment.plan for n in moment.to_do(g))]
    if half_done and rng.random() < 0.5:
        change["group"] = order = rng.choice(half_done)
        last = max(moment.plan[n].end for n in moment.to_do(order) if n in moment.plan)
        change["deadline"] = _number(max(moment.at, last - rng.randint(1, 3)))
        return [change]
    last = max((run.end for run in moment.plan.values()), default=moment.at)
    sooner = moment.at + (last - moment.at) * Fraction(rng.randint(3, 9), 10)
    change["deadline"] = _number(Fraction(int(sooner * 2), 2))
    return [change]


def _later(rng: random.Random, moment: Moment) -> list[Document] | None:
    """There is more time: for an order that was given up, and may be finished after all."""
    given_up = [g for g in moment.half_done() if moment.to_do(g)[0] not in moment.plan]
    more = moment.kitchen.deadline + rng.randint(5, 20)
    if given_up and rng.random() < 0.6:
        order = rng.choice(given_up)
        return [
            {"op": "set_deadline", "deadline": _number(more)},
            {"op": "set_deadline", "group": order, "deadline": _number(more)},
        ]
    return [{"op": "set_deadline", "deadline": _number(more)}]


def _taken_back(rng: random.Random, moment: Moment) -> list[Document] | None:
    begun = moment.begun
    orders = [
        g
        for g, said in moment.kitchen.groups.items()
        if any(n not in begun or begun[n].end > moment.at for n in said["actions"])
    ]
    if not orders:
        return None
    half_done = [g for g in moment.half_done() if g in orders]
    chosen = rng.choice(half_done if half_done and rng.random() < 0.5 else orders)
    return [{"op": "cancel_groups", "groups": [chosen]}]


def _seen(rng: random.Random, moment: Moment) -> list[Document] | None:
    """Something started later than planned, or ended by now."""
    names = [n for n in moment.running() if n not in moment.kitchen.seen]
    names = [n for n in names if "produces" not in moment.kitchen.actions[n]]
    if not names:
        return None
    name = rng.choice(names)
    change: Document = {"op": "observe", "action": name}
    if rng.random() < 0.6:
        change["started"] = _number(moment.at if rng.random() < 0.5 else moment.plan[name].start)
    else:
        change["finished"] = _number(moment.at)
    return [change]


_DRAWN = MappingProxyType(
    {
        "new order": _new_order,
        "longer": _longer,
        "failure": _failure,
        "repair": _repair,
        "nearer deadline": _nearer,
        "later deadline": _later,
        "taken back": _taken_back,
        "seen": _seen,
    }
)
KINDS = tuple(_DRAWN)
_WEIGHTS = (4, 3, 4, 3, 4, 1, 2, 2)


def next_event(
    rng: random.Random, kitchen: Kitchen, plan: Mapping[str, Run], since: Fraction, number: int
) -> Document | None:
    """What happens next, after `since`; None where nothing more can."""
    for _ in range(_TRIES):
        at = _time(rng, kitchen, plan, since)
        if at is None:
            return None
        kind = rng.choices(KINDS, _WEIGHTS)[0]
        changes = _DRAWN[kind](rng, Moment(kitchen, plan, at, number))
        if changes is not None:
            return {"id": f"{kind} {number}", "at": _number(at), "changes": changes}
    return None


def _time(
    rng: random.Random, kitchen: Kitchen, plan: Mapping[str, Run], since: Fraction
) -> Fraction | None:
    """A half hour amid the plan, mostly one at which an order is half-done."""
    last = max((run.end for run in plan.values()), default=Fraction(0))
    times = [Fraction(k, 2) for k in range(int(since * 2) + 1, int(last * 2))]
    amid = [t for t in times if kitchen.half_done({n: r for n, r in plan.items() if r.start < t})]
    if amid and rng.random() < 0.8:
        return rng.choice(amid)
    return rng.choice(times) if times else None


def _number(time: Fraction | int) -> int | float:
    time = Fraction(time)
    return int(time) if time.denominator == 1 else float(time)


def _whole(time: Fraction | int) -> int:
    return -int(-Fraction(time) // 1)
