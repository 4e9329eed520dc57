"""Random shops with orders, calendars and set-ups; and their tables, counted instant by instant."""

from __future__ import annotations

import random
from itertools import pairwise
from typing import Any

Document = dict[str, Any]
SHIFT = (2, 9)
CYCLE = 12


def shop(seed: int) -> Document:
    """Orders of a few steps on a painted booth, a team of two and a machine with a shift."""
    rng = random.Random(f"shop {seed}")
    actions: list[Document] = []
    groups: list[Document] = []
    precedence: list[Any] = []
    for j in range(rng.randint(2, 4)):
        names = [f"{j}.{k}" for k in range(rng.randint(1, 3))]
        for name in names:
            use = rng.choice(["booth", "team", "press"])
            held: Document = {"resource": use}
            if use == "booth":
                held["family"] = rng.choice(["red", "blue"])
            if use == "team":
                held["amount"] = rng.randint(1, 2)
            action: Document = {"id": name, "duration": rng.randint(1, 6), "uses": [held]}
            if use == "press":
                action["breaks"] = "pause"
            if rng.random() < 0.3:
                action["due"] = rng.randint(-2, 15)
                action["weight"] = rng.randint(1, 3)
            if rng.random() < 0.3:
                action["release"] = rng.randint(1, 6)
            actions.append(action)
        precedence += [[a, b] for a, b in pairwise(names)]
        group: Document = {"id": f"order {j}", "actions": names}
        if rng.random() < 0.8:
            group |= {"due": rng.randint(1, 20), "weight": rng.randint(0, 3)}
        groups.append(group)
    rows = [{"from": "red", "to": "blue", "time": 2, "cost": 1}]
    rows.append({"from": "blue", "to": "red", "time": 1})
    return {
        "time_unit": "h",
        "origin": "2026-03-28T20:00:00+01:00",
        "calendars": [
            {
                "id": "shift",
                "every": CYCLE,
                "open": [{"from": SHIFT[0], "to": SHIFT[1]}],
                "time_zone": "Europe/Berlin",
            }
        ],
        "resources": [
            {"id": "booth", "setups": {"times": rows}},
            {"id": "team", "capacity": 2},
            {"id": "press", "calendar": "shift"},
        ],
        "actions": actions,
        "precedence": precedence,
        "groups": groups,
        "objective": ["minimize_tardiness", "minimize_makespan"],
    }


def orders_counted(document: Document, entries: list[Document]) -> dict[str, Document]:
    """(start, end, lateness, tardiness) of each group and each dated action, from the document."""
    times = {e["id"]: (e["start"], e["end"]) for e in entries}
    found: dict[str, Document] = {}
    parts = [(g["id"], g["actions"], g) for g in document["groups"]]
    parts += [(a["id"], [a["id"]], a) for a in document["actions"] if "due" in a]
    for name, members, part in parts:
        start = min(times[m][0] for m in members)
        end = max(times[m][1] for m in members)
        due = part.get("due")
        found[name] = {
            "start": start,
            "end": end,
            "due": due,
            "weight": part.get("weight", 1),
            "lateness": None if due is None else end - due,
            "tardiness": None if due is None else max(0, end - due),
        }
    return found


def hours_counted(document: Document, entries: list[Document]) -> dict[str, dict[str, int]]:
    """Hour by hour, how each resource spends its time until the makespan."""
    span = max(e["end"] for e in entries)
    found = {}
    for resource in document["resources"]:
        name, capacity = resource["id"], resource.get("capacity", 1)
        count = {"busy": 0, "setup": 0, "idle": 0, "closed": 0, "used": 0}
        for hour in range(span):
            load = sum(
                e.get("resources", {}).get(name, 0)
                for e in entries
                if e["start"] <= hour < e["end"]
            )
            if name == "press" and not SHIFT[0] <= hour % CYCLE < SHIFT[1]:
                count["closed"] += 1
                continue
            count["used"] += load
            if load:
                count["busy"] += 1
            else:
                count[
                    "setup" if name == "booth" and _is_set_up(document, entries, hour) else "idle"
                ] += 1
        found[name] = {**count, "capacity": capacity}
    return found


def _is_set_up(document: Document, entries: list[Document], hour: int) -> bool:
    """Whether the booth is being painted over in an hour: right before the next use of another
    colour.
    """
    family = {a["id"]: a["uses"][0].get("family") for a in document["actions"]}
    held = sorted((e["start"], e["end"], e["id"]) for e in entries if "booth" in e["resources"])
    before = [h for h in held if h[1] <= hour]
    after = [h for h in held if h[0] > hour]
    if not before or not after:
        return False
    colours = family[before[-1][2]], family[after[0][2]]
    needed = {("red", "blue"): 2, ("blue", "red"): 1}.get(colours, 0)
    return hour >= after[0][0] - needed
