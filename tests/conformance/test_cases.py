"""Small inputs that people really have, each with its right answer (shared/data/cases/README.md).

The kinds are tested one by one beside the code that they concern; here the files themselves are
asked, through the public functions.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.model import Event

pytestmark = [pytest.mark.slow, pytest.mark.shared_data]


@pytest.fixture
def cases(shared_data: Path) -> Path:
    return shared_data / "cases"


def objective(schedule: irc.Schedule) -> dict[str, Any]:
    return {o.name: o.value for o in schedule.objective}


@pytest.mark.parametrize(
    ("name", "target", "seconds", "expected"),
    [
        ("mode_cost.json", "cpsat", 20, {"cost": 20}),
        ("mode_cost.json", "pddl21", 5, {"cost": 20}),
        ("changeover.json", "cpsat", 20, {"makespan": 13}),
        ("changeover.json", "pddl21", 5, {"makespan": 13}),
        ("same_truck.irc", "cpsat", 20, {"makespan": 90}),
        ("same_truck.irc", "pddl21", 5, {"makespan": 90}),
        ("zero_range_twice.json", "pddl21", 5, {"makespan": 0}),
        ("repeats_worse.json", "pddl21", 5, {"reward": 8}),
        ("pddl_repeat_reward.json", "pddl21", 5, {"reward": 3}),
        ("optional_cycle.json", "pddl21", 5, {}),
        ("pddl_start_finish_unknown.json", "pddl21", 5, {}),
        ("slow_proof_pool.json", "cpsat", 20, {"makespan": 50}),
    ],
)
def test_a_task_has_the_right_answer(
    cases: Path, name: str, target: str, seconds: float, expected: dict[str, int]
) -> None:
    schedule = irc.solve(irc.load(cases / name), target, time_limit=seconds)
    assert schedule.answered
    assert objective(schedule).items() >= expected.items()
    if target == "cpsat":
        assert schedule.status == "optimal"


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
@pytest.mark.parametrize("name", ["circ.json", "inf2.irc", "long_op.json", "pddl_unknown.json"])
def test_what_is_impossible_is_infeasible_for_a_reason(cases: Path, name: str, target: str) -> None:
    schedule = irc.solve(irc.load(cases / name), target, time_limit=5)
    assert schedule.status == "infeasible"
    assert schedule.outcome.diagnostics


@pytest.mark.parametrize(
    ("name", "target", "makespan"),
    [
        ("slip.json", "cpsat", 12),
        ("slip.json", "pddl21", 12),
        ("door_event.irc", "cpsat", 9),
        ("door_event.irc", "pddl21", 9),
    ],
)
def test_an_episode_ends_right(cases: Path, name: str, target: str, makespan: int) -> None:
    simulation = irc.simulate(irc.load(cases / name), target=target, time_limit=5)
    assert simulation.final.makespan == makespan


@pytest.mark.parametrize("name", ["rank_of_end", "interference_2", "rejected_by_validator"])
def test_a_replan_has_an_answer_or_a_proof_that_there_is_none(cases: Path, name: str) -> None:
    case = json.loads((cases / f"{name}.json").read_text("utf-8"))
    task = irc.Task.from_dict(case["task"])
    plan = irc.Schedule(
        tuple(
            irc.Entry(name, start, end, mode=mode, resources=held, rank=rank, end_rank=end_rank)
            for name, start, end, mode, held, rank, end_rank in case["plan"]
        )
    )
    run = irc.Execution(task, plan, case["at"], time_limit=20)
    for change in case["changes"]:
        run.apply(Event.model_validate({"at": case["at"], "changes": [change]}))
    step = run.replan()
    assert step.schedule.status in ("optimal", "infeasible")


def test_more_occurrences_than_any_model_holds_are_refused_by_name(cases: Path) -> None:
    report = irc.check(irc.load(cases / "occurs_min_1e9.json"))
    assert [d.code.id for d in report.errors] == ["IRC214"]
