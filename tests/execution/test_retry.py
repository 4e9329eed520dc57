"""Trying again: repetitions, what they keep, what lapses, and what runs on what breaks."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import irc
from builders import task_of
from irc.diagnostics import InputError
from irc.execution import replan
from irc.execution.step import Step
from irc.frontends.dsl.printer import print_task
from irc.model import Task
from irc.model.canonical import written_task
from irc.schedule import Schedule
from irc_pddl21 import Pddl21
from online_cases import action, entry, event, plan, starts
from paths import SHARED_DATA
from runs import run_irc

KAIROS = Pddl21().engines()["kairos"]
TARGETS = [
    "cpsat",
    pytest.param(
        "pddl21", marks=pytest.mark.skipif(KAIROS.missing() is not None, reason="no kairos")
    ),
]

WELD = task_of(
    action("weld", 10, "arm"),
    action("paint", 4, "arm"),
    resources=[{"id": "arm"}],
    precedence=[["weld", "paint"]],
)
PLAN = plan(entry("weld", 0, 10, "arm"), entry("paint", 10, 14, "arm"))

CANCEL = {"op": "cancel_actions", "actions": ["weld"]}
RETRY = {"op": "retry_action", "action": "weld"}


def step_of(
    task: Task, schedule: Schedule, at: Any, *changes: dict[str, Any], **options: Any
) -> Step:
    step = replan(task, schedule, at, [event(at, *changes)], time_limit=5, **options)
    assert step.schedule.answered, step.notes
    structural = [d for d in irc.check(step.task).errors if not d.code.id.startswith("IRC3")]
    assert not structural, structural
    verdict = irc.validate(step.task, step.schedule, at=at)
    assert verdict.valid, str(verdict)
    return step


def codes(step: Step) -> list[str]:
    return [note.code.id for note in step.notes]


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(
    "changes",
    [(RETRY,), (CANCEL, RETRY), ({"op": "observe", "action": "weld", "status": "failed"}, RETRY)],
)
def test_what_waited_waits_for_the_repetition(changes: Any, target: str) -> None:
    step = step_of(WELD, PLAN, 6, *changes, target=target)
    assert starts(step.schedule) == {"weld": 0, "weld (2)": 6, "paint": 16}
    assert step.schedule["weld"].status == "cancelled"
    assert codes(step) == []
    assert irc.solve(WELD).makespan == 14


@pytest.mark.parametrize("how", ["cancelled", "failed"])
def test_it_can_be_done_again_later_and_from_files(how: str) -> None:
    failed = {"op": "observe", "action": "weld", "status": "failed"}
    first = step_of(WELD, PLAN, 6, CANCEL if how == "cancelled" else failed)
    assert codes(first) == ["IRC713"]
    assert "that it comes before 'paint'" in first.notes[0].message
    kept = Task.model_validate(json.loads(json.dumps(written_task(first.task))))
    assert irc.loads(print_task(kept)).ir == kept
    step = step_of(kept, plan(entry("weld", 0, 6, "arm", status="cancelled")), 7, RETRY)
    assert starts(step.schedule) == {"weld": 0, "weld (2)": 7, "paint": 17}
    assert codes(step) == []


def test_a_repetition_can_be_repeated() -> None:
    step = step_of(WELD, PLAN, 6, RETRY)
    again = {**RETRY, "action": "weld (2)"}
    step = step_of(step.task, step.schedule, 9, again)
    assert starts(step.schedule) == {"weld": 0, "weld (2)": 6, "weld (3)": 9, "paint": 19}
    with pytest.raises(InputError, match="name 'weld \\(3\\)'"):
        step_of(step.task, step.schedule, 9, RETRY)


def test_it_may_have_a_name_of_its_own_which_must_be_new() -> None:
    step = step_of(WELD, PLAN, 6, {**RETRY, "id": "weld again"})
    assert starts(step.schedule)["weld again"] == 6
    with pytest.raises(InputError, match="already there"):
        step_of(WELD, PLAN, 6, {**RETRY, "id": "paint"})


@pytest.mark.parametrize("target", TARGETS)
def test_an_order_is_finished_by_a_repetition(target: str) -> None:
    document = {
        "resources": [{"id": "r1"}, {"id": "r2"}],
        "actions": [
            action("pick", 3, "r1|r2"),
            action("weld", 6, "r1|r2"),
            action("pack", 2, "r1|r2"),
        ],
        "precedence": [["pick", "weld"], ["weld", "pack"]],
        "groups": [
            {
                "id": "order",
                "actions": ["pick", "weld", "pack"],
                "required": False,
                "reward": 10,
            }
        ],
        "objective": ["maximize_reward", "minimize_makespan"],
    }
    task = Task.model_validate(document)
    schedule = plan(
        entry("pick", 0, 3, "r1"), entry("weld", 3, 9, "r1"), entry("pack", 9, 11, "r1")
    )
    broken = {"op": "set_capacity", "resource": "r1", "capacity": 0}
    step = step_of(task, schedule, 5, broken, CANCEL, RETRY, target=target)
    assert starts(step.schedule) == {"pick": 0, "weld": 3, "weld (2)": 5, "pack": 11}
    assert (step.schedule.objective[0].value, step.abandoned) == (10, ())
    assert set(step.task.groups[0].actions) == {"pick", "pack", "weld (2)"}
    # By other means the order cannot be finished, and that is pointed out.
    new = {"op": "add_groups", "groups": [{"id": "2", "actions": ["pick"], "required": False}]}
    with pytest.raises(InputError) as refused:
        step_of(task, schedule, 5, CANCEL, new)
    assert "`retry_action` of 'weld' does it again" in (refused.value.report.errors[0].hint or "")
    # What was cancelled with its whole order is not brought back into it.
    order = {"op": "cancel_groups", "groups": ["order"]}
    step = step_of(task, schedule, 5, CANCEL, order, RETRY)
    assert step.task.groups == ()


def test_a_group_and_a_goal_come_back_when_all_had_been_cancelled() -> None:
    task = task_of(
        action("a", 2),
        action("b", 2),
        groups=[{"id": "g", "actions": ["a", "b"], "due": 3}],
        goals=["a"],
        precedence=[["a", "b"]],
    )
    schedule = plan(entry("a", 0, 2), entry("b", 2, 4))
    both = {"op": "cancel_actions", "actions": ["a", "b"]}
    step = step_of(task, schedule, 1, both)
    assert (step.task.groups, step.task.goals, codes(step)) == ((), (), ["IRC713"])
    again = [{"op": "retry_action", "action": name} for name in ("b", "a")]
    step = step_of(step.task, step.schedule, 1, *again)
    (group,) = step.task.groups
    assert (group.id, set(group.actions), group.due) == ("g", {"a (2)", "b (2)"}, 3)
    assert step.task.goals == ("a (2)",)
    assert [(p.before, p.after) for p in step.task.precedence] == [("a (2)", "b (2)")]
    assert starts(step.schedule) == {"a": 0, "a (2)": 1, "b (2)": 3}


def test_it_keeps_lags_deadline_and_ways_but_not_a_start_that_has_passed() -> None:
    task = task_of(
        action("cure", 4, "oven|kiln", start=2, deadline=30, cost=3),
        action("cut", 1, release=0),
        resources=[{"id": "oven"}, {"id": "kiln"}],
        precedence=[{"before": "cure", "after": "cut", "min_lag": 2, "max_lag": 3}],
    )
    schedule = plan(entry("cure", 2, 6, "oven"), entry("cut", 8, 9))
    step = step_of(task, schedule, 5, {"op": "retry_action", "action": "cure"})
    again = next(a for a in step.task.actions if a.id == "cure (2)")
    assert (again.start, again.deadline, again.cost, again.occurs) == (None, 30, 3, "once")
    assert starts(step.schedule) == {"cure": 2, "cure (2)": 5, "cut": 11}


def test_it_is_too_late_to_come_before_what_has_begun() -> None:
    failed = {"op": "observe", "action": "weld", "status": "failed"}
    first = step_of(WELD, PLAN, 6, failed)
    assert starts(first.schedule)["paint"] == 6
    step = step_of(first.task, first.schedule, 7, RETRY)
    assert starts(step.schedule) == {"weld": 0, "paint": 6, "weld (2)": 10}
    (note,) = [n for n in step.notes if n.code.id == "IRC713"]
    assert note.message == "that 'weld (2)' comes before 'paint' lapses: it is too late for that"


@pytest.mark.parametrize(
    ("at", "changes", "told"),
    [
        (6, ({"op": "retry_action", "action": "paint"},), "IRC704"),
        (12, (RETRY,), "IRC707"),
        (6, ({"op": "retry_action", "action": "wel"},), "IRC201"),
        (6, (RETRY, RETRY), "IRC702"),
        (6, ({**RETRY, "done": 11},), "IRC704"),
        (6, ({**RETRY, "done": -1},), "IRC105"),
        (6, ({**RETRY, "mode": "fast"},), "IRC201"),
    ],
)
def test_what_cannot_be_done_again_is_refused(at: int, changes: Any, told: str) -> None:
    with pytest.raises(InputError) as refused:
        step_of(WELD, PLAN, at, *changes)
    assert [d.code.id for d in refused.value.report.errors] == [told]


def test_of_counted_occurrences_it_is_not_known_what_is_left() -> None:
    task = task_of(action("tick", 4, occurs={"min": 2, "max": 3}))
    schedule = plan(entry("tick", 0, 4), entry("tick", 4, 8, occurrence=2))
    with pytest.raises(InputError, match="how often is bounded"):
        step_of(task, schedule, 5, {"op": "retry_action", "action": "tick"})


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_what_may_occur_at_will_can_be_tried_again(target: str) -> None:
    moves = [
        {
            "id": f"go {a}{b}",
            "duration": 4,
            "occurs": {"min": 0},
            "conditions": [{"at": "start", "var": f"at {a}"}],
            "effects": [
                {"at": "start", "var": f"at {a}", "value": False},
                {"at": "end", "var": f"at {b}"},
            ],
        }
        for a, b in ("AB", "BA")
    ]
    task = task_of(
        *moves,
        state=[{"id": "at A", "initial": True}, {"id": "at B"}],
        goals=[{"var": "at B"}],
    )
    slip = [
        {"op": "cancel_actions", "actions": ["go AB"]},
        {"op": "set_state", "var": "at A", "value": True},
    ]
    schedule = plan(entry("go AB", 0, 4))
    step = step_of(
        task, schedule, 2, *slip, {"op": "retry_action", "action": "go AB"}, target=target
    )
    assert starts(step.schedule)["go AB (2)"] == 2
    # Without that nothing leads there: it is said at once, and how it could be mended.
    step = replan(task, schedule, 2, [event(2, *slip)], target=target)
    (note,) = [n for n in step.notes if n.code.id == "IRC710"]
    assert "'at B' = true cannot be reached" in note.message
    assert note.hint is not None
    assert "`retry_action` does again what was cancelled: 'go AB'" in note.hint


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(
    ("how", "ends"),
    [("resume", {"weld (2)": 10, "paint": 14}), ("restart", {"weld (2)": 16, "paint": 20})],
)
def test_what_ran_on_a_resource_that_broke_is_done_again(
    how: str, ends: dict[str, int], target: str
) -> None:
    task = task_of(
        action("weld", 10, "arm|hand", on_failure=how),
        action("paint", 4, "hand"),
        resources=[{"id": "arm"}, {"id": "hand"}],
        precedence=[["weld", "paint"]],
    )
    schedule = plan(entry("weld", 0, 10, "arm"), entry("paint", 10, 14, "hand"))
    broken = {"op": "set_capacity", "resource": "arm", "capacity": 0, "to": 40}
    step = step_of(task, schedule, 6, broken, target=target)
    assert {e.id: e.end for e in step.schedule if e.id != "weld"} == ends
    assert (step.schedule["weld"].end, step.schedule["weld"].status) == (6, "cancelled")
    assert codes(step) == []


def test_without_on_failure_it_goes_on_and_the_conflict_is_carried() -> None:
    broken = {"op": "set_capacity", "resource": "arm", "capacity": 0, "to": 40}
    step = step_of(WELD, PLAN, 6, broken)
    assert step.schedule["weld"].end == 10
    assert codes(step) == ["IRC709"]


def test_no_more_is_broken_off_than_is_too_many_and_the_last_begun_first() -> None:
    task = task_of(
        *(action(name, 9, "bench", on_failure="restart") for name in "abc"),
        resources=[{"id": "bench", "capacity": 3}],
    )
    schedule = plan(*(entry(name, k, k + 9, "bench") for k, name in enumerate("abc")))
    less = {"op": "set_capacity", "resource": "bench", "capacity": 1}
    step = step_of(task, schedule, 5, less)
    assert [e.id for e in step.schedule if e.status == "cancelled"] == ["b", "c"]
    later = {**less, "from": 7}
    assert not [e for e in step_of(task, schedule, 5, later).schedule if e.status == "cancelled"]


def test_what_is_left_of_an_action_with_modes_and_stock() -> None:
    drill = {
        "id": "drill",
        "modes": [{"id": "fast", "duration": 4}, {"id": "slow", "duration": 10}],
        "uses": [{"one_of": ["m1", "m2"]}],
        "consumes": [{"resource": "bits"}],
        "conditions": [{"at": "start", "var": "cold"}],
        "effects": [{"at": "start", "var": "cold", "value": False}],
        "on_failure": "resume",
    }
    task = task_of(
        drill,
        resources=[
            {"id": "m1"},
            {"id": "m2"},
            {"id": "bits", "kind": "reservoir", "initial": 1},
        ],
        state=[{"id": "cold", "initial": True}],
    )
    schedule = plan(entry("drill", 0, 4, "m1", mode="fast"))
    step = step_of(task, schedule, 1, {"op": "set_capacity", "resource": "m1", "capacity": 0})
    rest = next(a for a in step.task.actions if a.id == "drill (2)")
    assert [m.duration for m in rest.modes] == [3, Fraction(15, 2)]
    assert (rest.conditions, rest.effects, rest.consumes) == ((), (), ())
    assert (step.schedule["drill (2)"].start, step.schedule.makespan) == (1, 4)


def test_what_lapses_is_named_only_where_it_still_mattered() -> None:
    done = plan(entry("weld", 0, 10, "arm"), entry("paint", 10, 14, "arm"))
    step = step_of(WELD, done, 12, {"op": "cancel_actions", "actions": ["paint"]})
    assert codes(step) == []
    both = {"op": "cancel_actions", "actions": ["weld", "paint"]}
    assert codes(step_of(WELD, done, 6, both)) == []


def test_a_session_replays_what_was_done_again(tmp_path: Path) -> None:
    file = tmp_path / "weld.json"
    file.write_text(json.dumps(written_task(WELD)))
    lines = [
        {"do": "advance", "to": 6},
        {"do": "apply", "event": {"changes": [RETRY]}, "replan": True},
        {"do": "observe", "action": "weld (2)", "started": 6.5},
    ]
    arguments = ["run", file, "--stdio", "--journal", tmp_path / "j"]
    requests = "\n".join([json.dumps(lines[0]), json.dumps({**lines[1]})])
    first = run_irc(*arguments, stdin=requests)
    answered = [json.loads(line) for line in first.stdout.splitlines()]
    assert answered[-1]["step"]["schedule"]["makespan"] == 20
    again = run_irc(*arguments, stdin='{"do": "advance", "to": 7}\n' + json.dumps(lines[2]))
    greeting, _, observed = [json.loads(line) for line in again.stdout.splitlines()]
    assert (greeting["recovered"], observed["ok"]) == (2, True)
    assert greeting["state"]["running"] == []


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.slow
@pytest.mark.skipif(not SHARED_DATA.exists(), reason="the cases are not there")
def test_the_cases_that_people_had(tmp_path: Path, target: str) -> None:
    cases = SHARED_DATA / "cases"
    if not (cases / "corridor_d.pddl").exists():
        pytest.skip("the cases are not there")
    task, schedule = tmp_path / "corridor.json", tmp_path / "plan.json"
    given = (cases / "corridor_d.pddl", "--problem", cases / "corridor_p.pddl")
    assert run_irc("convert", *given, "--from", "pddl", "-o", task).exit_code == 0
    assert run_irc("solve", task, "-o", schedule).exit_code == 0
    slip = json.loads((cases / "retry_fail.json").read_text())
    slip["changes"].append({"op": "retry_action", "action": "(go b1 c1 c2)"})
    (tmp_path / "event.json").write_text(json.dumps(slip))
    options = ("--schedule", schedule, "--at", "2", "--target", target, "--format", "json")
    options = (*options, "--time-limit", "5", "--event")
    told = run_irc("replan", task, *options, tmp_path / "event.json")
    assert json.loads(told.stdout)["schedule"]["makespan"] == 16
    told = run_irc("replan", task, *options, cases / "retry_fail.json")
    notes = json.loads(told.stdout)["notes"]
    assert {note["code"] for note in notes} == {"IRC710"}
    weld = run_irc("solve", cases / "weld.irc", "-o", schedule)
    assert weld.exit_code == 0
    options = ("--schedule", schedule, "--at", "6", "--target", target, "--format", "json")
    told = run_irc("replan", cases / "weld.irc", *options, "--event", cases / "wfail2.json")
    assert "IRC713" in [note["code"] for note in json.loads(told.stdout)["notes"]]
