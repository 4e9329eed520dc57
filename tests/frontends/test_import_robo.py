"""The importer of Robo Challenge: its tasks are the benchmark's, judged by the benchmark's answers.

Every witness plan must be a valid schedule of the imported task with the stated optimum, and a
damaged one must not be.
"""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.diagnostics import Code, InputError
from irc.frontends.importers.robo import import_robo
from irc.model import Task
from irc.model.canonical import written_task
from irc.schedule import Entry, Schedule
from oracles.robo_witness import STATION, as_once_task, witness_schedule
from runs import run_irc

Raw = dict[str, Any]
ACTIONS = (*STATION, "stack")

INSTANCE: Raw = {
    "id": "plate",
    "objective_type": "minimize_makespan",
    "items": {
        "potato": {"state": "raw", "predicates": ["isboilable"], "mash_requires_boiled": True},
        "tofu": {
            "state": "raw",
            "predicates": ["iscuttable", "ismarinatable", "iscookableifmarinated"],
            "grill_requires_marinated": True,
        },
        "okra": {
            "state": "raw",
            "predicates": ["iscuttable", "isfryableifcut"],
            "fry_requires_cut": True,
        },
        "plate": {"state": "ready", "predicates": []},
    },
    "goal": {
        "required_states": {"potato": "mashed", "tofu": "grilled", "okra": "fried"},
        "stack_order": ["plate", "tofu"],
    },
    "action_durations": {
        "grill": 10.0,
        "cut": 3.0,
        "fry": 8.0,
        "boil": 12.0,
        "marinate": 6.5,
        "mash": 4.0,
        "stack": 1.0,
    },
    "stations": {"grill": 1, "cutting_board": 2, "fryer": 1, "boiler": 1, "marinator": 1},
    "temporal_constraints": [
        {
            "before": {"action": "grill", "item": "tofu"},
            "after": {"action": "stack", "item": "tofu"},
            "min_lag": 5,
        }
    ],
}
MENU: Raw = {
    **{key: value for key, value in INSTANCE.items() if key != "temporal_constraints"},
    "objective_type": "maximize_reward_under_deadline",
    "goal": {"required_states": {}, "stack_order": []},
    "robots": ["robot1", "robot2"],
    "deadline": 24,
    "candidate_goals": [
        {"id": "mash", "item": "potato", "state": "mashed", "reward": 5, "cost": {"root": 1}},
        {"id": "fry", "item": "okra", "state": "fried", "reward": 3, "cost": {"oil": 2}},
    ],
    "inventory_limits": {"root": 1, "oil": 1},
}


def imported(*instances: Raw) -> list[Task]:
    text = json.dumps(instances[0] if len(instances) == 1 else list(instances))
    return [task for _, task in import_robo(text, "robo.json")]


def changed(instance: Raw, *path: str | int, value: Any) -> Raw:
    """A copy with another value at a path; None removes it."""
    copy: Any = deepcopy(instance)
    target = copy
    for part in path[:-1]:
        target = target[part]
    if value is None:
        del target[path[-1]]
    else:
        target[path[-1]] = value
    return copy


def faults(*instances: Raw) -> list[str]:
    with pytest.raises(InputError) as refused:
        imported(*instances)
    assert {d.code for d in refused.value.report} == {Code.NOT_AN_IMPORT}
    return [d.message for d in refused.value.report]


# --- what a task becomes ------------------------------------------------------------------------


def test_an_item_has_the_actions_its_goal_needs_and_no_others() -> None:
    (task,) = imported(INSTANCE)
    assert [action.id for action in task.actions] == [
        "boil_potato",
        "mash_potato",
        "cut_tofu",
        "marinate_tofu",
        "grill_tofu",
        "stack_tofu",
        "cut_okra",
        "fry_okra",
        "stack_plate",
    ]


def test_state_orders_the_processing_and_holds_an_item_back_from_the_dish() -> None:
    (task,) = imported(INSTANCE)
    actions = {action.id: action for action in task.actions}
    needs = {a.id: [(c.at, c.var, c.value) for c in a.conditions] for a in task.actions}
    assert needs["marinate_tofu"] == [("start", "tofu", "cut")]
    assert needs["stack_tofu"] == [("start", "tofu", "grilled")]
    assert needs["stack_plate"] == []
    assert [(e.at, e.value) for e in actions["marinate_tofu"].effects] == [("end", "marinated")]
    assert [(v.id, v.values, v.initial) for v in task.state] == [
        ("potato", ("raw", "boiled", "mashed"), "raw"),
        ("tofu", ("raw", "cut", "marinated", "grilled"), "raw"),
        ("okra", ("raw", "cut", "fried"), "raw"),
    ]
    assert (
        actions["marinate_tofu"].duration
        == irc.Task(actions=[{"id": "x", "duration": 6.5}]).ir.actions[0].duration
    )


def test_mashing_holds_the_cutting_board() -> None:
    (task,) = imported(INSTANCE)
    (use,) = next(a for a in task.actions if a.id == "mash_potato").uses
    assert use.resource == "cutting_board"


def test_every_action_needs_a_robot_where_there_are_robots() -> None:
    (task,) = imported({**INSTANCE, "robots": ["r1", "r2"]})
    assert all(
        sum(use.alternatives == ("r1", "r2") for use in action.uses) == 1 for action in task.actions
    )


def test_a_candidate_goal_is_an_optional_group_that_takes_its_cost_once() -> None:
    (task,) = imported(MENU)
    assert [(g.id, g.actions, g.required, g.reward) for g in task.groups] == [
        ("mash", ("boil_potato", "mash_potato"), False, 5),
        ("fry", ("cut_okra", "fry_okra"), False, 3),
    ]
    assert {a.id: [(c.resource, c.amount) for c in a.consumes] for a in task.actions} == {
        "boil_potato": [("root", 1)],
        "mash_potato": [],
        "cut_okra": [("oil", 2)],
        "fry_okra": [],
    }
    assert task.objective == ("maximize_reward", "minimize_makespan")
    assert task.deadline == 24


def test_goals_that_the_answer_selected_do_not_become_obligations() -> None:
    answered = changed(MENU, "goal", "required_states", value={"potato": "mashed"})
    (task,) = imported({**answered, "selected_goal_ids": ["mash"], "optimal_reward": 5})
    assert task.goals == ()
    assert irc.validate(task, Schedule(())).valid


def test_a_stacked_candidate_that_is_left_out_leaves_the_others_in_order() -> None:
    menu = changed(MENU, "goal", "stack_order", value=["plate", "potato", "okra", "tofu"])
    (task,) = imported(menu)
    assert {(e.before, e.after) for e in task.precedence} == {
        ("stack_plate", "stack_potato"),
        ("stack_plate", "stack_okra"),
        ("stack_plate", "stack_tofu"),
        ("stack_potato", "stack_okra"),
        ("stack_potato", "stack_tofu"),
        ("stack_okra", "stack_tofu"),
    }


def test_what_no_goal_needs_is_named_in_the_metadata() -> None:
    (task,) = imported(MENU)
    assert task.metadata["items_without_a_goal"] == ["tofu", "plate"]
    assert task.metadata["unused_stations"] == ["grill", "marinator"]


def test_an_item_that_is_further_on_needs_less() -> None:
    (task,) = imported(changed(INSTANCE, "items", "tofu", "state", value="cut"))
    assert [a.id for a in task.actions if a.id.endswith("tofu")] == [
        "marinate_tofu",
        "grill_tofu",
        "stack_tofu",
    ]


def test_where_nothing_is_to_be_done_the_task_is_empty() -> None:
    idle = changed(INSTANCE, "goal", value={})
    (task,) = imported({**idle, "temporal_constraints": []})
    assert task.actions == ()
    assert irc.validate(task, Schedule(())).valid


def test_the_same_file_gives_the_same_task() -> None:
    assert written_task(imported(INSTANCE)[0]) == written_task(imported(INSTANCE)[0])


# --- bad input ----------------------------------------------------------------------------------

LAG = ("temporal_constraints", 0)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("items",), None, "the field 'items' is missing"),
        (("items",), [], "items: expected an object, found a list"),
        (("items", "tofu"), 3, "items.tofu: expected an object, found 3"),
        (("items", "tofu", "state"), None, "items.tofu: the field 'state' is missing"),
        (("items", "tofu", "state"), "row", "there is no state 'row'"),
        (("items", "tofu", "predicates"), ["isgrillable"], "no predicate 'isgrillable'"),
        (("items", "tofu", "color"), "red", "items.tofu.color: this importer does not know"),
        (("items", "tofu", "grill_requires_marinated"), 1, "expected true or false"),
        (("goal", "required_states", "tofu"), "grild", "there is no state 'grild'"),
        (("goal", "required_states", "tufo"), "grilled", "there is no item 'tufo'"),
        (("goal", "required_states", "tofu"), "boiled", "it cannot be boiled: its predicates"),
        (("goal", "required_states", "potato"), "raw", ""),
        (("goal", "required_states", "plate"), "raw", "no action makes anything 'raw'"),
        (("items", "tofu", "predicates"), ["ismarinatable"], "by way of 'cut'"),
        (("goal", "stack_order"), ["plate", "tufo"], "there is no item 'tufo'"),
        (("goal", "stack_order"), ["plate", "plate"], "item 'plate' is stacked twice"),
        (("goal", "extra"), 1, "goal.extra: this importer does not know the field"),
        (("action_durations", "cut"), None, "'action_durations' has no 'cut'"),
        (("action_durations", "cut"), "3", "expected a number, found '3'"),
        (("action_durations", "cut"), -3, "expected a time of 0 or more"),
        (("action_durations", "chop"), 3, "there is no action 'chop'"),
        (("stations", "fryer"), None, "there is no station 'fryer' to fry 'okra'"),
        (("stations", "fryer"), 0, "expected a whole number, 1 or more, found 0"),
        (("stations", "frier"), 1, "there is no station 'frier'"),
        (("robots",), ["r1", "r1"], "a robot is listed twice"),
        (("robots",), ["fryer"], "'fryer' names two of its stations, robots and stocks"),
        (("robots",), "r1", "robots: expected a list"),
        ((*LAG, "after", "item"), "tufo", "there is no item 'tufo'"),
        ((*LAG, "after", "action"), "serve", "there is no action 'serve'"),
        ((*LAG, "after", "item"), "okra", "no goal needs the action 'stack_okra'"),
        ((*LAG, "min_lag"), "5 min", "expected a number, found '5 min'"),
        ((*LAG, "before"), None, "the field 'before' is missing"),
        (("deadline",), "noon", "deadline"),
        (("objective_type",), "maximize_profit", "there is no objective 'maximize_profit'"),
        (
            ("objective_type",),
            "maximize_reward_under_deadline",
            "needs the field 'candidate_goals'",
        ),
        (("recipe",), {}, "recipe: this importer does not know the field"),
    ],
)
def test_a_fault_is_told_with_instance_field_and_place(
    path: tuple[str | int, ...], value: Any, message: str
) -> None:
    bad = changed(INSTANCE, *path, value=value)
    if not message:
        assert imported(bad)[0].actions
        return
    told = faults(bad)
    assert any(message in line for line in told), told
    assert all("'plate'" in line for line in told)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("candidate_goals", 1, "item"), "potato", "already has a candidate goal"),
        (("candidate_goals", 1, "id"), "mash", "the candidate goal 'mash' is given twice"),
        (("candidate_goals", 1, "cost"), {"salt": 1}, "'inventory_limits' has no 'salt'"),
        (("candidate_goals", 1, "reward"), -1, "expected a whole number, 0 or more"),
        (("candidate_goals", 1, "state"), "raw", "it is fulfilled from the start"),
        (("candidate_goals", 1, "state"), "boiled", "it cannot be boiled"),
        (("goal", "required_states"), {"okra": "cut"}, "'required_states' wants 'okra' 'cut'"),
        (("inventory_limits", "oil"), 1.5, "expected a whole number"),
        (("objective_type",), "minimize_makespan", "candidate goals need the objective"),
    ],
)
def test_a_fault_of_a_menu_is_told(path: tuple[str | int, ...], value: Any, message: str) -> None:
    told = faults(changed(MENU, *path, value=value))
    assert any(message in line for line in told), told


def test_all_faults_of_all_instances_come_at_once_each_at_its_line() -> None:
    bad = [
        changed(INSTANCE, "items", "tofu", "state", value="row"),
        {**changed(INSTANCE, "stations", "frier", value=1), "id": "second"},
    ]
    text = json.dumps(bad, indent=1)
    with pytest.raises(InputError) as refused:
        list(import_robo(text, "robo.json"))
    lines = text.splitlines()
    told = [
        (d.message.split(":")[0], lines[(d.line or 0) - 1]) for d in refused.value.report.located()
    ]
    assert [(owner, line.strip()) for owner, line in told] == [
        ("'plate', items.tofu.state", '"state": "row",'),
        ("'second', stations.frier", '"frier": 1'),
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "neither an instance (an object) nor a list"),
        ("[]", "neither an instance (an object) nor a list"),
        ("3", "neither an instance (an object) nor a list"),
        ('{"id": "a", "id": "b"}', "the key 'id' appears twice"),
        ("[" * 100_000, "is not JSON"),
        ("[" * 80 + "]" * 80, "nested more than"),
        ('{"deadline": NaN}', "NaN is not a number in JSON"),
        ('{"deadline": ' + "9" * 5000 + "}", "out of range"),
    ],
)
def test_what_is_no_list_of_instances_is_told(text: str, message: str) -> None:
    with pytest.raises(InputError) as refused:
        list(import_robo(text, "robo.json"))
    assert message in next(iter(refused.value.report)).message


# --- tasks of the same kind ---------------------------------------------------------------------

KINDS: list[tuple[Raw, str]] = [
    ({"predicates": ["iscookable"]}, "grilled"),
    ({"predicates": ["isfryable"]}, "fried"),
    ({"predicates": ["iscuttable"]}, "cut"),
    ({"predicates": ["isboilable"]}, "boiled"),
    ({"predicates": []}, "toasted"),
    ({"predicates": ["isboilable"], "mash_requires_boiled": True}, "mashed"),
    ({"predicates": ["iscuttable", "isfryableifcut"], "fry_requires_cut": True}, "fried"),
    ({"predicates": ["iscuttable", "ismarinatable"]}, "marinated"),
    (
        {
            "predicates": ["iscuttable", "ismarinatable", "iscookableifmarinated"],
            "grill_requires_marinated": True,
        },
        "grilled",
    ),
]


def random_instance(rng: random.Random) -> Raw:
    kinds = [rng.choice(KINDS) for _ in range(rng.randint(1, 5))]
    items: Raw = {f"i{n}": {"state": "raw", **kind} for n, (kind, _) in enumerate(kinds)}
    wanted = {f"i{n}": state for n, (_, state) in enumerate(kinds)}
    items["plate"] = {"state": "ready"}
    order = rng.sample(sorted(items), rng.randint(0, len(items)))
    waits = [item for item in order if item in wanted]
    last = {"grilled": "grill", "fried": "fry", "boiled": "boil", "toasted": "toast"}
    lags = [
        {
            "before": {"action": last[wanted[item]], "item": item},
            "after": {"action": "stack", "item": item},
            "min_lag": rng.randint(0, 7),
        }
        for item in waits
        if wanted[item] in last and rng.random() < 0.5
    ]
    return {
        "id": "random",
        "objective_type": "minimize_makespan",
        "items": items,
        "goal": {"required_states": wanted, "stack_order": order},
        "action_durations": {action: rng.randint(1, 9) for action in ACTIONS},
        "stations": {station: rng.randint(1, 2) for station in sorted(set(STATION.values()))},
        "temporal_constraints": lags,
        "robots": [f"r{n}" for n in range(rng.randint(0, 3))],
    }


@pytest.mark.slow
def test_random_instances_can_be_scheduled_and_their_schedules_are_valid() -> None:
    rng = random.Random(11)
    for _ in range(40):
        (task,) = imported(random_instance(rng))
        assert irc.check(task).ok
        schedule = irc.solve(as_once_task(written_task(task)), target="cpsat")
        assert schedule.status == "optimal"
        verdict = irc.validate(task, Schedule(schedule.entries))
        assert verdict.valid, str(verdict)


# --- the command --------------------------------------------------------------------------------


def test_the_command_reads_a_folder_in_order_and_writes_a_task_for_each(tmp_path: Path) -> None:
    (tmp_path / "b.json").write_text(json.dumps([INSTANCE, {**MENU, "id": "menu / 1"}]))
    (tmp_path / "a.json").write_text(json.dumps(INSTANCE))
    (tmp_path / "notes.txt").write_text("no instance")
    out = tmp_path / "out"
    result = run_irc("convert", tmp_path, "--from", "robo", "-o", out, "--format", "json")
    assert result.exit_code == 0, result.stderr
    assert [Path(p).name for p in json.loads(result.stdout)["written"]] == [
        "plate.json",
        "plate_.json",
        "menu_1.json",
    ]
    assert irc.load(out / "menu_1.json").ir == imported({**MENU, "id": "menu / 1"})[0]


def test_a_bad_instance_in_a_folder_is_status_1_and_nothing_is_written(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(json.dumps(INSTANCE))
    (tmp_path / "b.json").write_text(json.dumps(changed(INSTANCE, "items", value=3)))
    out = tmp_path / "out"
    result = run_irc("convert", tmp_path, "--from", "robo", "-o", out)
    assert (result.exit_code, result.stdout) == (1, "")
    assert "b.json:1:" in result.stderr
    assert not out.exists()


def test_a_folder_without_instances_is_told(tmp_path: Path) -> None:
    result = run_irc("convert", tmp_path, "--from", "robo", "-o", tmp_path / "out")
    assert result.exit_code == 1
    assert "has no .json files" in result.stderr


# --- the benchmark ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def benchmark(shared_data: Path) -> list[tuple[Raw, Task]]:
    found = []
    for file in sorted((shared_data / "robo_challenge").glob("*.json")):
        text = file.read_text("utf-8")
        ((_, task),) = import_robo(text, file.name)
        found.append((json.loads(text), task))
    assert len(found) == 70
    return found


@pytest.mark.slow
@pytest.mark.shared_data
def test_every_witness_is_valid_and_has_the_stated_optimum(
    benchmark: list[tuple[Raw, Task]],
) -> None:
    for raw, task in benchmark:
        assert not irc.check(task).diagnostics, task.name
        verdict = irc.validate(task, witness_schedule(raw))
        assert verdict.valid, f"{task.name}: {verdict}"
        assert verdict.objective["makespan"] == raw["optimal_makespan"]
        if "optimal_reward" in raw:
            assert verdict.objective["reward"] == raw["optimal_reward"]


def damaged(raw: Raw, task: Task) -> Iterator[tuple[str, Schedule]]:
    """The witness with one thing wrong, for each kind of thing that can be."""
    schedule = witness_schedule(raw)
    entries = schedule.entries
    for dropped in entries:
        yield f"without {dropped.id}", Schedule(tuple(e for e in entries if e is not dropped))
    by_id = {e.id: e for e in entries}
    for edge in task.precedence:
        lag = edge.min_lag
        late = by_id[edge.after]
        start = by_id[edge.before].end + lag - 1
        yield f"{edge.after} early", moved(entries, late, start)
        if edge.before.startswith("stack_") and edge.after.startswith("stack_"):
            swapped = moved(entries, by_id[edge.before], late.start).entries
            yield f"{edge.after} swapped", moved(swapped, late, by_id[edge.before].start)
    for variable in task.state:
        ways = [e for e in entries if e.id.endswith(f"_{variable.id}")]
        for before, after in pairwise(ways):
            yield f"{after.id} before its item is ready", moved(entries, after, before.end - 1)
    for resource in task.resources:
        held = [e for e in entries if resource.id in e.resources]
        if resource.kind == "renewable" and len(held) > resource.capacity:
            start = held[0].start
            yield (
                f"too much on {resource.id}",
                Schedule(
                    tuple(
                        replace(e, start=start, end=start + (e.end - e.start)) if e in held else e
                        for e in entries
                    )
                ),
            )
    robots = [e for e in entries if any(r.startswith("robot") for r in e.resources)]
    for entry in robots[:1]:
        bare = {k: v for k, v in entry.resources.items() if not k.startswith("robot")}
        yield (
            f"{entry.id} without a robot",
            Schedule(tuple(replace(e, resources=bare) if e is entry else e for e in entries)),
        )


def moved(entries: tuple[Entry, ...], entry: Entry, start: Any) -> Schedule:
    later = replace(entry, start=start, end=start + (entry.end - entry.start))
    return Schedule(tuple(later if e is entry else e for e in entries))


@pytest.mark.slow
@pytest.mark.shared_data
def test_a_damaged_witness_is_invalid(benchmark: list[tuple[Raw, Task]]) -> None:
    tried = 0
    for raw, task in benchmark[::3]:
        single_goals = {g.actions for g in task.groups if len(g.actions) == 1}
        for what, schedule in damaged(raw, task):
            left_out = what.removeprefix("without ")
            if (left_out,) in single_goals:
                continue  # A goal of one action may be left alone.
            tried += 1
            assert not irc.validate(task, schedule).valid, f"{task.name}: {what}"
    assert tried > 500


@pytest.mark.shared_data
def test_a_reward_above_the_stock_is_invalid(benchmark: list[tuple[Raw, Task]]) -> None:
    for raw, task in benchmark:
        if "candidate_goals" not in raw:
            continue
        entries = list(witness_schedule(raw).entries)
        present = {e.id for e in entries}
        at: Any = raw["deadline"]
        entries += [Entry(a.id, at - 1, at) for a in task.actions if a.id not in present]
        rules = {v.rule for v in irc.validate(task, Schedule(tuple(entries))).violations}
        assert "reservoir" in rules, rules


@pytest.mark.slow
@pytest.mark.shared_data
def test_the_makespan_tasks_have_the_stated_optimum_when_solved(
    benchmark: list[tuple[Raw, Task]],
) -> None:
    """A second opinion without state: the same tasks with precedence in its place."""
    solved = 0
    for raw, task in benchmark:
        if task.groups:
            continue
        schedule = irc.solve(as_once_task(written_task(task)), target="cpsat")
        assert (schedule.status, schedule.makespan) == ("optimal", raw["optimal_makespan"])
        assert irc.validate(task, Schedule(schedule.entries)).valid
        solved += 1
    assert solved == 60
