"""Builds the IR task of a kitchen: its variables, its ground actions, and the goal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from irc.frontends.importers.instances import without_empty
from irc.frontends.importers.robotouille.chores import CUT, Chores
from irc.frontends.importers.robotouille.document import FRYER, STOVE, KitchenTask
from irc.frontends.importers.robotouille.goals import unmet_goals
from irc.frontends.importers.robotouille.grid import (
    Cell,
    Floor,
    standing_cells,
    walking_times,
)
from irc.model import Task

ROBOT, HAND = "robot", "hand"
WALKING, EMPTY, NOTHING, IN_HAND, SURFACE, START = (
    "walking",
    "empty",
    "nothing",
    "hand",
    "station",
    "start",
)
_RUNS_ALONE = {"cook": ("cooked", STOVE), "fry": ("fried", FRYER)}

ASSUMPTIONS = (
    "One time unit is one step of the game.",
    "Each station is served from one cell beside it. A walk takes a step for each cell walked,"
    " and one step where only the robot's direction changes.",
    "Taking, putting, stacking, unstacking and each single cut take one step of the robot.",
    "A stove or fryer is started by the robot, with an empty hand, in no time, and then runs by"
    " itself; meanwhile nothing can be taken out of it.",
    "The objects of the goal are bound in the order of the file.",
    "An item is put at most once on each station and each other item. It is laid aside only on a"
    " table, and only where it lies on another item at first or in the way of another's work.",
    "Items are stacked only where the goal wants both of them.",
)

Raw = dict[str, Any]


def robotouille_task(kitchen: KitchenTask) -> Task | None:
    """The IR task, or None after faults have been recorded: a goal that no action can reach."""
    chores = Chores(kitchen)
    builder = _Builder(kitchen, chores)
    unreachable = [name for name in builder.visited if builder.cells[name] is None]
    said = [
        *unmet_goals(chores),
        *(f"the robot cannot get to {name!r}" for name in unreachable),
    ]
    for message in said:
        kitchen.goal.fault(message)
    if said:
        return None
    return Task.model_validate(
        without_empty(
            {
                "name": kitchen.id,
                **({} if kitchen.description is None else {"description": kitchen.description}),
                "metadata": builder.metadata(),
                "resources": [{"id": ROBOT}, *({"id": s} for s in builder.running)],
                "state": list(builder.state()),
                "actions": list(builder.actions()),
                "goals": list(builder.goals()),
            }
        )
    )


def _start(var: str, value: Any) -> Raw:
    return {"at": "start", "var": var, "value": value}


def _end(var: str, value: Any) -> Raw:
    return {"at": "end", "var": var, "value": value}


def _by_robot(id: str, conditions: list[Raw], effects: list[Raw], occurs: Any, **more: Any) -> Raw:
    """An action of the robot, which does nothing else meanwhile, so start conditions suffice."""
    return {
        "id": id,
        "duration": 1,
        "occurs": occurs,
        "uses": [{"resource": ROBOT}],
        "conditions": conditions,
        "effects": effects,
        **more,
    }


@dataclass(frozen=True)
class _Builder:
    kitchen: KitchenTask
    chores: Chores

    # --- what there is ---------------------------------------------------------------------------

    @cached_property
    def floor(self) -> Floor:
        """The cells on which the robot can walk."""
        kitchen = self.kitchen
        return Floor(kitchen.width, kitchen.height, kitchen.stations.values())

    @cached_property
    def faced(self) -> str | None:
        """The station that the robot faces at first, if it faces one."""
        at = {cell: name for name, cell in self.kitchen.stations.items()}
        return at.get(self.kitchen.facing)

    @cached_property
    def cells(self) -> Mapping[str, Cell | None]:
        """The cell of the robot at each station."""
        return standing_cells(self.floor, self.kitchen.stations, self.kitchen.start, self.faced)

    @cached_property
    def first_place(self) -> str:
        """The first place of the robot."""
        return self.faced or START

    @cached_property
    def visited(self) -> list[str]:
        """The stations at which some action takes place."""
        chores = self.chores
        used = {s for i in self.kitchen.items for s in (*chores.puts(i), *chores.takes(i))}
        used |= {s for i in self.kitchen.items for s in chores.processing(i)}
        used |= {station for _, _, station in (*chores.piles, *chores.unpiled)}
        return [name for name in self.kitchen.stations if name in used]

    @cached_property
    def running(self) -> list[str]:
        """The stations that run by themselves, as resources."""
        kinds = self.kitchen.kinds
        return [name for name in self.visited if kinds[name] in (STOVE, FRYER)]

    @cached_property
    def stacked_on(self) -> dict[str, list[str]]:
        """The items that may lie below an item, for items for which that matters.

        It matters if the item is taken off another one, and if it may lie either on a station from
        which it is taken or on an item there. Otherwise the uppermost item of a station suffices.
        """
        chores = self.chores
        unsure = {upper for upper, _, _ in chores.unpiled}
        unsure |= {upper for upper, _, at in chores.piles if at in chores.takes(upper)}
        found: dict[str, dict[str, None]] = {}
        for upper, lower, _ in (*chores.unpiled, *chores.piles):
            if upper in unsure:
                found.setdefault(upper, {})[lower] = None
        return {upper: list(lowers) for upper, lowers in found.items()}

    @cached_property
    def located(self) -> list[str]:
        """The items whose place the goal asks for and that may be moved."""
        return [
            item
            for item, wanted in self.kitchen.item_goals.items()
            if wanted.at is not None and self.chores.moves(item)
        ]

    # --- variables -------------------------------------------------------------------------------

    def state(self) -> Iterator[Raw]:
        kitchen = self.kitchen
        places = list(dict.fromkeys([self.first_place, *self.visited]))
        yield {"id": ROBOT, "values": [*places, WALKING], "initial": self.first_place}
        moved = [item for item in kitchen.items if self.chores.moves(item)]
        yield {"id": HAND, "values": [EMPTY, *moved], "initial": EMPTY}
        for station in self.visited:
            yield self._top(station)
        for item, lowers in self.stacked_on.items():
            below = kitchen.items[item].below
            values = list(dict.fromkeys([SURFACE, *lowers]))
            yield {"id": f"below_{item}", "values": values, "initial": below or SURFACE}
        for item in self.located:
            stations = [s for i, _, s in self.chores.piles if i == item]
            values = [kitchen.items[item].station, *self.chores.puts(item), *stations, IN_HAND]
            first = kitchen.items[item].station
            yield {"id": f"at_{item}", "values": list(dict.fromkeys(values)), "initial": first}
        for item in kitchen.items:
            yield from self._done(item)

    def _top(self, station: str) -> Raw:
        kitchen, chores = self.kitchen, self.chores
        there = [i.name for i in kitchen.items.values() if i.station == station]
        covered = {kitchen.items[name].below for name in there}
        (top,) = [name for name in there if name not in covered] or [NOTHING]
        later = [i for i in kitchen.items if station in chores.puts(i)]
        piled = [upper for upper, _, at in chores.piles if at == station]
        values = list(dict.fromkeys([NOTHING, *there, *later, *piled]))
        return {"id": f"top_{station}", "values": values, "initial": top}

    def _done(self, item: str) -> Iterator[Raw]:
        cuts = self.chores.cuts(item)
        if cuts:
            yield {
                "id": f"cut_{item}",
                "values": [str(n) for n in range(cuts + 1)],
                "initial": "0",
            }
        for what, _ in self.chores.worked_at(item):
            if what in _RUNS_ALONE:
                yield {"id": f"{_RUNS_ALONE[what][0]}_{item}"}

    # --- actions ---------------------------------------------------------------------------------

    def actions(self) -> Iterator[Raw]:
        yield from self._moves()
        for item in self.kitchen.items:
            yield from (self._take(item, station) for station in self.chores.takes(item))
            yield from (self._put(item, station) for station in self.chores.puts(item))
        yield from (self._unstack(*pile) for pile in self.chores.unpiled)
        yield from (self._stack(*pile) for pile in self.chores.piles)
        for item in self.kitchen.items:
            for what, stations in self.chores.worked_at(item):
                for station in stations:
                    yield from (
                        self._cuts(item, station, stations)
                        if what == "cut"
                        else [self._run(what, item, station, stations)]
                    )

    def _moves(self) -> Iterator[Raw]:
        """The walks from each station to each other one."""
        places = {name: cell for name in self.visited if (cell := self.cells[name]) is not None}
        places.setdefault(self.first_place, self.kitchen.start)
        for (one, other), steps in walking_times(self.floor, places).items():
            if other not in self.visited:
                continue  # No plan goes back to a place without actions.
            yield _by_robot(
                f"move_{one}_{other}",
                [_start(ROBOT, one)],
                [{"at": "start", "var": ROBOT, "value": WALKING}, _end(ROBOT, other)],
                {"min": 0},
            ) | {"duration": steps}

    def _uses(self, station: str) -> Raw:
        held = [{"resource": station}] if station in self.running else []
        return {"uses": [{"resource": ROBOT}, *held]}

    def _take(self, item: str, station: str) -> Raw:
        conditions = [_start(ROBOT, station), _start(HAND, EMPTY), _start(f"top_{station}", item)]
        if item in self.stacked_on:
            conditions.append(_start(f"below_{item}", SURFACE))
        effects = [_end(HAND, item), _end(f"top_{station}", NOTHING), *self._goes(item, IN_HAND)]
        return _by_robot(
            f"take_{item}_{station}",
            conditions,
            effects,
            self._how_often_taken(item, station),
            **self._uses(station),
        )

    def _put(self, item: str, station: str) -> Raw:
        effects = [_end(HAND, EMPTY), _end(f"top_{station}", item), *self._goes(item, station)]
        if item in self.stacked_on:
            effects.append(_end(f"below_{item}", SURFACE))
        return _by_robot(
            f"put_{item}_{station}",
            [_start(ROBOT, station), _start(HAND, item), _start(f"top_{station}", NOTHING)],
            effects,
            "once" if self._only_station(item, station) else "optional",
            **self._uses(station),
        )

    def _unstack(self, item: str, below: str, station: str) -> Raw:
        return _by_robot(
            f"unstack_{item}_{below}_{station}",
            [
                _start(ROBOT, station),
                _start(HAND, EMPTY),
                _start(f"top_{station}", item),
                _start(f"below_{item}", below),
            ],
            [_end(HAND, item), _end(f"top_{station}", below), *self._goes(item, IN_HAND)],
            "optional",
            **self._uses(station),
        )

    def _stack(self, item: str, below: str, station: str) -> Raw:
        return _by_robot(
            f"stack_{item}_{below}_{station}",
            [_start(ROBOT, station), _start(HAND, item), _start(f"top_{station}", below)],
            [
                _end(HAND, EMPTY),
                _end(f"top_{station}", item),
                *([_end(f"below_{item}", below)] if item in self.stacked_on else []),
                *self._goes(item, station),
            ],
            "optional",
            **self._uses(station),
        )

    def _cuts(self, item: str, station: str, stations: list[str]) -> Iterator[Raw]:
        """One action for each cut, the n-th after n - 1 others."""
        for n in range(self.chores.cuts(item)):
            yield _by_robot(
                f"cut_{item}_{station}_{n + 1}",
                [
                    _start(ROBOT, station),
                    _start(HAND, EMPTY),
                    _start(f"top_{station}", item),
                    _start(f"cut_{item}", str(n)),
                ],
                [_end(f"cut_{item}", str(n + 1))],
                "once" if len(stations) == 1 else "optional",
            )

    def _run(self, what: str, item: str, station: str, stations: list[str]) -> Raw:
        """The actions of a stove or fryer: the robot starts it, then it runs by itself."""
        conditions = [_start(ROBOT, station), _start(HAND, EMPTY), _start(f"top_{station}", item)]
        if what == "fry" and self.chores.fried_only_when_cut(item) and self.chores.cuts(item):
            conditions.append(_start(f"cut_{item}", str(self.chores.cuts(item))))
        return {
            "id": f"{what}_{item}_{station}",
            "duration": self.kitchen.items[item].cook_time,
            "occurs": "once" if len(stations) == 1 else "optional",
            "uses": [{"resource": station}],
            "conditions": conditions,
            "effects": [_end(f"{_RUNS_ALONE[what][0]}_{item}", True)],
        }

    def _goes(self, item: str, where: str) -> list[Raw]:
        return [_end(f"at_{item}", where)] if item in self.located else []

    def _only_station(self, item: str, station: str) -> bool:
        """Whether an item must be put on just this station to be processed."""
        there = self.kitchen.items[item].station
        return station != there and any(
            stations == [station] for _, stations in self.chores.worked_at(item)
        )

    def _how_often_taken(self, item: str, station: str) -> str:
        """How often an item is taken from a station: once if it must leave and is put there at most
        once, else at most once.
        """
        there = self.kitchen.items[item]
        if station == there.station and self.chores.leaves(item):
            return "once" if station not in self.chores.puts(item) else "optional"
        at = self.chores.wanted(item).at
        others = [s for _, s in self.chores.worked_at(item) if station not in s]
        leaves = at not in (None, station) or bool(others)
        return "once" if self._only_station(item, station) and leaves else "optional"

    # --- the goal --------------------------------------------------------------------------------

    def goals(self) -> Iterator[Raw]:
        for item, wanted in self.kitchen.item_goals.items():
            if item in self.located:
                yield {"var": f"at_{item}", "value": wanted.at}
                if wanted.on_station and item in self.stacked_on:
                    yield {"var": f"below_{item}", "value": SURFACE}
            if wanted.clear and wanted.at in self.visited:
                yield {"var": f"top_{wanted.at}", "value": item}
            cuts = self.chores.cuts(item)
            if cuts and CUT in wanted.done:
                yield {"var": f"cut_{item}", "value": str(cuts)}
            if self.chores.cooks(item):
                yield {"var": f"cooked_{item}", "value": True}
            if self.chores.fries(item):
                yield {"var": f"fried_{item}", "value": True}

    def metadata(self) -> Raw:
        kitchen = self.kitchen
        idle = [
            i for i in kitchen.items if not self.chores.moves(i) and i not in kitchen.item_goals
        ]
        return {
            "id": kitchen.id,
            "assumptions": list(ASSUMPTIONS),
            **({"items_left_alone": idle} if idle else {}),
        }
