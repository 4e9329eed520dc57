"""Wishes of a goal that no plan can meet."""

from __future__ import annotations

from collections.abc import Iterator

from irc.frontends.importers.robotouille.chores import Chores


def unmet_wishes(chores: Chores) -> Iterator[str]:
    """Says of each wish that cannot be met, why not."""
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
    for item, wish in chores.kitchen.wishes.items():
        if wish.at is None:
            if wish.clear:
                yield f"{item!r} is to be clear, but not where; that is not taken"
            continue
        for wanted, found, how in (
            (wish.on_station, based, "directly on"),
            (wish.clear, clear, "uppermost at"),
        ):
            if wanted and found.setdefault(wish.at, item) != item:
                yield f"{found[wish.at]!r} and {item!r} cannot both be {how} {wish.at!r}"
        if wish.on_station and chores.comes_last(item):
            yield f"{item!r} cannot be both directly on {wish.at!r} and upon others there"
        piled = any(upper == item for upper, _, _ in chores.piles)
        if not piled and not chores.wanted_on(item):
            yield f"nothing can bring {item!r} to {wish.at!r} as the goal wants it"
