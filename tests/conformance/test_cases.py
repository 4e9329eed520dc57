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
    schedule = irc.solve(irc.load(cases / name), target, time_limit=3)
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
    simulation = irc.simulate(irc.load(cases / name), target=target, time_limit=3)
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


# --- calendars, set-ups, late work ---------------------------------------------------------------


def test_work_goes_on_behind_a_break(cases: Path) -> None:
    """As it is written, the overhaul waits for the break to end; allowed to pause, it takes 6 h."""
    whole = irc.load(cases / "break_stretch.irc")
    assert irc.solve(whole, time_limit=20).makespan == 10
    text = (
        (cases / "break_stretch.irc")
        .read_text("utf-8")
        .replace("on mechanic", "on mechanic may pause")
    )
    assert irc.solve(irc.loads(text), time_limit=20).makespan == 6


def test_shifts_repeat(cases: Path) -> None:
    """What the `for` of the case tries to say: open for an hour, closed for an hour."""
    assert not irc.check(irc.load(cases / "periodic.irc")).ok
    text = """\
unit h
calendar odd hours every 2 open 0 .. 1
resource lathe during calendar odd hours
turn 4 on lathe may pause
"""
    assert irc.solve(irc.loads(text), time_limit=20).makespan == 7


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("exp_cal.irc", {"window", "duration", "use", "task_deadline"}),
        ("explain_calendar.irc", {"window", "duration", "use", "precedence", "deadline"}),
        ("exp_group.irc", {"capacity", "duration", "use", "group_deadline"}),
        ("circ.json", {"stock_min", "consumes"}),
    ],
)
def test_what_is_impossible_is_explained(cases: Path, name: str, expected: set[str]) -> None:
    said = irc.explain(irc.load(cases / name), time_limit=20)
    assert {statement.kind for statement in said.conflict} == expected
    assert said.minimal


def test_late_work_is_explained(cases: Path) -> None:
    said = irc.explain_lateness(irc.load(cases / "explain_why_late.irc"), "fine", time_limit=20)
    assert (said.late, said.possible) == (20, False)
    assert "'rough' takes 20 min less" in [change.text for change in said.changes]
