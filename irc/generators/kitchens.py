"""New kitchens in the form of Robo Challenge, along its seven axes.

At the usual size an axis has the kinds of items, stations and robots of the data; ingredients,
durations, lags and deadlines are drawn. At other sizes the items are drawn from the axis's kinds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from irc.diagnostics import did_you_mean
from irc.errors import OptionError
from irc.generators.dice import Dice


@dataclass(frozen=True)
class Kind:
    """A kind of item: its names, the state that it must reach, and how."""

    names: tuple[str, ...]
    state: str
    actions: tuple[str, ...]
    predicates: tuple[str, ...]
    flag: str | None = None

    def document(self) -> dict[str, Any]:
        """The item as Robo Challenge writes it."""
        flags = {} if self.flag is None else {self.flag: True}
        return {"state": "raw", "predicates": list(self.predicates), **flags}


KINDS: Mapping[str, Kind] = {
    "grilled": Kind(
        ("patty", "salmon", "sausage", "eggplant", "halloumi", "zucchini", "corn", "tuna"),
        "grilled",
        ("grill",),
        ("iscookable",),
    ),
    "marinated": Kind(
        ("chicken", "tofu", "steak", "tempeh", "mushroom", "lamb", "seitan", "pork"),
        "grilled",
        ("cut", "marinate", "grill"),
        ("iscuttable", "ismarinatable", "iscookableifmarinated"),
        "grill_requires_marinated",
    ),
    "fried": Kind(
        ("fish", "falafel", "shrimp", "squid", "dumpling", "spring_roll", "croquette", "egg"),
        "fried",
        ("fry",),
        ("isfryable",),
    ),
    "cut_fried": Kind(
        ("potato", "onion", "okra", "plantain", "parsnip", "pumpkin", "celeriac", "fennel"),
        "fried",
        ("cut", "fry"),
        ("iscuttable", "isfryableifcut"),
        "fry_requires_cut",
    ),
    "mashed": Kind(
        ("yam", "turnip", "cassava", "taro", "swede", "carrot_root", "chickpea", "pea"),
        "mashed",
        ("boil", "mash"),
        ("isboilable",),
        "mash_requires_boiled",
    ),
    "boiled": Kind(
        ("stock", "beans", "rice", "lentils", "noodles", "barley", "millet", "quinoa"),
        "boiled",
        ("boil",),
        ("isboilable",),
    ),
    "cut": Kind(
        ("lettuce", "tomato", "cucumber", "pickle", "radish", "celery", "cabbage", "avocado"),
        "cut",
        ("cut",),
        ("iscuttable",),
    ),
}

READY = {"state": "ready", "predicates": []}

DURATIONS: Mapping[str, tuple[int, int]] = {
    "grill": (8, 12),
    "cut": (2, 4),
    "fry": (6, 10),
    "boil": (10, 14),
    "toast": (4, 6),
    "marinate": (5, 7),
    "mash": (3, 5),
    "stack": (1, 1),
}
"""The least and the greatest duration of each action; their middle is that of the data."""

BUNS = ("bun_bot", "bun_top")
_SMALL = {**dict.fromkeys(("grill", "cutting_board", "fryer", "boiler", "toaster", "marinator"), 1)}


@dataclass(frozen=True)
class Dish:
    """A combination of kinds, with what is ready on the table; `base` goes below, `top` above."""

    name: str
    kinds: tuple[str, ...]
    base: str
    top: str | None = None
    stacked: tuple[int, ...] = ()
    """The positions of the kinds that go onto the dish, from below."""


@dataclass(frozen=True)
class Axis:
    """One of the seven difficulties of Robo Challenge."""

    split: str
    features: tuple[str, ...]
    dishes: tuple[Dish, ...]
    stations: Mapping[str, int] = field(default_factory=lambda: _SMALL)
    robots: tuple[int, ...] = (0,)
    """The number of robots of one instance after the other."""


_EIGHT = ("marinated", "grilled", "cut_fried", "fried", "mashed", "cut", "cut", "boiled")
_FEAST = tuple(kind for kind in KINDS for _ in range(4 if kind == "cut" else 2))

AXES: Mapping[str, Axis] = {
    "easy": Axis(
        "easy",
        ("easy",),
        (
            Dish("grilled_sandwich", ("grilled",), *BUNS, (0,)),
            Dish("burger", ("grilled", "cut"), *BUNS, (0, 1)),
            Dish("bowl", ("boiled",), "bowl", None, (0,)),
            Dish("marinated_plate", ("marinated",), "plate", None, (0,)),
            Dish("breakfast_plate", ("grilled", "mashed"), "plate", None, (0, 1)),
        ),
    ),
    "medium": Axis(
        "medium",
        ("medium",),
        (
            Dish("fried_combo", ("fried", "cut_fried", "cut"), *BUNS, (0, 2)),
            Dish("marinated_combo", ("marinated", "cut_fried", "cut"), *BUNS, (0, 2)),
        ),
    ),
    "high-speedup": Axis(
        "hard_high_speedup",
        ("hard_high_speedup", "high_speedup", "shared_station", "capacity_gt_1"),
        (Dish("feast", _FEAST, "feast_plate"),),
        {**_SMALL, "grill": 3, "cutting_board": 4, "fryer": 3, "boiler": 3, "marinator": 3},
    ),
    "multi-agent": Axis(
        "hard_multiagent",
        ("hard_multiagent", "multiagent", "robot_capacity"),
        (Dish("robot_team_service", _EIGHT, *BUNS, (1, 5, 0, 6)),),
        {**_SMALL, "grill": 3, "cutting_board": 3, "fryer": 2, "boiler": 2, "marinator": 2},
        (3, 2, 2),
    ),
    "optimization": Axis(
        "hard_optimization",
        ("hard_optimization", "deadline", "limited_inventory", "reward_maximization"),
        (Dish("deadline_menu", tuple(KINDS), ""),),
        {**_SMALL, "cutting_board": 2},
        (2,),
    ),
    "station": Axis(
        "hard_station",
        ("hard_station", "shared_station", "capacity_gt_1"),
        (Dish("combo_plate", _EIGHT, *BUNS, (0, 5, 1, 6)),),
        {**_SMALL, "cutting_board": 2, "boiler": 2},
    ),
    "temporal": Axis(
        "hard_temporal",
        ("hard_temporal", "time_lag", "and_join"),
        (
            Dish(
                "rested_combo",
                ("grilled", "mashed", "cut_fried", "cut", "cut", "boiled"),
                *BUNS,
                (0, 3, 4),
            ),
        ),
    ),
}
"""The axes by the names of the command line, with the splits of the data."""

_REWARDS: Mapping[str, tuple[int, Mapping[str, int]]] = {
    "grilled": (9, {"protein": 1}),
    "marinated": (14, {"protein": 1, "fresh": 1}),
    "fried": (8, {"protein": 1, "fryer_oil": 1}),
    "cut_fried": (7, {"fryer_oil": 1, "fresh": 1}),
    "mashed": (10, {"root": 1}),
    "cut": (4, {"fresh": 1}),
    "boiled": (6, {"root": 1}),
}
"""The middle of the reward of a kind, and its cost."""

LEAST_ITEMS, MOST_ITEMS = 2, 200


@dataclass(frozen=True)
class GeneratedKitchen:
    """A kitchen without its gold answer: the document, and the kind of each item to be made."""

    axis: Axis
    number: int
    document: dict[str, Any]
    kinds: Mapping[str, str]


def axis_of(name: str) -> Axis:
    """The axis of a name. Raises `OptionError` with the nearest one."""
    if name not in AXES:
        hint = did_you_mean(name, AXES) or f"known are {', '.join(AXES)}"
        raise OptionError(f"there is no axis {name!r}; {hint}")
    return AXES[name]


def generate_kitchen(name: str, size: int | None, seed: int, index: int) -> GeneratedKitchen:
    """The kitchen `index` (from 0) of an axis and a seed; `size` is its number of items.

    Raises `OptionError` for an unknown axis or a wrong size.
    """
    axis = axis_of(name)
    dice = Dice("robo", name, size or 0, seed, index)
    dish = axis.dishes[index % len(axis.dishes)]
    extras = [part for part in (dish.base, dish.top) if part]
    if size is not None:
        dish = _resized(dish, size - len(extras), dice)
    names = _names(dish.kinds, dice)
    items = {n: KINDS[k].document() for n, k in zip(names, dish.kinds, strict=True)}
    order = [*extras[:1], *(names[k] for k in dish.stacked), *extras[1:]]
    goals = {n: KINDS[k].state for n, k in zip(names, dish.kinds, strict=True)}
    rewarded = name == "optimization"
    robots = axis.robots[index % len(axis.robots)]
    document: dict[str, Any] = {
        "id": f"{axis.split}_{index + 1:02}_{dish.name}_{seed}",
        "split": axis.split,
        "difficulty": axis.split.partition("_")[0],
        "challenge_features": list(axis.features),
        "implicit_style": "rule_based",
        "objective_type": "maximize_reward_under_deadline" if rewarded else "minimize_makespan",
        "affordance_mode": "action_model",
        "items": {**items, **{part: dict(READY) for part in extras}},
        "goal": {"required_states": {} if rewarded else goals, "stack_order": order},
        "action_durations": {a: dice.between(*limits) for a, limits in DURATIONS.items()},
        "stations": dict(axis.stations),
        "temporal_constraints": [],
        **({"robots": [f"robot{k + 1}" for k in range(robots)]} if robots else {}),
    }
    kinds = dict(zip(names, dish.kinds, strict=True))
    if rewarded:
        document |= _menu(kinds, document["action_durations"], dice)
    if name == "temporal":
        document["temporal_constraints"] = _lags(kinds, order, dice)
    return GeneratedKitchen(axis, index + 1, document, kinds)


def _resized(dish: Dish, count: int, dice: Dice) -> Dish:
    """The dish with a number of items of its kinds, as many of each as in the data."""
    if not 1 <= count <= MOST_ITEMS:
        raise OptionError(
            f"a kitchen of this axis has {LEAST_ITEMS} to {MOST_ITEMS} items with what it stacks on"
        )
    kinds: list[str] = []
    while len(kinds) < count:
        kinds += dice.shuffled(dish.kinds)
    share = len(dish.stacked) / len(dish.kinds)
    stacked = dice.shuffled(range(count))[: int(share * count + 0.5)]
    return Dish(dish.name, tuple(kinds[:count]), dish.base, dish.top, tuple(stacked))


def _names(kinds: Sequence[str], dice: Dice) -> list[str]:
    """A name for each item, all different."""
    found: list[str] = []
    pools = {kind: dice.shuffled(KINDS[kind].names) for kind in dict.fromkeys(kinds)}
    used = dict.fromkeys(pools, 0)
    for kind in kinds:
        turn, place = divmod(used[kind], len(pools[kind]))
        used[kind] += 1
        found.append(pools[kind][place] + (str(turn + 1) if turn else ""))
    return found


def _menu(kinds: Mapping[str, str], durations: Mapping[str, int], dice: Dice) -> dict[str, Any]:
    """Candidate goals, a stock that does not suffice for all, and a deadline."""
    goals = []
    for item, kind in kinds.items():
        reward, cost = _REWARDS[kind]
        goals.append(
            {
                "id": f"{KINDS[kind].state}_{item}",
                "item": item,
                "state": KINDS[kind].state,
                "reward": max(1, reward + dice.between(-2, 2)),
                "cost": dict(cost),
            }
        )
    wanted: dict[str, int] = {}
    for kind in kinds.values():
        for stock, amount in _REWARDS[kind][1].items():
            wanted[stock] = wanted.get(stock, 0) + amount
    work = sum(durations[action] for kind in kinds.values() for action in KINDS[kind].actions)
    return {
        "deadline": work * dice.between(28, 36) // 100 + 1,
        "candidate_goals": goals,
        "inventory_limits": {name: max(1, amount * 2 // 3) for name, amount in wanted.items()},
    }


def _lags(kinds: Mapping[str, str], order: Sequence[str], dice: Dice) -> list[dict[str, Any]]:
    """A rest between what makes an item and its stacking, or the stacking of the last one."""
    found = []
    for item, kind in kinds.items():
        if kind not in ("grilled", "mashed", "boiled") or not order:
            continue
        above = item if item in order else order[-1]
        found.append(
            {
                "before": {"action": KINDS[kind].actions[-1], "item": item},
                "after": {"action": "stack", "item": above},
                "min_lag": dice.between(2, 5),
            }
        )
    return found


def sequential_makespan(kitchen: GeneratedKitchen) -> int:
    """The time in which one hand does everything, one action after the other."""
    durations = kitchen.document["action_durations"]
    work = sum(durations[a] for kind in kitchen.kinds.values() for a in KINDS[kind].actions)
    stacked = len(kitchen.document["goal"]["stack_order"])
    return int(work + durations["stack"] * stacked)
