"""What may have to be done with each item: where it is put, cut, cooked and stacked.

Only what some sensible plan does is made an action, so that tasks stay small: an item is taken
where it lies at first and where it is processed or laid aside, and put where it is processed, laid
aside or wanted. Every plan of these actions is a plan of the game.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from irc.frontends.importers.robotouille.document import (
    BOARD,
    FRYER,
    STOVE,
    TABLE,
    KitchenTask,
    Wish,
)

CUT, COOKED, FRIED = "iscut", "iscooked", "isfried"
_NOTHING = Wish()


@dataclass(frozen=True)
class Chores:
    """The chores of a kitchen, worked out from its goal."""

    kitchen: KitchenTask

    def wish(self, item: str) -> Wish:
        """What the goal wants of an item; nothing where it does not name it."""
        return self.kitchen.wishes.get(item, _NOTHING)

    def cuts(self, item: str) -> int:
        """How many cuts the item needs."""
        there = self.kitchen.items[item]
        if CUT in there.predicates:
            return 0
        needed = CUT in self.wish(item).done or self.fried_only_when_cut(item)
        return there.cuts if needed else 0

    def fried_only_when_cut(self, item: str) -> bool:
        """Whether the item is to be fried and admits that only in pieces."""
        has = self.kitchen.items[item].predicates
        return self.fries(item) and "isfryable" not in has and "isfryableifcut" in has

    def cooks(self, item: str) -> bool:
        """Whether the item must be cooked."""
        return COOKED in self.wish(item).done - self.kitchen.items[item].predicates

    def fries(self, item: str) -> bool:
        """Whether the item must be fried."""
        return FRIED in self.wish(item).done - self.kitchen.items[item].predicates

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
            wish.at: item
            for item, wish in self.kitchen.wishes.items()
            if wish.on_station and wish.at is not None
        }

    @cached_property
    def piles(self) -> list[tuple[str, str, str]]:
        """(item, item below it, station): what may be put upon what on the way to the goal."""
        wishes = self.kitchen.wishes
        return [
            (upper, lower, wish.at)
            for upper, wish in wishes.items()
            for lower, other in wishes.items()
            if upper != lower
            and wish.at is not None
            and wish.at == other.at
            and not wish.on_station
            and not other.clear
        ]

    @cached_property
    def unpiled(self) -> list[tuple[str, str, str]]:
        """(item, item below it, station) of what lies on something at first and has to be taken."""
        return [
            (item.name, item.below, item.station)
            for item in self.kitchen.items.values()
            if item.below is not None and self.moves(item.name)
        ]

    def moves(self, item: str) -> bool:
        """Whether there may be a reason to take an item from where it lies at first."""
        there = self.kitchen.items[item]
        wish = self.wish(item)
        if self.processing(item) or wish.at not in (None, there.station):
            return True
        if there.below is None:
            return self._in_the_way(item) or self._others_below(item)
        return True

    def _others_below(self, item: str) -> bool:
        """Whether a wish to lie directly on this station is not met by lying here."""
        base = self.based.get(self.kitchen.items[item].station)
        return base not in (None, item)

    def _in_the_way(self, item: str) -> bool:
        """Whether others must be processed where the item lies."""
        station = self.kitchen.items[item].station
        return any(
            station in self.processing(other) for other in self.kitchen.items if other != item
        )

    def laid_aside(self, item: str) -> list[str]:
        """The tables on which an item may be laid for a while: one that lies in others' way."""
        there = self.kitchen.items[item]
        waits = there.below is not None or self._in_the_way(item) or self._others_below(item)
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
        wish = self.wish(item)
        if wish.at is None or self.based.get(wish.at, item) != item:
            return []
        return [wish.at]

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
        wish = self.wish(item)
        if there.below is not None:
            return False
        elsewhere = any(
            there.station not in stations for _, stations in self.worked_at(item)
        ) or wish.at not in (None, there.station)
        return elsewhere or self._others_below(item)
