"""Tasks at the edges of features, found by fuzzing: what each target says, by the public road."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.model import Event, Task
from irc.schedule import Entry, Schedule
from online_cases import replanned
from oracles.online_judge import judge_step
from oracles.state_brute_force import optimum
from runs import run_irc

pytestmark = pytest.mark.slow

Document = dict[str, Any]
TARGETS = ("cpsat", "pddl21")


def needs_kairos() -> None:
    pytest.importorskip("kairos")


def answered(document: Document, target: str, seconds: float = 6.0) -> Schedule:
    """The answer of a target, by the public call."""
    if target == "pddl21":
        needs_kairos()
    return irc.solve(document, target, time_limit=seconds)


def values(schedule: Schedule) -> list[Any]:
    return [level.value for level in schedule.objective]


def action(name: str, duration: Any = 1, **fields: Any) -> Document:
    return {"id": name, "duration": duration, **fields}


UNIT = [{"id": "r"}]
USES = [{"resource": "r"}]

CYCLE = {
    "actions": [action("c", 0), action("a", occurs="optional", reward=1)],
    "precedence": [["c", "a"], ["a", "c"]],
    "objective": ["maximize_reward"],
}
GROUP_CYCLE = {
    "actions": [action("c", 0), action("a"), action("b")],
    "groups": [{"id": "g", "actions": ["a", "b"], "required": False, "reward": 3}],
    "precedence": [["a", "c"], ["c", "b"], {"before": "b", "after": "a", "min_lag": 2}],
    "objective": ["maximize_reward", "minimize_makespan"],
}
ONE_OF_TWO = {
    "actions": [
        action("a", occurs="optional", reward=2),
        action("b", occurs="optional", reward=3),
    ],
    "precedence": [["a", "b"], {"before": "b", "after": "a", "min_lag": 1}],
    "objective": ["maximize_reward"],
}
TWICE = {
    "resources": UNIT,
    "actions": [action("b", {"min": 0, "max": 1}, uses=[*USES, *USES])],
}
WHILE_TAKEN = {
    "resources": UNIT,
    "actions": [
        action("a", 5, start=0, uses=USES),
        action("b", {"min": 0, "max": 2}, start=3, uses=USES),
    ],
}
REPEATED_REWARD = {
    "actions": [action("b", 3, occurs={"min": 2, "max": 3}, reward=1)],
    "objective": ["maximize_reward"],
}
REWARDS = {
    "actions": [action("a", 2, reward=5), action("b", 3, occurs={"min": 2, "max": 3}, reward=1)],
    "goals": ["b"],
    "objective": ["maximize_reward"],
}
WITHIN = {
    "resources": UNIT,
    "deadline": 10,
    "actions": [
        action("a", 4, occurs={"min": 0, "max": 3}, reward=5, uses=USES),
        action("b", 3, occurs={"min": 1}, reward=3, uses=USES),
    ],
    "objective": ["maximize_reward"],
}
START_FINISH = {
    "resources": [{"id": "r", "capacity": 2}],
    "actions": [action("a", 3, uses=[{"resource": "r", "amount": 2}]), action("b", 2, uses=USES)],
    "precedence": [{"before": "a", "after": "b", "type": "start-finish", "max_lag": 2}],
}

BEST = {
    "a cycle through an optional action": (CYCLE, [0]),
    "a cycle of lags through an optional group": (GROUP_CYCLE, [0, 0]),
    "two optional actions that exclude each other": (ONE_OF_TWO, [3]),
    "a range from 0 that asks for more than there is": (TWICE, [0]),
    "a range from 0 where nothing is free": (WHILE_TAKEN, [5]),
    "repetitions with a reward": (REPEATED_REWARD, [3]),
    "repetitions and another reward": (REWARDS, [8]),
    "repetitions that fill the time": (WITHIN, [11]),
    "a start that coincides with an end": (START_FINISH, [5]),
}


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", BEST)
def test_both_targets_find_the_best_and_prove_it(name: str, target: str) -> None:
    document, best = BEST[name]
    schedule = answered(document, target)
    assert (str(schedule.status), values(schedule)) == ("optimal", best)


def round_trips() -> Document:
    """Two parcels, two trucks: each parcel goes there and back by the same one."""
    actions, groups = [], []
    for p in "12":
        for t in "AB":
            names = [f"{step} {p} {t}" for step in ("drive", "unload", "back")]
            on = [{"resource": f"truck {t}"}]
            effects = [{"at": "end", "var": f"home {p}", "value": True}]
            actions += [
                action(names[0], 30, uses=on),
                action(names[1], 15, uses=[*on, {"resource": "dock"}]),
                action(names[2], 30, uses=on, effects=effects),
            ]
            groups.append({"id": f"trip {p} {t}", "actions": names, "required": False})
    trips = [group["actions"] for group in groups]
    return {
        "resources": [{"id": "truck A"}, {"id": "truck B"}, {"id": "dock"}],
        "state": [{"id": "home 1"}, {"id": "home 2"}],
        "actions": actions,
        "groups": groups,
        "precedence": [
            {"before": x, "after": y, "max_lag": 0} for t in trips for x, y in (t[:2], t[1:])
        ],
        "goals": [{"var": "home 1", "value": True}, {"var": "home 2", "value": True}],
    }


@pytest.mark.parametrize("target", TARGETS)
def test_groups_are_chosen_where_only_the_makespan_counts(target: str) -> None:
    schedule = answered(round_trips(), target, 10.0)
    assert (str(schedule.status), values(schedule)) == ("optimal", [90])


def test_what_a_goal_requires_is_checked_for_cycles() -> None:
    report = irc.check({**CYCLE, "goals": ["a"]})
    assert [d.code.id for d in report.errors] == ["IRC301"]


def test_more_occurrences_than_a_model_holds_are_refused_by_name(tmp_path: Path) -> None:
    file = tmp_path / "task.json"
    file.write_text(json.dumps({"actions": [action("a", occurs={"min": 10**9})]}))
    said = run_irc("check", file)
    assert said.exit_code == 1
    assert "IRC214" in said.stdout
    assert "'a' must occur at least 1,000,000,000 times" in said.stdout


def many_values() -> Document:
    count = 500
    effects = [[{"at": "end", "var": "x", "value": f"v{i + 1}"}] for i in range(count)]
    conditions = [[{"at": "start", "var": "x", "value": f"v{i}"}] for i in range(count)]
    return {
        "state": [{"id": "x", "values": [f"v{i}" for i in range(count + 1)], "initial": "v0"}],
        "actions": [
            action(f"a{i}", occurs="optional", conditions=conditions[i], effects=effects[i])
            for i in range(count)
        ],
    }


def busy_shelf() -> Document:
    gives, takes = ({key: [{"resource": "s"}]} for key in ("produces", "consumes"))
    actions = [action(f"a{i}", **(gives if i % 2 else takes)) for i in range(900)]
    return {"resources": [{"id": "s", "kind": "reservoir", "initial": 5}], "actions": actions}


@pytest.mark.parametrize(
    ("document", "target", "says"),
    [
        (many_values(), "pddl21", "the effects on 'x', with its 500 values"),
        (busy_shelf(), "cpsat", "reservoir 's' is changed 900 times"),
    ],
    ids=["values", "changes"],
)
def test_what_is_too_large_for_a_target_is_refused_by_name(
    document: Document, target: str, says: str
) -> None:
    with pytest.raises(irc.InputError, match=says):
        irc.compile(document, target)


def test_a_conflict_of_thousands_is_shown_in_part(tmp_path: Path) -> None:
    count = 1000
    cycle = [[f"a{i}", f"a{(i + 1) % count}"] for i in range(count)]
    file = tmp_path / "task.json"
    file.write_text(
        json.dumps({"actions": [action(f"a{i}") for i in range(count)], "precedence": cycle})
    )
    said = run_irc("explain", file, "--time-limit", 1).stdout
    assert "more; `--format json` shows all of them" in said
    assert said.count("^") == 60


# --- without an answer ---------------------------------------------------------------------------


FREED_TOO_LATE = {
    "resources": UNIT,
    "state": [{"id": "x"}, {"id": "y"}],
    "actions": [
        action("a", 4, uses=USES, start=0, conditions=[{"at": "end", "var": "x"}]),
        action(
            "b",
            2,
            uses=USES,
            effects=[{"at": "start", "var": "x"}, {"at": "end", "var": "y"}],
        ),
        action("c", 2, conditions=[{"at": "start", "var": "y"}]),
    ],
}
TAKEN_TOO_EARLY = {
    "resources": UNIT,
    "state": [{"id": "x"}],
    "actions": [
        action("a", 4, uses=USES, conditions=[{"at": "end", "var": "x"}]),
        action(
            "b",
            2,
            uses=USES,
            effects=[{"at": "start", "var": "x"}, {"at": "end", "var": "x", "value": False}],
        ),
    ],
}
FULL_SHELF = {
    "resources": [{"id": "u", "kind": "reservoir", "min": 1, "initial": 1, "max": 1}],
    "actions": [
        action("a", 3, produces=[{"resource": "u", "at": "start"}]),
        action("c", 3, occurs="optional", consumes=[{"resource": "u"}]),
    ],
    "goals": ["a"],
}


def after_the_state(**limit: int) -> Document:
    """`a` waits for the state that `c` leaves at 2."""
    shut = {"var": "y", "value": False}
    return {
        "state": [{"id": "y", "initial": True}],
        "actions": [
            action("c", 2, conditions=[{"at": "all", "var": "y"}], effects=[{"at": "end", **shut}]),
            action("a", 1, conditions=[{"at": "all", **shut}], **limit),
        ],
    }


def _exchange(id: str, takes: str, gives: str, duration: object) -> dict[str, object]:
    change = {"consumes": [{"resource": takes}], "produces": [{"resource": gives}]}
    return {"id": id, "duration": duration, **change}


STOCKS = [{"id": name, "kind": "reservoir"} for name in ("coins", "tokens")]
RANGE = {"min": 0, "max": 8}
EXCHANGES = [
    {
        "resources": STOCKS,
        "actions": [
            _exchange("buy", "coins", "tokens", RANGE),
            _exchange("sell", "tokens", "coins", length),
        ],
    }
    for length in (0, RANGE)
]

NONE = {
    "two exchanges, one of which may take time, each need what the other gives": EXCHANGES[0],
    "the same where both may": EXCHANGES[1],
    "state alone makes a latest start too late": after_the_state(latest_start=1),
    "state alone makes a deadline too late": after_the_state(deadline=2),
    "state alone makes a fixed start too late": after_the_state(start=1),
    "the resource is freed behind the start that a condition needs": FREED_TOO_LATE,
    "the same without a fixed start": TAKEN_TOO_EARLY,
    "neither of two changes can come first": FULL_SHELF,
}


@pytest.mark.parametrize("name", NONE)
def test_what_brute_force_finds_impossible_is_proved_to_be(name: str) -> None:
    document = NONE[name]
    assert optimum(Task.model_validate(document)) is None
    assert str(irc.solve(document, "cpsat", time_limit=10).status) == "infeasible"


def test_a_simulation_of_what_is_impossible_says_so(tmp_path: Path) -> None:
    note = {"at": 4, "changes": [{"op": "add_actions", "actions": [action("tidy")]}]}
    file = tmp_path / "task.json"
    file.write_text(json.dumps({**FREED_TOO_LATE, "events": [note]}))
    said = run_irc("simulate", file)
    assert "no schedule exists" in said.stdout
    assert "rejected" not in said.stdout + said.stderr


# --- ranks after events --------------------------------------------------------------------------


@pytest.mark.shared_data
@pytest.mark.parametrize("name", ["rank_of_end", "interference_2", "rejected_by_validator"])
def test_ranks_after_an_event_are_those_of_brute_force(name: str, shared_data: Path) -> None:
    case = json.loads((shared_data / "cases" / f"{name}.json").read_text())
    task = Task.model_validate(case["task"])
    entries = [
        Entry(i, start, end, resources, mode=mode, rank=rank, end_rank=end_rank)
        for i, start, end, mode, resources, rank, end_rank in case["plan"]
    ]
    old = Schedule(tuple(entries))
    events = [Event.model_validate({"at": case["at"], "changes": case["changes"]})]
    events = events if case["changes"] else []
    step = replanned(task, old, case["at"], events)
    judged = judge_step(task, old, step, events)
    assert judged.faults == []
    assert step.schedule.answered


@pytest.mark.shared_data
def test_the_work_on_a_pool_bounds_the_makespan_of_optional_orders(shared_data: Path) -> None:
    document = json.loads((shared_data / "cases" / "slow_proof_pool.json").read_text())
    schedule = irc.solve(document, "cpsat", workers=1, time_limit=20)
    assert (str(schedule.status), values(schedule)) == ("optimal", [83, 50])
