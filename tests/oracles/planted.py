"""Random tasks made around a schedule, which is valid because they are; the same for a seed.

First the schedule is drawn: times, ranks, modes, who is there. Then the task gets only what holds
in it: conditions on values that variables have there, bounds that levels keep, capacities that are
not exceeded, lags that are respected. So no search is needed for a schedule with idle times, odd
ranks and things that happen to coincide.
"""

from __future__ import annotations

import random
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from irc.model import Task
from irc.schedule import Entry

Key = tuple[int, int]
Document = dict[str, Any]

VALUES = ("raw", "warm", "hot")
LAG_TYPES = {
    "finish-start": ("end", "start"),
    "start-start": ("start", "start"),
    "finish-finish": ("end", "end"),
    "start-finish": ("start", "end"),
}


@dataclass
class _Actor:
    """One action and what it does in the schedule."""

    entry: Entry
    document: Document
    is_range: bool = False

    @property
    def name(self) -> str:
        return self.entry.id

    @property
    def end_rank(self) -> int:
        return self.entry.rank if self.entry.end_rank is None else self.entry.end_rank

    def key(self, at: str) -> Key:
        """The (time, rank) of the start or the end."""
        if at == "start":
            return int(self.entry.start), self.entry.rank
        return int(self.entry.end), self.end_rank

    @property
    def is_one(self) -> bool:
        return self.key("start") == self.key("end")


def planted(seed: int) -> tuple[Task, tuple[Entry, ...]]:
    """A task and a valid schedule of it with explicit ranks (some may all be 0)."""
    rng = random.Random(f"planted {seed}")
    actors = [_actor(rng, f"a{k}") for k in range(rng.randint(2, 7))]
    state = [_plant_variable(rng, f"v{k}", actors) for k in range(rng.randint(0, 3))]
    document: Document = {
        "state": [variable for variable, _ in state],
        "goals": [goal for _, goal in state if rng.random() < 0.5],
        "precedence": _lags(rng, actors),
        "actions": [actor.document for actor in actors],
        "deadline": 997,  # Far and prime: a tick is 1.
    }
    entries = [actor.entry for actor in actors]
    entries += _repeat(rng, document)
    document["resources"] = [
        *([_plant_stock(rng, actors)] if rng.random() < 0.5 else []),
        *_plant_resources(rng, document["actions"], entries),
    ]
    if rng.random() < 0.3:
        document["actions"].append({"id": "absent", "duration": 3, "occurs": "optional"})
        document["precedence"].append({"before": "absent", "after": actors[0].name, "min_lag": 50})
    return Task.model_validate(document), tuple(entries)


def _actor(rng: random.Random, name: str) -> _Actor:
    start, length = rng.randint(0, 8), rng.choice((0, 0, 1, 2, 2, 3, 4))
    rank = rng.choice((0, 0, 1, 2))
    entry = Entry(name, start, start + length, rank=rank)
    document: Document = {"id": name, "duration": length}
    if rng.random() < 0.3:
        document["release"] = rng.randint(0, start)
    if rng.random() < 0.2:
        document["deadline"] = start + length + rng.randint(0, 3)
    if rng.random() < 0.35:
        end_rank = rng.randint(0, 2)
        least = rng.randint(0, max(0, length - (end_rank < rank)))
        if least == length and end_rank < rank:
            end_rank = rank
        most = length + rng.randint(int(end_rank > rank or least == length), 3)
        document["duration"] = {"min": least, "max": most}
        return _Actor(replace(entry, end_rank=end_rank), document, is_range=True)
    if rng.random() < 0.2:
        other = {"id": "other", "duration": rng.randint(0, 5)}
        document["modes"] = [{"id": "this", "duration": length}, other]
        del document["duration"]
        return _Actor(replace(entry, mode="this"), document)
    return _Actor(entry, document)


def _plant_variable(
    rng: random.Random, name: str, actors: list[_Actor]
) -> tuple[Document, Document]:
    """A variable, a goal that the schedule reaches, and what the actions have to do with it."""
    writes: dict[Key, tuple[str, str]] = {}
    for actor in actors:
        for at in ("start",) if actor.is_one else ("start", "end"):
            if rng.random() < 0.25 and actor.key(at) not in writes:
                value = rng.choice(VALUES)
                writes[actor.key(at)] = (actor.name, value)
                effect = {"at": at, "var": name, "value": value}
                actor.document.setdefault("effects", []).append(effect)
    initial = rng.choice(VALUES)
    in_order = sorted((key, value) for key, (_, value) in writes.items())

    def before(key: Key) -> str:
        return next((v for k, v in reversed(in_order) if k < key), initial)

    for actor in actors:
        conditions: list[Document] = []
        for at in ("start", "end"):
            writer = writes.get(actor.key(at), (actor.name, ""))[0]
            if writer == actor.name and rng.random() < 0.3:
                conditions.append({"at": at, "var": name, "value": before(actor.key(at))})
        opening, closing = actor.key("start"), actor.key("end")
        held = {before((opening[0], opening[1] + 1))}
        held |= {value for key, value in in_order if opening < key < closing}
        if not actor.is_one and len(held) == 1 and rng.random() < 0.4:
            conditions.append({"at": "all", "var": name, "value": held.pop()})
        actor.document.setdefault("conditions", []).extend(conditions)
    goal = {"var": name, "value": before((1000, 0))}
    return {"id": name, "values": list(VALUES), "initial": initial}, goal


def _lags(rng: random.Random, actors: list[_Actor]) -> list[Document]:
    lags: list[Document] = []
    for _ in range(rng.randint(0, len(actors))):
        before, after = rng.sample(actors, 2)
        kind = rng.choice(list(LAG_TYPES))
        one, two = before.key(LAG_TYPES[kind][0]), after.key(LAG_TYPES[kind][1])
        tight = two[0] - one[0] - (two[1] < one[1])
        lag = {"before": before.name, "after": after.name, "type": kind}
        lag["min_lag"] = tight - rng.randint(0, 2)
        if rng.random() < 0.3:
            lag["max_lag"] = two[0] - one[0] + rng.randint(0, 2)
        if (before.name, after.name) not in {(x["before"], x["after"]) for x in lags}:
            lags.append(lag)
    return lags


def _repeat(rng: random.Random, document: Document) -> list[Entry]:
    """Sometimes an action that occurs more than once."""
    if rng.random() < 0.6:
        return []
    document["actions"].append({"id": "again", "duration": 2, "occurs": {"min": 0, "max": 3}})
    starts = [rng.randint(0, 3), rng.randint(5, 7)]
    return [Entry("again", s, s + 2, occurrence=k + 1) for k, s in enumerate(starts)]


def _plant_stock(rng: random.Random, actors: list[_Actor]) -> Document:
    """A reservoir with just the room that one happening after another needs."""
    changes: dict[tuple[Key, str], int] = {}
    for actor in actors:
        for part, sign, at in (("consumes", -1, "start"), ("produces", 1, "end")):
            if rng.random() < 0.35:
                amount = rng.randint(1, 2)
                actor.document[part] = [{"resource": "flour", "amount": amount}]
                happening = actor.key(at), actor.name
                changes[happening] = changes.get(happening, 0) + sign * amount
    initial = level = rng.randint(0, 3)
    levels = [initial]
    for happening in sorted(changes):
        level += changes[happening]
        levels.append(level)
    stock: Document = {"id": "flour", "kind": "reservoir", "initial": initial, "min": min(levels)}
    if rng.random() < 0.6:
        stock["max"] = max(levels)
    return stock


_RANKS = 4


def _plant_resources(
    rng: random.Random, actions: list[Document], entries: list[Entry]
) -> Iterable[Document]:
    """An oven with a calendar and two robots; each has just the capacity that is used.

    (From moment to moment: `_RANKS` to a tick.)
    """
    loads: dict[str, list[tuple[int, int, int]]] = {"oven": [], "ann": [], "bob": []}
    for action in actions:
        uses: list[Document] = []
        held: dict[str, int] = {}
        if rng.random() < 0.6:
            held["oven"] = rng.randint(1, 2)
            uses.append({"resource": "oven", "amount": held["oven"]})
        if rng.random() < 0.4:
            held[rng.choice(("ann", "bob"))] = 1
            uses.append({"one_of": ["ann", "bob"]})
        part = action["modes"][0] if "modes" in action else action
        part["uses"] = uses
        for k, entry in enumerate(entries):
            if entry.id == action["id"]:
                entries[k] = replace(entry, resources=held)
                start = int(entry.start) * _RANKS + entry.rank
                end = int(entry.end) * _RANKS + entry.last_rank
                for name, amount in held.items() if entry.start < entry.end else ():
                    loads[name].append((start, end, amount))

    def peak(name: str, times: Iterable[int]) -> int:
        moments = (t * _RANKS + rank for t in times for rank in range(_RANKS))
        return max((sum(a for s, e, a in loads[name] if s <= m < e) for m in moments), default=0)

    for name in ("ann", "bob"):
        yield {"id": name, "capacity": max(1, peak(name, range(30)))}
    windows: list[Document] = []
    inside: set[int] = set()
    for _ in range(rng.randint(0, 2)):
        begin = (windows[-1]["to"] if windows else 0) + rng.randint(0, 5)
        end = begin + rng.randint(1, 4)
        inside |= set(range(begin, end))
        windows.append({"from": begin, "to": end, "capacity": peak("oven", range(begin, end))})
    outside = set(range(30)) - inside
    yield {"id": "oven", "capacity": max(1, peak("oven", outside)), "availability": windows}
