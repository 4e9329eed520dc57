"""Finds parts of a goal that no plan can reach."""

from __future__ import annotations

from collections.abc import Iterator

from irc.frontends.importers.robotouille.chores import Chores


def unmet_goals(chores: Chores) -> Iterator[str]:
    """The reason for each part of the goal that cannot be reached."""
    yield from _unmet_processing(chores)
    yield from _unmet_places(chores)


def _unmet_processing(chores: Chores) -> Iterator[str]:
    able = {
        "cut": ("cut", ("iscuttable",)),
        "cook": ("cooked", ("iscookable",)),
        "fry": ("fried", ("isfryable", "isfryableifcut")),
    }
    for name, item in chores.kitchen.items.items():
        for what, stations in chores.worked_at(name):
            done, needed = able[what]
            if not item.predicates & set(needed):
                yield f"{name!r} cannot be {done}: it is not {' or '.join(needed)}"
            if not stations:
                yield f"{name!r} cannot be {done}: the kitchen has no station for it"


def _unmet_places(chores: Chores) -> Iterator[str]:
    based: dict[str, str] = {}
    clear: dict[str, str] = {}
    for item, goal in chores.kitchen.item_goals.items():
        if goal.at is None:
            if goal.clear:
                yield f"{item!r} must be clear, but the goal names no station for it"
            continue
        for wanted, found, how in (
            (goal.on_station, based, "directly on"),
            (goal.clear, clear, "uppermost at"),
        ):
            if wanted and found.setdefault(goal.at, item) != item:
                yield f"{found[goal.at]!r} and {item!r} cannot both be {how} {goal.at!r}"
        if goal.on_station and chores.comes_last(item):
            yield f"{item!r} cannot be both directly on {goal.at!r} and on other items there"
        piled = any(upper == item for upper, _, _ in chores.piles)
        if not piled and not chores.wanted_on(item):
            yield f"nothing can bring {item!r} to {goal.at!r} as the goal wants it"
