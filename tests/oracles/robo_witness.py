"""Robo Challenge's own answers, read without the project's code for its tasks.

A witness names for each step the action, the robot where there are robots, and the item; the
station follows from the action, as the benchmark says.
"""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

from irc.schedule import Entry, Schedule

STATION = {
    "grill": "grill",
    "cut": "cutting_board",
    "fry": "fryer",
    "boil": "boiler",
    "toast": "toaster",
    "marinate": "marinator",
    "mash": "cutting_board",
}
LINE = re.compile(r"([\d.]+): \((\w+)((?: \w+)+)\)\s+\[([\d.]+)\]")


def witness_schedule(instance: dict[str, Any]) -> Schedule:
    """The witness plan as a schedule: every robot as it is named, every station held."""
    entries = []
    for start, action, arguments, duration in LINE.findall(instance["witness_plan"]):
        *robots, item = arguments.split()
        held = [*robots, *([STATION[action]] if action in STATION else [])]
        begin = Fraction(start)
        end = begin + Fraction(duration)
        entries.append(Entry(f"{action}_{item}", begin, end, dict.fromkeys(held, 1)))
    assert len(entries) == len(instance["witness_plan"].splitlines())
    return Schedule(tuple(entries))


def as_once_task(document: dict[str, Any]) -> dict[str, Any]:
    """A makespan task without state: each item's processing in its order, as precedence."""
    edges = []
    for variable in document["state"]:
        made_by = {
            effect["value"]: action["id"]
            for action in document["actions"]
            for effect in action.get("effects", ())
            if effect["var"] == variable["id"]
        }
        edges += [
            {"before": made_by[condition["value"]], "after": action["id"]}
            for action in document["actions"]
            for condition in action.get("conditions", ())
            if condition["var"] == variable["id"] and condition["value"] in made_by
        ]
    plain = [
        {key: value for key, value in action.items() if key not in ("conditions", "effects")}
        for action in document["actions"]
    ]
    rest = {k: v for k, v in document.items() if k not in ("state", "goals")}
    return {**rest, "actions": plain, "precedence": [*document.get("precedence", ()), *edges]}
