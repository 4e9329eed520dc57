"""Reads Robotouille JSON as a typed kitchen, every fault located."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from irc.frontends.importers.instances import Part
from irc.frontends.importers.robotouille.grid import LARGEST_SIDE, Cell

TABLE, BOARD, STOVE, FRYER = "table", "board", "stove", "fryer"
STATION_KINDS = (TABLE, BOARD, STOVE, FRYER)

ABLE = ("iscuttable", "iscookable", "isfryable", "isfryableifcut")
DONE = ("iscut", "iscooked", "isfried")
PLACED = ("item_on", "item_at")
CLEAR = "clear"
GOALS = (*PLACED, *DONE, CLEAR)

_CONTENT = (
    "width",
    "height",
    "config",
    "stations",
    "items",
    "players",
    "goal",
)
_MOST_CUTS = 1000
_MOST_STATIONS = 60
_MOST_ITEMS = 60
"""Limits on kitchens: walks and stacks need an action for each pair, so tasks grow quickly."""


@dataclass(frozen=True)
class Item:
    """An item: its first station, the item below it (None: the station), its predicates."""

    name: str
    station: str
    below: str | None
    predicates: frozenset[str]
    cuts: int
    cook_time: int


@dataclass
class ItemGoal:
    """The goal for one item."""

    done: set[str] = field(default_factory=set)
    at: str | None = None
    on_station: bool = False
    clear: bool = False


@dataclass(frozen=True)
class KitchenTask:
    """An instance as read. `stations` and `items` are in the file's order, by their own names."""

    id: str
    description: str | None
    width: int
    height: int
    stations: Mapping[str, Cell]
    kinds: Mapping[str, str]
    items: Mapping[str, Item]
    start: Cell
    facing: Cell
    item_goals: Mapping[str, ItemGoal]
    goal: Part
    part: Part

    def of_kind(self, kind: str) -> list[str]:
        """The stations of one kind."""
        return [name for name, found in self.kinds.items() if found == kind]


def read_kitchen_task(instance: Part) -> KitchenTask | None:
    """The instance, or None after its faults have been recorded."""
    found = len(instance.faults.findings.items)
    outer = instance.record(("id", "original_json"), ("natural_language",))
    if "original_json" not in outer:
        return None
    content = outer["original_json"]
    fields = content.record(_CONTENT, ("version", "goal_description"))
    if len(instance.faults.findings.items) > found:
        return None
    width, height = (_side(fields[key]) for key in ("width", "height"))
    stations, kinds = _stations(fields["stations"], width, height)
    items = _items(fields["items"], stations, fields["config"])
    start, facing = _robot(fields["players"], width, height, stations)
    item_goals = _Binder(stations, kinds, items).item_goals(fields["goal"])
    if len(instance.faults.findings.items) > found:
        return None
    description = fields["goal_description"].text() if "goal_description" in fields else None
    name = outer["id"].text() or instance.owner
    return KitchenTask(
        name,
        description,
        width,
        height,
        stations,
        kinds,
        items,
        start,
        facing,
        item_goals,
        fields["goal"],
        instance,
    )


def _side(part: Part) -> int:
    side = part.whole(1) or 1
    if side > LARGEST_SIDE:
        part.fault(f"at most {LARGEST_SIDE} cells are allowed, found {side}")
        return 1
    return side


def _cell(fields: Mapping[str, Part], width: int, height: int) -> Cell | None:
    x = fields["x"].whole() if "x" in fields else None
    y = fields["y"].whole() if "y" in fields else None
    if x is None or y is None:
        return None
    if x >= width or y >= height:
        fields["x"].fault(f"the cell ({x}, {y}) is outside of the {width} x {height} kitchen")
        return None
    return x, y


def _at_most(most: int, part: Part) -> list[Part]:
    """The entries of a list; none, and a fault, if there are more than `most`."""
    items = part.items()
    if len(items) > most:
        part.fault(f"at most {most} are allowed, found {len(items)}")
        return []
    return items


def numbered(names: Iterable[str]) -> list[str]:
    """Numbered names in order: "table_1", "stove_1", "table_2"."""
    counts: Counter[str] = Counter()
    made = []
    for name in names:
        counts[name] += 1
        made.append(f"{name}_{counts[name]}")
    return made


def _stations(part: Part, width: int, height: int) -> tuple[dict[str, Cell], dict[str, str]]:
    read: list[tuple[str, Cell, Part]] = []
    for inner in _at_most(_MOST_STATIONS, part):
        fields = inner.record(("name", "x", "y"), ())
        kind = fields["name"].one_of(STATION_KINDS, "kind of station") if "name" in fields else None
        cell = _cell(fields, width, height)
        if kind is None or cell is None:
            continue
        if cell in [other for _, other, _ in read]:
            inner.fault(f"two stations stand on the cell {cell}")
            continue
        read.append((kind, cell, inner))
    names = numbered(kind for kind, _, _ in read)
    return (
        {name: cell for name, (_, cell, _) in zip(names, read, strict=True)},
        {name: kind for name, (kind, _, _) in zip(names, read, strict=True)},
    )


def _items(part: Part, stations: Mapping[str, Cell], config: Part) -> dict[str, Item]:
    at = {cell: name for name, cell in stations.items()}
    parts = _at_most(_MOST_ITEMS, part)
    read = [inner.record(("name", "x", "y", "stack-level"), ("predicates",)) for inner in parts]
    kinds = [fields["name"].text() if "name" in fields else None for fields in read]
    names = numbered(kind or "?" for kind in kinds)
    lying: dict[str, dict[int, str]] = {}
    where: dict[str, tuple[str, int]] = {}
    for inner, fields, name in zip(parts, read, names, strict=True):
        cell = _cell(fields, LARGEST_SIDE, LARGEST_SIDE)
        level = fields["stack-level"].whole() if "stack-level" in fields else None
        if cell is None or level is None:
            continue
        if cell not in at:
            inner.fault(f"there is no station on the cell {cell} for {name!r} to lie on")
        elif level in lying.setdefault(at[cell], {}):
            inner.fault(f"two items lie on {at[cell]!r} at the level {level}")
        else:
            lying[at[cell]][level] = name
            where[name] = (at[cell], level)
    times = _config(config)
    items = {}
    for inner, fields, name, kind in zip(parts, read, names, kinds, strict=True):
        if name not in where or kind is None:
            continue
        if kind in STATION_KINDS:
            inner.fault(f"an item cannot have the name of a kind of station, {kind!r}")
        station, level = where[name]
        if level and level - 1 not in lying[station]:
            inner.fault(f"{name!r} lies at the level {level} of {station!r}, with nothing below it")
        predicates = [
            p.one_of((*ABLE, *DONE), "predicate")
            for p in (fields["predicates"].items() if "predicates" in fields else ())
        ]
        items[name] = Item(
            name,
            station,
            lying[station].get(level - 1),
            frozenset(p for p in predicates if p),
            times["num_cuts"].get(kind, times["num_cuts"]["default"]),
            times["cook_time"].get(kind, times["cook_time"]["default"]),
        )
    return items


def _config(part: Part) -> dict[str, dict[str, int]]:
    """The numbers of cuts and of steps of cooking, by kind of item and by default."""
    fields = part.record(("num_cuts", "cook_time"), ())
    # These defaults are used only after a fault.
    read: dict[str, dict[str, int]] = {"num_cuts": {"default": 1}, "cook_time": {"default": 1}}
    for key, inner in fields.items():
        if key not in read:
            continue
        read[key].update(
            (kind, count)
            for kind, number in inner.record(("default",), inner.members()).items()
            if (count := number.whole(1)) is not None
        )
        for kind, count in read[key].items():
            if count > _MOST_CUTS:
                inner.fault(f"at most {_MOST_CUTS} are allowed, found {count} for {kind!r}")
    return read


def _robot(part: Part, width: int, height: int, stations: Mapping[str, Cell]) -> tuple[Cell, Cell]:
    """(the cell of the robot, the cell that it faces)."""
    players = part.items()
    if len(players) != 1:
        part.fault(f"this importer reads kitchens with one player, found {len(players)}")
    for robot in players[:1]:
        fields = robot.record(("x", "y"), ("name", "direction"))
        cell = _cell(fields, width, height)
        steps = fields["direction"].items() if "direction" in fields else []
        way = [step.value for step in steps]
        if len(way) not in (0, 2) or any(step not in (-1, 0, 1) for step in way):
            fields["direction"].fault("expected a direction such as [0, -1]")
            way = []
        if cell is None:
            break
        if cell in stations.values():
            robot.fault(f"the player stands on the cell {cell} of a station")
        x, y = (*way, 0, 0)[:2]
        return cell, (cell[0] + x, cell[1] + y)
    return (0, 0), (0, 0)


class _Binder:
    """Binds the goal's ids to objects.

    An id means some object of its kind, the same at every use. Ids in the order of the goal are
    bound to objects in the order of the file, as in the text of each instance; a plan for this
    binding is a plan for the goal.
    """

    def __init__(
        self, stations: Mapping[str, Cell], kinds: Mapping[str, str], items: Mapping[str, Item]
    ) -> None:
        self.stations = stations
        self.items = items
        self.free = {
            **_by_kind(kinds.items()),
            **_by_kind((name, name.rpartition("_")[0]) for name in items),
        }
        self.bound: dict[int, str] = {}

    def item_goals(self, goal: Part) -> dict[str, ItemGoal]:
        item_goals: dict[str, ItemGoal] = {}
        for part in goal.items():
            fields = part.record(("predicate", "args", "ids"), ())
            predicate = (
                fields["predicate"].one_of(GOALS, "goal predicate that this importer supports")
                if "predicate" in fields
                else None
            )
            objects = self._objects(part, fields)
            if predicate is None or objects is None:
                continue
            if len(objects) != (2 if predicate in PLACED else 1) or objects[0] not in self.items:
                part.fault(f"{predicate!r} does not fit the arguments {', '.join(objects)}")
                continue
            self._set_goal(part, predicate, objects, item_goals.setdefault(objects[0], ItemGoal()))
        return item_goals

    def _set_goal(self, part: Part, predicate: str, objects: list[str], wanted: ItemGoal) -> None:
        if predicate in DONE:
            wanted.done.add(predicate)
        elif predicate == CLEAR:
            wanted.clear = True
        elif objects[1] not in self.stations:
            part.fault(f"{predicate!r} needs a station, not {objects[1]!r}")
        elif wanted.at not in (None, objects[1]):
            part.fault(f"the goal wants {objects[0]!r} both at {wanted.at!r} and at {objects[1]!r}")
        else:
            wanted.at = objects[1]
            wanted.on_station |= predicate == "item_on"

    def _objects(self, part: Part, fields: Mapping[str, Part]) -> list[str] | None:
        if "args" not in fields or "ids" not in fields:
            return None
        kinds = [arg.text() for arg in fields["args"].items()]
        ids = [number.whole() for number in fields["ids"].items()]
        if len(kinds) != len(ids):
            part.fault("'args' and 'ids' are not of one length")
            return None
        found = [
            self._object(part, kind, number)
            for kind, number in zip(kinds, ids, strict=True)
            if kind is not None and number is not None
        ]
        return None if None in found or len(found) < len(ids) else [o for o in found if o]

    def _object(self, part: Part, kind: str, number: int) -> str | None:
        if number not in self.bound:
            if not self.free.get(kind):
                part.fault(f"the kitchen has no {kind!r} for the id {number}")
                return None
            self.bound[number] = self.free[kind].pop(0)
        name = self.bound[number]
        if name.rpartition("_")[0] != kind:
            part.fault(f"the id {number} means both {name!r} and a {kind!r}")
            return None
        return name


def _by_kind(pairs: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for name, kind in pairs:
        found.setdefault(kind, []).append(name)
    return found
