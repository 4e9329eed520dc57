"""Random schedules of which everything happens around one instant, so that its order decides.

An order of the happenings is planted. Conditions, effects and the bounds of stock are made so that
this order keeps them, mostly with no room to spare; then some of them are made wrong. Ranks are
needed that are not the least ones: who takes stock must come behind who gives it, wherever state
puts that one. Some cases have a change of the world, anywhere in the planted order; some have no
state, so that stock alone decides.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from typing import Any

from irc.model import Task
from irc.schedule import Entry

INSTANT = 2
CHANGE = f"p at {INSTANT}"
"""How the naive validator knows a change of the world."""

Document = dict[str, Any]


@dataclass
class _World:
    """What the planted order has led to so far. One holds the resource until the instant, and one
    from it on: `holding` says at which end of it."""

    rng: random.Random
    values: dict[str, bool] = field(default_factory=lambda: {"p": False, "q": False})
    levels: dict[str, list[int]] = field(default_factory=lambda: {"m": [0], "n": [0]})
    with_state: bool = True
    holding: set[str] = field(default_factory=set)

    def state_of(self, action: Document, place: str) -> None:
        """Conditions that hold now, and effects; at most one happening changes a variable."""
        rng = self.rng
        for var in ("p", "q") if self.with_state else ():
            if rng.random() < 0.4:
                value = self.values[var] is (rng.random() < 0.95)
                action["conditions"].append({"at": place, "var": var, "value": value})
            if rng.random() < 0.3:
                self.values[var] = not self.values[var]
                action["effects"].append({"at": place, "var": var, "value": self.values[var]})

    def stock_of(self, action: Document, place: str) -> None:
        rng = self.rng
        for name in ("m", "n"):
            if rng.random() < 0.45:
                amount = rng.choice([-2, -1, -1, 1, 1, 2])
                kind = "consumes" if amount < 0 else "produces"
                change = {"resource": name, "amount": abs(amount), "at": place}
                action.setdefault(kind, []).append(change)
                self.levels[name].append(self.levels[name][-1] + amount)

    def reservoir(self, name: str) -> Document:
        """Bounds that the planted order keeps; at times too tight, or only as wide as the sum of
        all needs them."""
        levels = self.levels[name]
        fit = {"initial": -min(levels), "max": max(levels) - min(levels)}
        if self.rng.random() < (0.15 if self.with_state else 0.6):
            initial = max(0, -levels[-1])
            fit = {"initial": initial, "max": initial + max(0, levels[-1])}
        return {"id": name, "kind": "reservoir", **fit}


def instant_case(seed: int, count: int = 4) -> tuple[Task, list[Entry]]:
    """At most `count` actions that start or end at one instant; the same for the same seed."""
    rng = random.Random(f"instant {seed}")
    world = _World(rng, with_state=rng.random() < 0.7)
    actions: list[Document] = []
    entries: list[Entry] = []
    has_change = world.with_state and rng.random() < 0.4
    change = rng.randrange(count) if has_change else None
    for k in range(count):
        if k == change:
            world.values["p"] = not world.values["p"]
            effect = {"at": "start", "var": "p", "value": world.values["p"]}
            fixed = {"id": CHANGE, "duration": 0, "start": INSTANT, "effects": [effect]}
            actions.append(fixed)
            entries.append(Entry(CHANGE, INSTANT, INSTANT))
            continue
        action, entry = _action(world, "abcd"[k])
        actions.append(action)
        entries.append(entry)
    document = {
        "actions": actions,
        "state": [{"id": "p"}, {"id": "q"}] if world.with_state else [],
        "resources": [{"id": "r"}, world.reservoir("m"), world.reservoir("n")],
    }
    return Task.model_validate(document), entries


def _action(world: _World, name: str) -> tuple[Document, Entry]:
    """What ends at the instant, starts at it, or both; all it does, it does then."""
    rng = world.rng
    length, starts = rng.choice([0, 1, 1]), rng.random() < 0.5
    action: Document = {"id": name, "duration": length, "conditions": [], "effects": []}
    place = "start" if starts or not length else "end"
    world.state_of(action, place)
    world.stock_of(action, place)
    start = INSTANT if place == "start" else INSTANT - length
    held = {"r": 1} if length and place not in world.holding and rng.random() < 0.9 else {}
    world.holding |= {place} if held else set()
    action["uses"] = [{"resource": "r"}] if held else []
    return action, Entry(name, start, start + length, held)
