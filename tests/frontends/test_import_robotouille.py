"""The importer of Robotouille: hand-made plans of the game are valid, and cheats are not."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.diagnostics import Code, InputError
from irc.frontends.importers.robotouille import import_robotouille
from irc.model import Task
from irc.schedule import Entry, Schedule

Raw = dict[str, Any]

# table_1 (0,0) with bread_1 and bread_2 on it, board_1 (2,0), fryer_1 (4,0), table_2 (4,2) with
# okra_1; the robot at (0,1), facing table_1.
KITCHEN: Raw = {
    "id": "fries on bread",
    "original_json": {
        "version": "1.0.0",
        "width": 5,
        "height": 3,
        "config": {"num_cuts": {"default": 3, "okra": 2}, "cook_time": {"default": 7}},
        "stations": [
            {"name": "table", "x": 0, "y": 0},
            {"name": "board", "x": 2, "y": 0},
            {"name": "fryer", "x": 4, "y": 0},
            {"name": "table", "x": 4, "y": 2},
        ],
        "items": [
            {"name": "bread", "x": 0, "y": 0, "stack-level": 0},
            {"name": "bread", "x": 0, "y": 0, "stack-level": 1},
            {
                "name": "okra",
                "x": 4,
                "y": 2,
                "stack-level": 0,
                "predicates": ["iscuttable", "isfryableifcut"],
            },
        ],
        "players": [{"name": "robot", "x": 0, "y": 1, "direction": [0, -1]}],
        "goal_description": "Prepare fries on bread",
        "goal": [
            {"predicate": "item_on", "args": ["bread", "table"], "ids": [1, 2]},
            {"predicate": "isfried", "args": ["okra"], "ids": [3]},
            {"predicate": "item_at", "args": ["okra", "table"], "ids": [3, 2]},
            {"predicate": "item_at", "args": ["bread", "table"], "ids": [4, 2]},
            {"predicate": "clear", "args": ["bread"], "ids": [4]},
        ],
    },
    "natural_language": "…",
}
PLAN = """
take_okra_1_table_2 put_okra_1_board_1 cut_okra_1_board_1_1 cut_okra_1_board_1_2
take_okra_1_board_1 put_okra_1_fryer_1 fry_okra_1_fryer_1
unstack_bread_2_bread_1_table_1 put_bread_2_table_2
take_okra_1_fryer_1 stack_okra_1_bread_1_table_1
take_bread_2_table_2 stack_bread_2_okra_1_table_1
""".split()  # noqa: SIM905


def imported(instance: Raw) -> Task:
    ((_, task),) = import_robotouille(json.dumps(instance), "kitchens.json")
    return task


def changed(*path: str | int, value: Any) -> Raw:
    copy: Any = deepcopy(KITCHEN)
    target = copy if path[0] == "natural_language" else copy["original_json"]
    for part in path[:-1]:
        target = target[part]
    if value is None:
        del target[path[-1]]
    else:
        target[path[-1]] = value
    return copy


def station_of(id: str) -> str:
    """The station at which an action takes place, from its name."""
    return re.findall(r"(?:table|board|stove|fryer)_\d+", id)[-1]


def carried_out(task: Task, plan: Iterable[str]) -> Schedule:
    """A plan of the robot's deeds as a schedule: one after the other, each at its place.

    Stoves and fryers run on while the robot does other things, and are waited for.
    """
    actions = {action.id: action for action in task.actions}
    now, place = 0, next(v for v in task.state if v.id == "robot").initial
    busy: dict[str, int] = {}
    count: dict[str, int] = {}
    entries = []

    def do(id: str) -> int:
        action = actions[id]
        count[id] = count.get(id, 0) + 1
        held = dict.fromkeys((use.resource or "" for use in action.uses), 1)
        start = max([now, *(busy.get(name, 0) for name in held)])
        end = start + int(str(action.duration))
        entries.append(Entry(id, start, end, held, occurrence=count[id]))
        return end

    for id in plan:
        wanted = station_of(id)
        if wanted != place:
            now = do(f"move_{place}_{wanted}")
            place = wanted
        end = do(id)
        if id.startswith(("cook", "fry")):
            busy[wanted] = end
        else:
            now = end
    return Schedule(tuple(entries))


def rules(task: Task, schedule: Schedule) -> set[str]:
    return {violation.rule for violation in irc.validate(task, schedule).violations}


# --- what a kitchen becomes ---------------------------------------------------------------------


def test_a_plan_of_the_game_is_a_valid_schedule() -> None:
    task = imported(KITCHEN)
    schedule = carried_out(task, PLAN)
    verdict = irc.validate(task, schedule)
    assert verdict.valid, str(verdict)
    assert verdict.makespan == 42


def test_walking_takes_the_cells_that_are_walked() -> None:
    task = imported(KITCHEN)
    durations = {a.id: a.duration for a in task.actions if a.id.startswith("move")}
    # It stands at (0,1), (2,1), (3,0) and (4,1).
    assert durations["move_table_1_board_1"] == 2
    assert durations["move_board_1_fryer_1"] == durations["move_board_1_table_2"] == 2
    assert durations["move_table_1_fryer_1"] == 4
    assert durations["move_fryer_1_table_2"] == 2
    assert all(durations[f"move_{b}_{a}"] == n for (a, b), n in _pairs(durations).items())


def _pairs(durations: dict[str, Any]) -> dict[tuple[str, str], Any]:
    found = {}
    for id, steps in durations.items():
        one, other = re.findall(r"(?:table|board|stove|fryer)_\d+", id)
        found[one, other] = steps
    return found


def test_each_cut_is_an_action_of_its_own() -> None:
    task = imported(KITCHEN)
    assert [a.id for a in task.actions if a.id.startswith("cut")] == [
        "cut_okra_1_board_1_1",
        "cut_okra_1_board_1_2",
    ]
    without_one = [step for step in PLAN if step != "cut_okra_1_board_1_2"]
    assert rules(task, carried_out(task, without_one)) == {"presence", "state"}


def test_walks_may_be_repeated() -> None:
    task = imported(KITCHEN)
    schedule = carried_out(task, PLAN)
    assert max(e.occurrence for e in schedule.entries if e.id.startswith("move")) > 1


@pytest.mark.parametrize(
    "cheat",
    [
        "two things in one hand",
        "from afar",
        "out of the fryer too early",
        "away while walking",
        "below another",
    ],
)
def test_a_cheat_is_not_valid(cheat: str) -> None:
    task = imported(KITCHEN)
    entries = list(carried_out(task, PLAN).entries)
    by_id = {e.id: e for e in entries}

    def at(id: str, start: Any) -> None:
        entry = by_id[id]
        entries[entries.index(entry)] = replace(
            entry, start=start, end=start + (entry.end - entry.start)
        )

    if cheat == "two things in one hand":
        plan = [step for step in PLAN if step != "put_bread_2_table_2"]
        entries = list(carried_out(task, plan).entries)
    elif cheat == "from afar":
        entries = [e for e in entries if e.id != "move_table_2_board_1"]
    elif cheat == "out of the fryer too early":
        at("take_okra_1_fryer_1", by_id["fry_okra_1_fryer_1"].start + 1)
    elif cheat == "away while walking":
        at("fry_okra_1_fryer_1", by_id["fry_okra_1_fryer_1"].start + 1)
    else:
        plan = [step for step in PLAN if "unstack" not in step and "bread_2_t" not in step]
        entries = list(carried_out(task, plan).entries)
    assert not irc.validate(task, Schedule(tuple(entries))).valid


def test_a_stove_is_started_before_the_robot_leaves_and_runs_by_itself() -> None:
    task = imported(KITCHEN)
    schedule = carried_out(task, PLAN)
    fry = next(e for e in schedule.entries if e.id.startswith("fry"))
    meanwhile = [e for e in schedule.entries if fry.start <= e.start < fry.end and e is not fry]
    assert len(meanwhile) > 2


def test_an_id_of_the_goal_is_one_object_and_two_ids_are_two() -> None:
    task = imported(KITCHEN)
    assert {(g.var, g.value) for g in task.goals if not isinstance(g, str)} == {
        ("fried_okra_1", True),
        ("at_okra_1", "table_1"),
        ("at_bread_2", "table_1"),
        ("top_table_1", "bread_2"),
    }


def test_the_metadata_says_what_is_assumed() -> None:
    assumptions = " ".join(imported(KITCHEN).metadata["assumptions"])
    for word in ("step", "cell", "cut", "stove", "order of the file", "laid aside"):
        assert word in assumptions


def test_an_item_that_is_to_be_uppermost_makes_room_first() -> None:
    room: Any = deepcopy(KITCHEN)
    kitchen = room["original_json"]
    kitchen["stations"].append({"name": "table", "x": 2, "y": 2})
    del kitchen["items"][1]
    kitchen["goal"] = [
        {"predicate": "item_at", "args": ["bread", "table"], "ids": [1, 2]},
        {"predicate": "item_at", "args": ["okra", "table"], "ids": [3, 2]},
        {"predicate": "clear", "args": ["bread"], "ids": [1]},
    ]
    task = imported(room)
    plan = [
        "take_bread_1_table_1",
        "put_bread_1_table_3",
        "take_okra_1_table_2",
        "put_okra_1_table_1",
        "take_bread_1_table_3",
        "stack_bread_1_okra_1_table_1",
    ]
    verdict = irc.validate(task, carried_out(task, plan))
    assert verdict.valid, str(verdict)
    kitchen["goal"][0]["predicate"] = "item_on"
    with pytest.raises(InputError, match="cannot be both directly on 'table_1' and on other items"):
        imported(room)


def test_a_robot_that_faces_no_station_starts_from_its_cell() -> None:
    task = imported(changed("players", 0, "direction", value=[0, 1]))
    assert next(v for v in task.state if v.id == "robot").initial == "start"
    assert not any(a.id.startswith("move_") and a.id.endswith("_start") for a in task.actions)
    assert irc.validate(task, carried_out(task, PLAN)).valid


def test_what_is_done_already_needs_nothing() -> None:
    has = ["iscuttable", "isfryableifcut", "iscut"]
    task = imported(changed("items", 2, "predicates", value=has))
    assert not any(a.id.startswith("cut") for a in task.actions)
    assert all(c.var != "cut_okra_1" for a in task.actions for c in a.conditions)


# --- bad input ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("goal",), None, "the field 'goal' is missing"),
        (("containers",), [], "containers: this importer does not know the field"),
        (("players",), [], "kitchens with one player, found 0"),
        (("players", 0, "x"), 9, "the cell (9, 1) is outside"),
        (("players", 0, "y"), 0, "on the cell (0, 0) of a station"),
        (("players", 0, "direction"), "up", "expected a list"),
        (("players", 0, "direction"), [3], "expected a direction"),
        (("stations", 1, "name"), "sink", "there is no kind of station 'sink'"),
        (("stations", 1, "x"), 0, "two stations stand on the cell (0, 0)"),
        (("stations", 2), {"name": "stove", "x": 4, "y": 0}, "no station for it"),
        (("items", 2, "x"), 3, "there is no station on the cell (3, 2)"),
        (("items", 1, "stack-level"), 0, "two items lie on 'table_1' at the level 0"),
        (("items", 1, "stack-level"), 2, "with nothing below it"),
        (("items", 2, "predicates"), ["iscuttable"], "cannot be fried: it is not isfryable"),
        (("items", 2, "predicates"), ["isboilable"], "there is no predicate 'isboilable'"),
        (("items", 2, "name"), "board", "cannot have the name of a kind of station, 'board'"),
        (("config", "num_cuts"), None, "the field 'num_cuts' is missing"),
        (("config", "num_cuts", "default"), 0, "1 or more, found 0"),
        (("config", "cook_time", "default"), 10**7, "at most 1000 are allowed"),
        (("width",), 5000, "at most 100 cells"),
        (
            ("stations",),
            [{"name": "table", "x": 0, "y": 0}] * 61,
            "at most 60 are allowed, found 61",
        ),
        (("width",), "five", "expected a whole number"),
        (("goal", 1, "predicate"), "isboiling", "there is no goal predicate"),
        (("goal", 1, "args"), ["water"], "the kitchen has no 'water' for the id 3"),
        (("goal", 1, "ids"), [1], "the id 1 means both 'bread_1' and a 'okra'"),
        (("goal", 1, "ids"), [1, 2], "'args' and 'ids' are not of one length"),
        (("goal", 2, "ids"), [3, 5], "cannot both"),
        (("goal", 3, "predicate"), "item_on", "cannot both be directly on 'table_1'"),
    ],
)
def test_a_fault_is_told_with_instance_and_field(
    path: tuple[str | int, ...], value: Any, message: str
) -> None:
    bad = changed(*path, value=value)
    if message == "cannot both":
        assert imported(bad).goals  # Another table for the okra is no fault.
        return
    with pytest.raises(InputError) as refused:
        imported(bad)
    told = list(refused.value.report)
    assert {d.code for d in told} == {Code.NOT_AN_IMPORT}
    assert any(message in d.message for d in told), [d.message for d in told]
    assert all("'fries on bread'" in d.message for d in told)


def test_a_station_that_cannot_be_reached_is_told() -> None:
    walls = [{"name": "table", "x": 3, "y": y} for y in range(3)]
    bad: Any = deepcopy(KITCHEN)
    bad["original_json"]["stations"] += walls
    with pytest.raises(InputError) as refused:
        imported(bad)
    assert any("the robot cannot get to 'fryer_1'" in d.message for d in refused.value.report)


# --- the benchmark ------------------------------------------------------------------------------


# By instance: the base and the lid of the dish, and each item with the table where it lies at
# first, what is done to it, and where it goes: upon the dish, or to a table of its own.
RECIPES: dict[str, tuple[str, str, list[tuple[str, str, list[str], str]]]] = {
    "0_cheese_chicken_sandwich": (
        "bread_1",
        "bread_2",
        [("chicken_1", "table_2", ["cook"], "dish"), ("cheese_1", "table_3", [], "dish")],
    ),
    "1_lettuce_chicken_sandwich": (
        "bread_1",
        "bread_2",
        [("chicken_1", "table_2", ["cook"], "dish"), ("lettuce_1", "table_3", ["cut"], "dish")],
    ),
    "2_lettuce_tomato_fried_chicken_sandwich": (
        "bread_1",
        "bread_2",
        [
            ("chicken_1", "table_2", ["fry"], "dish"),
            ("lettuce_1", "table_3", ["cut"], "dish"),
            ("tomato_1", "table_4", ["cut"], "dish"),
        ],
    ),
    "3.1_lettuce_cheeseburger": (
        "bottombun_1",
        "topbun_1",
        [
            ("patty_1", "table_3", ["cook"], "dish"),
            ("lettuce_1", "table_4", ["cut"], "dish"),
            ("cheese_1", "table_2", [], "dish"),
        ],
    ),
    "3_tomato_burger_and_fries": (
        "bottombun_1",
        "topbun_1",
        [
            ("patty_1", "table_3", ["cook"], "dish"),
            ("tomato_1", "table_4", ["cut"], "dish"),
            ("potato_1", "table_2", ["cut", "fry"], "table_2"),
        ],
    ),
    "4_onion_cheese_burger_and_fried_onion": (
        "bottombun_1",
        "topbun_1",
        [
            ("patty_1", "table_3", ["cook"], "dish"),
            ("onion_1", "table_2", ["cut"], "dish"),
            ("cheese_1", "table_5", [], "dish"),
            ("onion_2", "table_4", ["cut", "fry"], "table_2"),
        ],
    ),
}
WORK = {
    "cook": ("stove_1", ["cook_{}_stove_1"]),
    "fry": ("fryer_1", ["fry_{}_fryer_1"]),
    "cut": ("board_1", [f"cut_{{}}_board_1_{n}" for n in (1, 2, 3)]),
}


def plan_of(base: str, lid: str, items: list[tuple[str, str, list[str], str]]) -> list[str]:
    """Takes the lid off while the first item cooks, lays it where that item was, and goes on."""
    plan: list[str] = []
    pile, aside = base, items[0][1]
    for item, table, works, goes in items:
        plan.append(f"take_{item}_{table}")
        for work in works:
            station, deeds = WORK[work]
            plan += [f"put_{item}_{station}", *(deed.format(item) for deed in deeds)]
            if pile == base and table == aside:
                plan += [f"unstack_{lid}_{base}_table_1", f"put_{lid}_{aside}"]
            plan.append(f"take_{item}_{station}")
        if goes == "dish":
            plan.append(f"stack_{item}_{pile}_table_1")
            pile = item
        else:
            plan.append(f"put_{item}_{goes}")
    return [*plan, f"take_{lid}_{aside}", f"stack_{lid}_{pile}_table_1"]


@pytest.fixture(scope="module")
def benchmark(shared_data: Path) -> dict[str, Task]:
    text = (shared_data / "robotouille_6.json").read_text("utf-8")
    return dict(import_robotouille(text, "robotouille_6.json"))


@pytest.mark.slow
@pytest.mark.shared_data
@pytest.mark.parametrize("name", RECIPES)
def test_a_hand_made_plan_of_the_benchmark_is_valid(benchmark: dict[str, Task], name: str) -> None:
    task = benchmark[name]
    assert not irc.check(task).diagnostics
    plan = plan_of(*RECIPES[name])
    verdict = irc.validate(task, carried_out(task, plan))
    assert verdict.valid, str(verdict)
    for dropped in plan:
        shorter = [step for step in plan if step != dropped]
        assert not irc.validate(task, carried_out(task, shorter)).valid, dropped


@pytest.mark.shared_data
def test_the_whole_benchmark_is_imported(benchmark: dict[str, Task]) -> None:
    assert list(benchmark) == list(RECIPES)
