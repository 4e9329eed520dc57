"""What really happens: observations of every sort, and what a plan is worth beside them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import irc
from builders import task_of
from irc.diagnostics import Code, InputError
from irc.execution import EventRefused, Execution, simulate
from irc.schedule import Schedule, Status
from irc.service.session import Session
from irc.targets import SolveOptions
from online_cases import OPTIONS, action, entry, event, plan, starts
from oracles.reality import play
from paths import SHARED_DATA
from runs import run_irc

CASES = SHARED_DATA / "cases"
TARGETS = ("cpsat", "pddl21")
needs_cases = pytest.mark.skipif(not CASES.exists(), reason="the cases are not here")

TWO = task_of(
    action("a", 5, "r1"),
    action("c", 12, "r2"),
    action("b", 4, "r1"),
    precedence=[["a", "b"]],
    resources=[{"id": "r1"}, {"id": "r2"}],
)
PLAN = plan(entry("a", 0, 5, "r1"), entry("c", 0, 12, "r2"), entry("b", 5, 9, "r1"))


def running(presume: Any = "assume", target: str = "cpsat") -> Execution:
    options = SolveOptions(target, time_limit=10, workers=1)
    return Execution(TWO, PLAN, presume=presume, options=options)


def spans(schedule: Schedule) -> dict[str, tuple[Any, Any]]:
    return {e.id: (e.start, e.end) for e in schedule.entries}


def carried(step: irc.Step) -> list[str]:
    return [note.message for note in step.notes if note.code is Code.CARRIED]


# --- not begun, still running, ended, failed ---


@pytest.mark.parametrize("target", TARGETS)
def test_what_follows_an_overrun_has_not_begun_unless_it_was_observed(target: str) -> None:
    run = running(target=target)
    run.advance(9)
    run.observe("a", finished=9)
    step = run.replan()
    assert spans(step.schedule) == {"a": (0, 9), "c": (0, 12), "b": (9, 13)}
    assert [n.code for n in step.notes] == [Code.NOT_AS_PLANNED]
    assert "'b' was to begin at 5 s" in step.notes[0].message


@pytest.mark.parametrize("target", TARGETS)
def test_what_is_still_running_ends_when_it_is_expected_to(target: str) -> None:
    run = running(target=target)
    run.advance(6)
    run.observe("a", status="running", expected_end=11)
    assert spans(run.replan().schedule) == {"a": (0, 11), "c": (0, 12), "b": (11, 15)}
    run.advance(8)
    run.observe("a", finished=8)
    assert spans(run.replan().schedule) == {"a": (0, 8), "c": (0, 12), "b": (8, 12)}


@pytest.mark.parametrize("target", TARGETS)
def test_an_end_that_nobody_knows_is_never_presumed(target: str) -> None:
    run = running(target=target)
    for now in (6, 7, 9):
        run.advance(now)
        if now == 6:
            run.observe("a", status="running")
        step = run.replan()
        assert step.running == ("a", "c")
        (_, end), (start, _) = spans(step.schedule)["a"], spans(step.schedule)["b"]
        assert now < end <= start


@pytest.mark.parametrize("target", TARGETS)
def test_what_has_not_begun_is_planned_again_with_all_that_waits_for_it(target: str) -> None:
    run = running(target=target)
    run.advance(7)
    run.observe("a", status="not_begun")
    step = run.replan()
    assert spans(step.schedule) == {"a": (7, 12), "c": (0, 12), "b": (12, 16)}
    assert (step.completed, step.running) == ((), ("c",))


def test_what_failed_is_stopped_and_can_be_corrected() -> None:
    run = running()
    run.advance(3)
    run.observe("a", status="failed")
    step = run.replan()
    assert (step.stopped, step.schedule["a"].status, step.schedule["a"].end) == (
        ("a",),
        "cancelled",
        3,
    )
    run.advance(6)
    (note,) = run.observe("a", finished=5)
    assert note.code is Code.CORRECTED
    step = run.replan()
    assert (step.stopped, step.schedule["a"].status) == ((), None)
    assert step.task.precedence == TWO.precedence


def test_it_is_done_by_whom_it_was_observed() -> None:
    pool = task_of(
        action("a", 4, "r1|r2"),
        action("b", 4, "r1|r2"),
        resources=[{"id": "r1"}, {"id": "r2"}],
    )
    old = plan(entry("a", 0, 4, "r1"), entry("b", 0, 4, "r2"))
    run = Execution(pool, old, options=OPTIONS)
    run.advance(1)
    run.observe("a", resources=["r2"])
    step = run.replan()
    assert dict(step.schedule["a"].resources) == {"r2": 1}
    assert step.schedule["b"].start >= 1  # Both cannot have begun on r2.
    assert not carried(step)
    with pytest.raises(InputError, match="cannot be done by"):
        run.observe("a", resources=["r1", "r2"])


def test_a_mode_that_was_observed_is_the_one_it_has() -> None:
    fast = {"id": "fast", "duration": 2, "uses": [{"resource": "r1"}]}
    slow = {"id": "slow", "duration": 6}
    modal = task_of({"id": "a", "modes": [fast, slow]}, resources=[{"id": "r1"}])
    old = plan(entry("a", 0, 2, "r1", mode="fast"))
    run = Execution(modal, old, options=OPTIONS)
    run.advance(1)
    run.observe("a", mode="slow")
    step = run.replan()
    assert (step.schedule["a"].mode, step.schedule["a"].end) == ("slow", 6)


# --- late, out of order, corrected ---


def test_the_later_observation_counts_in_whatever_order_they_come_in() -> None:
    for order in ((0, 1), (1, 0)):
        run = running()
        run.advance(9)
        seen = [{"finished": 4, "at": 6}, {"finished": 7, "at": 9}]
        for k in order:
            run.observe("a", **seen[k])
        assert spans(run.replan().schedule)["a"] == (0, 7)


def test_a_late_observation_that_fits_is_taken_and_time_stays() -> None:
    run = running()
    run.advance(8)
    run.observe("a", started=1, at=4)
    run.observe("a", finished=7, at=8)
    assert run.now == 8
    assert spans(run.replan().schedule)["a"] == (1, 7)


def test_only_observations_may_come_in_late() -> None:
    run = running()
    run.advance(8)
    with pytest.raises(InputError, match="already"):
        run.apply(event(4, {"op": "set_duration", "action": "b", "duration": 5}))


@pytest.mark.parametrize(
    ("seen", "message"),
    [
        ({"action": "nobody", "status": "failed"}, "no action 'nobody'"),
        ({"action": "a", "finished": 99}, "after the event that reports it"),
        ({"action": "a", "status": "running", "expected_end": 2}, "expected to end at 2"),
        ({"action": "a", "status": "not_begun", "started": 1}, "so it has no 'started'"),
        ({"action": "a", "mode": "fast"}, "no mode 'fast'"),
        ({"action": "a", "resources": ["r2"]}, "cannot be done by 'r2'"),
        ({"action": "b", "status": "running"}, "the start of action 'b' is not known"),
        ({"action": "a"}, "says nothing"),
    ],
)
def test_an_observation_that_cannot_be_is_refused_and_changes_nothing(
    seen: dict[str, Any], message: str
) -> None:
    run = running()
    run.advance(3)
    before = run.copy()
    with pytest.raises(InputError, match=message):
        run.apply(event(3, {"op": "observe", **seen}))
    assert run == before


# --- confirm ---


@pytest.mark.parametrize("target", TARGETS)
def test_nothing_begins_or_ends_until_it_is_observed(target: str) -> None:
    run = running("confirm", target)
    run.advance(3)
    assert run.replan_needed
    assert run.replan().running == ()
    run.observe("a", started=3)
    run.observe("c", started=3)
    run.advance(9)
    step = run.replan()
    assert (step.completed, step.running) == ((), ("a", "c"))
    assert step.schedule["a"].end > 9
    run.observe("a", finished=8)
    step = run.replan()
    assert (step.completed, step.running) == (("a",), ("c",))
    assert spans(step.schedule)["b"][0] >= 9


def test_changes_of_the_world_need_no_confirmation() -> None:
    lit = task_of(action("a", 2, conditions=[{"at": "start", "var": "lit"}]), state=[{"id": "lit"}])
    on = {"op": "set_state", "var": "lit", "value": True}
    run = Execution(lit, plan(entry("a", 9, 11)), presume="confirm", options=OPTIONS)
    run.apply(event(1, on))
    run.advance(2)
    assert starts(run.replan().schedule) == {"lit at 1": 1, "a": 2}
    run.advance(3)
    assert starts(run.replan().schedule) == {"lit at 1": 1, "a": 3}


# --- rejected plans, and what cannot go on ---


def test_nothing_of_a_rejected_plan_is_taken_to_have_happened() -> None:
    run = running()
    run.apply(event(2, {"op": "set_deadline", "deadline": 8}))
    assert run.replan().schedule.status is Status.INFEASIBLE
    run.advance(7)
    run.apply(event(7, {"op": "set_deadline", "deadline": 30}))
    step = run.replan()
    assert spans(step.schedule) == {"a": (0, 5), "c": (0, 12), "b": (7, 11)}


@pytest.mark.parametrize("target", TARGETS)
def test_what_waits_for_a_dead_resource_is_named_and_the_rest_goes_on(target: str) -> None:
    whole = task_of(
        action("weld", 4, "welder"),
        action("paint", 3, "painter"),
        action("polish", 2, "painter"),
        precedence=[["weld", "polish"]],
        resources=[{"id": "welder"}, {"id": "painter"}],
        groups=[{"id": "order", "actions": ["weld", "paint", "polish"], "reward": 5}],
    )
    old = plan(entry("paint", 0, 3, "painter"), entry("weld", 1, 5, "welder"))
    old = plan(*old.entries, entry("polish", 5, 7, "painter"))
    options = SolveOptions(target, time_limit=10, workers=1)
    run = Execution(whole, old, options=options)
    dead = {"op": "set_capacity", "resource": "welder", "capacity": 0}
    run.apply(event(1, dead))
    step = run.replan()
    assert (step.schedule.status, step.left_out) == (Status.OPTIMAL, ("weld", "polish"))
    assert starts(step.schedule) == {"paint": 0}
    named = [n.message for n in step.notes if n.code is Code.NO_CONTINUATION]
    assert named == [
        "'weld' needs 1 of 'welder', which has at most 0 from now on",
        "'polish' waits for 'weld', which cannot go on",
    ]
    assert irc.validate(step.task, step.schedule, at=1).valid
    assert not irc.validate(step.task, step.schedule).valid
    assert irc.Schedule.from_dict(step.schedule.to_dict()).left_out == step.left_out
    run.apply(event(6, {**dead, "capacity": 1}))
    step = run.replan()
    assert (step.left_out, starts(step.schedule)) == ((), {"paint": 0, "weld": 6, "polish": 10})


@pytest.mark.parametrize(
    ("change", "left_out", "message"),
    [
        (
            {"op": "set_state", "var": "door", "value": False},
            "walk",
            "'walk' needs 'door' = true, which nothing brings about",
        ),
        (
            {
                "op": "add_actions",
                "actions": [action("bake", 1, consumes=[{"resource": "egg"}] * 3)],
            },
            "bake",
            "'bake' needs 3 of 'egg', of which there are at most 2",
        ),
        (
            {"op": "set_goals", "goals": [{"var": "door", "value": False}]},
            ("door", False),
            "the goal 'door' = false cannot be reached any more",
        ),
    ],
)
def test_neither_goes_on_what_lacks_a_state_or_stock(
    change: dict[str, Any], left_out: object, message: str
) -> None:
    whole = task_of(
        action("walk", 2, release=3, conditions=[{"at": "start", "var": "door"}]),
        action("wait", 4),
        state=[{"id": "door", "initial": True}],
        resources=[{"id": "egg", "kind": "reservoir", "initial": 2}],
    )
    run = Execution(whole, plan(entry("wait", 0, 4), entry("walk", 3, 5)), options=OPTIONS)
    run.apply(event(1, change))
    step = run.replan()
    assert step.schedule.answered
    assert step.left_out == (left_out,)
    assert [n.message for n in step.notes if n.code is Code.NO_CONTINUATION] == [message]
    assert "wait" in step.schedule


# --- the random sessions ---


@pytest.mark.slow
def test_no_random_session_has_an_impossible_history() -> None:
    means = SolveOptions(time_limit=5, workers=1)
    assert {s: f for s in range(3000, 3012) if (f := play(s, means).faults)} == {}


# --- the cases ---


def answers(case: str, requests: str, target: str, presume: Any = "assume") -> list[dict[str, Any]]:
    task = irc.load(CASES / case).ir
    options = SolveOptions(target, time_limit=10, workers=1)
    first = irc.solve(task, options=options)
    session = Session.start(Execution(task, first, presume=presume, options=options))
    lines = (CASES / requests).read_bytes().splitlines()
    return [json.loads(session.answer(line + b"\n").line()) for line in lines if line.strip()]


def times(answer: dict[str, Any]) -> dict[str, tuple[Any, Any]]:
    return {a["id"]: (a["start"], a["end"]) for a in answer["step"]["schedule"]["actions"]}


@needs_cases
@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_the_cases_of_sessions(target: str) -> None:
    dead, alive = answers("dead_welder.json", "dead_welder_finishes.jsonl", target)
    assert dead["step"]["schedule"]["left_out"] == ["weld 2"]
    assert times(alive) == {"weld 1": (0, 4), "weld 2": (8, 12)}
    (late,) = answers("overrun_successor.json", "overrun_successor.jsonl", target)
    assert times(late) == {"a": (0, 9), "c": (0, 12), "b": (9, 13)}
    *_, last = answers("run_set_state.json", "run_set_state.requests.jsonl", target)
    assert last["step"]["schedule"]["status"] == "optimal"
    assert times(last) == {"a": (0, 5000), "x at 1": (1, 1), "b": (5000, 5003)}
    told = {a["id"]: a for a in answers("overrun.json", "overrun.jsonl", target)}
    assert times(told["pretend again"])["a"] == (0, 7)
    assert "expected_end" in json.dumps(told["observe a future end"]["error"])
    assert (
        '"status": "running"'
        in told["set_duration after the planned end"]["error"]["diagnostics"][0]["hint"]
    )


@needs_cases
@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_the_cases_of_episodes(target: str) -> None:
    result = run_irc("simulate", CASES / "one_dead_all_dead.json", "--target", target)
    assert result.exit_code == 1
    assert re.search("cannot go on: weld [12]$", result.stdout, re.MULTILINE)
    assert "at 3 min: paint takes longer  optimal" in result.stdout
    assert "makespan 12 min" in result.stdout
    result = run_irc("simulate", CASES / "not_started.json", "--target", target, "--format", "json")
    done = json.loads(result.stdout)
    assert {a["id"]: a["start"] for a in done["final"]["actions"]} == {"a": 3, "b": 5, "c": 0}
    assert done["verdict"]["carried"] == []
    result = run_irc("simulate", CASES / "value_spelling.json", "--target", target)
    assert "stopped 1: fry" in result.stdout
    assert "done 1: egg at 0" in result.stdout


@needs_cases
@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_a_refused_event_has_its_place_and_earlier_steps_are_kept(
    target: str, tmp_path: Path
) -> None:
    case = CASES / "sim_refused.json"
    result = run_irc("simulate", case, "--target", target, "--steps", tmp_path / "steps")
    assert result.exit_code == 1
    assert "sim_refused.json:9:" in result.stderr
    assert "at 2 min: first" in result.stdout
    assert len([*(tmp_path / "steps").iterdir()]) == 2
    result = run_irc("simulate", case, "--target", target, "--format", "json")
    document = json.loads(result.stdout)
    assert len(document["steps"]) == 2
    assert document["refused"][0]["code"] == "IRC707"
    assert document["refused"][0]["line"] == 9
    with pytest.raises(EventRefused) as refused:
        simulate(irc.load(case), options=OPTIONS)
    assert len(refused.value.simulation.steps) == 2


@needs_cases
@pytest.mark.parametrize("target", TARGETS)
def test_an_end_that_lost_its_condition_still_has_a_rank_of_its_own(target: str) -> None:
    task = irc.load(CASES / "replan_state_history.json").ir
    change = json.loads((CASES / "replan_state_event.json").read_text())["changes"]
    options = SolveOptions(target, time_limit=10, workers=1)
    step = irc.replan(
        task, irc.solve(task, options=options), 1, [event(1, *change)], options=options
    )
    assert step.schedule.answered
    assert step.schedule["switch off"].rank > step.schedule["weld"].last_rank
