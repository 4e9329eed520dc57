"""Finds the possible work on each item: where it is put, cut, cooked and stacked.

Only work that a sensible plan may contain becomes an action, so that tasks stay small: an item is
taken where it lies at first and where it is processed or laid aside, and put where it is processed,
laid aside or wanted. Every plan of these actions is a plan of the game.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from irc.frontends.importers.robotouille.document import (
    BOARD,
    FRYER,
    STOVE,
    TABLE,
    ItemGoal,
    KitchenTask,
)

CUT, COOKED, FRIED = "iscut", "iscooked", "isfried"
_NOTHING = ItemGoal()


@dataclass(frozen=True)
class Chores:
    """The chores of a kitchen, derived from its goal."""

    kitchen: KitchenTask

    def wanted(self, item: str) -> ItemGoal:
        """The goal for an item; an empty one if the goal does not name it."""
        return self.kitchen.item_goals.get(item, _NOTHING)

    def cuts(self, item: str) -> int:
        """The number of cuts that the item needs."""
        there = self.kitchen.items[item]
        if CUT in there.predicates:
            return 0
        needed = CUT in self.wanted(item).done or self.fried_only_when_cut(item)
        return there.cuts if needed else 0

    def fried_only_when_cut(self, item: str) -> bool:
        """Whether the item must be fried and can be fried only in pieces."""
        has = self.kitchen.items[item].predicates
        return self.fries(item) and "isfryable" not in has and "isfryableifcut" in has

    def cooks(self, item: str) -> bool:
        """Whether the item must be cooked."""
        return COOKED in self.wanted(item).done - self.kitchen.items[item].predicates

    def fries(self, item: str) -> bool:
        """Whether the item must be fried."""
        return FRIED in self.wanted(item).done - self.kitchen.items[item].predicates

    def worked_at(self, item: str) -> list[tuple[str, list[str]]]:
        """The processing an item needs: "cut", "cook" or "fry", and the stations for it."""
        of_kind = self.kitchen.of_kind
        needed = (
            ("cut", bool(self.cuts(item)), BOARD),
            ("cook", self.cooks(item), STOVE),
            ("fry", self.fries(item), FRYER),
        )
        return [(what, of_kind(kind)) for what, needs, kind in needed if needs]

    def processing(self, item: str) -> list[str]:
        """All stations at which an item may be processed."""
        return [station for _, stations in self.worked_at(item) for station in stations]

    @cached_property
    def based(self) -> dict[str, str]:
        """By station, the item that the goal wants directly on it."""
        return {
            wanted.at: item
            for item, wanted in self.kitchen.item_goals.items()
            if wanted.on_station and wanted.at is not None
        }

    @cached_property
    def piles(self) -> list[tuple[str, str, str]]:
        """(item, item below it, station) for items that a plan may put upon others."""
        item_goals = self.kitchen.item_goals
        return [
            (upper, lower, wanted.at)
            for upper, wanted in item_goals.items()
            for lower, other in item_goals.items()
            if upper != lower
            and self.moves(upper)
            and wanted.at is not None
            and wanted.at == other.at
            and not wanted.on_station
            and not other.clear
        ]

    @cached_property
    def unpiled(self) -> list[tuple[str, str, str]]:
        """(item, item below it, station) for items that lie upon others at first and must move."""
        return [
            (item.name, item.below, item.station)
            for item in self.kitchen.items.values()
            if item.below is not None and self.moves(item.name)
        ]

    def moves(self, item: str) -> bool:
        """Whether a plan may have a reason to take an item from its first place."""
        there = self.kitchen.items[item]
        wanted = self.wanted(item)
        if self.processing(item) or wanted.at not in (None, there.station):
            return True
        if there.below is None:
            return self._in_the_way(item) or self._makes_room(item)
        return True

    def _makes_room(self, item: str) -> bool:
        """Whether the goal wants another item below one that lies directly on its station."""
        return self._others_below(item) or self.comes_last(item)

    def _others_below(self, item: str) -> bool:
        """Whether the goal wants another item directly on the station of this one."""
        base = self.based.get(self.kitchen.items[item].station)
        return base not in (None, item)

    def comes_last(self, item: str) -> bool:
        """Whether the goal wants an item uppermost at a station with others."""
        wanted = self.wanted(item)
        return wanted.clear and any(
            other.at == wanted.at for name, other in self.kitchen.item_goals.items() if name != item
        )

    def _in_the_way(self, item: str) -> bool:
        """Whether other items must be processed at the station of this one."""
        station = self.kitchen.items[item].station
        return any(
            station in self.processing(other) for other in self.kitchen.items if other != item
        )

    def laid_aside(self, item: str) -> list[str]:
        """The tables on which a plan may lay an item aside, if it is in the way of others."""
        there = self.kitchen.items[item]
        waits = there.below is not None or self._in_the_way(item) or self._makes_room(item)
        if not waits or not self.moves(item):
            return []
        taken = {
            other.station
            for other in self.kitchen.items.values()
            if other.below is None and other.name != item and not self.moves(other.name)
        }
        return [table for table in self.kitchen.of_kind(TABLE) if table not in taken]

    def wanted_on(self, item: str) -> list[str]:
        """The stations on whose surface the goal may want an item."""
        wanted = self.wanted(item)
        if wanted.at is None or self.based.get(wanted.at, item) != item:
            return []
        return [wanted.at]

    def puts(self, item: str) -> list[str]:
        """The stations on whose surface an item may be put."""
        if not self.moves(item):
            return []
        found = [*self.processing(item), *self.laid_aside(item), *self.wanted_on(item)]
        return list(dict.fromkeys(found))

    def takes(self, item: str) -> list[str]:
        """The stations from whose surface an item may be taken."""
        if not self.moves(item):
            return []
        there = self.kitchen.items[item]
        first = [there.station] if there.below is None else []
        found = [*first, *self.processing(item), *self.laid_aside(item)]
        return list(dict.fromkeys(found))

    def leaves(self, item: str) -> bool:
        """Whether an item lies directly on a station at first and cannot stay there."""
        there = self.kitchen.items[item]
        wanted = self.wanted(item)
        if there.below is not None:
            return False
        elsewhere = any(
            there.station not in stations for _, stations in self.worked_at(item)
        ) or wanted.at not in (None, there.station)
        return elsewhere or self._makes_room(item)
