"""What is presumed to have begun (docs/semantics.md): right values, rule by rule, and an oracle."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import task_of
from irc.execution import Execution, replan
from irc.execution.state import key_of
from irc.model import Task
from irc.model.quantities import Number
from irc.schedule import BEGUN, Entry
from laws import faults_of_repairs
from online_cases import OPTIONS, action, entry, event, plan, starts
from oracles.reality import presumptions

SEEN = {"op": "observe"}


def edge(before: str, after: str, kind: str, least: Number = 0, **more: Any) -> dict[str, Any]:
    return {"before": before, "after": after, "type": kind, "min_lag": least, **more}


def begun(task: Task, entries: list[Entry], now: Number, *seen: dict[str, Any]) -> set[str]:
    """What has begun at `now`, after observations as of then."""
    run = Execution(task, plan(*entries), options=OPTIONS)
    run.apply(event(now, *({**SEEN, **one} for one in seen)))
    return {e.id for e in run.state().frozen}


# --- relations ---

TOGETHER = [entry("a", 0, 9), entry("b", 0, 9)]


@pytest.mark.parametrize(
    ("relation", "has_begun"),
    [
        (edge("a", "b", "start-start"), False),
        (edge("a", "b", "start-start", max_lag=0), False),
        (edge("b", "a", "start-start", max_lag=0), True),
        (edge("a", "b", "start-start", -3), False),
        (edge("a", "b", "start-start", -4), True),
        (edge("a", "b", "finish-start", -12), False),
        (edge("a", "b", "finish-start", -13), True),
        (edge("a", "b", "finish-finish"), True),
        (edge("a", "b", "start-finish"), True),
    ],
)
def test_only_a_bound_on_its_start_forbids_it(relation: dict[str, Any], has_begun: bool) -> None:
    task = task_of(action("a", 9), action("b", 9), precedence=[relation])
    found = begun(task, TOGETHER, 6, {"action": "a", "started": 4})
    assert found == ({"a", "b"} if has_begun else {"a"})


def test_what_has_not_begun_ends_no_earlier_than_its_least_duration_from_now() -> None:
    ways = [{"id": "slow", "duration": 9}, {"id": "quick", "duration": {"min": 4, "max": 6}}]
    for lag, has_begun in ((-7, False), (-8, True)):
        task = task_of(
            {"id": "a", "modes": ways},
            action("b", 9),
            precedence=[edge("a", "b", "finish-start", lag)],
        )
        planned = [entry("a", 0, 4, mode="quick"), entry("b", 2, 11)]
        found = begun(task, planned, 6, {"action": "a", "status": "not_begun"})
        assert found == ({"b"} if has_begun else set())


def test_a_chain_that_starts_at_once_waits_as_a_whole_whatever_its_names() -> None:
    """`b` is asked before `z`, for which it waits."""
    chain = [edge("m", "z", "start-start"), edge("z", "b", "start-start")]
    task = task_of(action("m", 9), action("z", 9), action("b", 9), precedence=chain)
    planned = [entry(name, 0, 9) for name in ("b", "m", "z")]
    assert begun(task, planned, 6, {"action": "m", "started": 4}) == {"m"}


def test_who_may_start_earlier_waits_for_who_has_not() -> None:
    """`b` may start 2 before `a`, and `a` waits for `c`, which overran."""
    lead = [edge("a", "b", "start-start", -2), edge("c", "a", "finish-start")]
    task = task_of(action("a", 5), action("b", 5), action("c", 4), precedence=lead)
    planned = [entry("c", 0, 4), entry("b", 2, 7), entry("a", 4, 9)]
    assert begun(task, planned, 6, {"action": "c", "finished": 6}) == {"c"}
    assert begun(task, planned, 6, {"action": "c", "finished": 4}) == {"a", "b", "c"}


def test_a_start_as_of_which_a_relation_was_broken_is_carried() -> None:
    task = task_of(
        action("a", 9), action("b", 9), precedence=[edge("a", "b", "start-start", max_lag=0)]
    )
    planned = plan(entry("a", 3, 12), entry("b", 3, 12))
    step = replan(
        task, planned, 6, [event(6, {**SEEN, "action": "a", "started": 1})], options=OPTIONS
    )
    assert starts(step.schedule) == {"a": 1, "b": 3}
    assert step.running == ("a", "b")
    assert [v.rule for v in irc.validate(step.task, step.schedule, at=6).carried] == ["precedence"]


def test_an_order_that_came_after_a_start_does_not_forbid_it() -> None:
    task = task_of(action("a", 2), action("b", 5))
    run = Execution(task, plan(entry("a", 0, 2), entry("b", 3, 8)), options=OPTIONS)
    run.apply(event(4, {"op": "add_precedence", "precedence": [edge("a", "b", "finish-start")]}))
    run.apply(event(5, {**SEEN, "action": "a", "finished": "7/2"}))
    assert {e.id for e in run.state().frozen} == {"a", "b"}
    early = Execution(task, plan(entry("a", 0, 2), entry("b", 3, 8)), options=OPTIONS)
    early.apply(event(2, {"op": "add_precedence", "precedence": [edge("a", "b", "finish-start")]}))
    early.apply(event(5, {**SEEN, "action": "a", "finished": "7/2"}))
    assert {e.id for e in early.state().frozen} == {"a"}


def test_another_duration_takes_back_no_start() -> None:
    task = task_of(
        action("a", 6),
        action("b", 9),
        action("c", 1),
        precedence=[edge("a", "b", "finish-start", -3)],
    )
    planned = plan(entry("a", 0, 6), entry("b", 3, 12), entry("c", 0, 1))
    run = Execution(task, planned, options=OPTIONS)
    run.apply(event(5, {"op": "set_duration", "action": "a", "duration": 9}))
    run.apply(event(5, {**SEEN, "action": "c", "finished": 2}))
    assert {e.id for e in run.state().frozen} == {"a", "b", "c"}


# --- resources and stock ---


def station(*actions: dict[str, Any], capacity: int = 2, **more: Any) -> Task:
    return task_of(*actions, resources=[{"id": "r", "capacity": capacity}], **more)


def test_what_started_earlier_has_a_resource_before_what_started_later() -> None:
    task = station(*(action(name, 9, "r") for name in ("b", "c", "z")))
    planned = [entry("z", 0, 9, "r"), entry("b", 2, 11, "r"), entry("c", 11, 20, "r")]
    assert begun(task, planned, 6, {"action": "c", "started": 5}) == {"c", "z"}


def test_of_what_starts_at_once_the_first_by_name_has_what_is_left() -> None:
    task = station(*(action(name, 5, "r") for name in ("b", "c", "d")))
    planned = [entry("c", 0, 5, "r"), entry("b", 5, 10, "r"), entry("d", 5, 10, "r")]
    assert begun(task, planned, 6, {"action": "c", "finished": 6}) == {"b", "c"}


def test_who_has_not_begun_for_another_reason_leaves_a_resource_to_the_next() -> None:
    wait = [edge("c", "b", "finish-start")]
    task = station(*(action(name, 5, "r") for name in ("b", "c", "d")), precedence=wait)
    planned = [entry("c", 0, 5, "r"), entry("b", 5, 10, "r"), entry("d", 5, 10, "r")]
    assert begun(task, planned, 6, {"action": "c", "finished": 6}) == {"c", "d"}


def test_of_a_stock_the_first_takes_what_is_left() -> None:
    take = [{"resource": "s", "amount": 1}]
    task = task_of(
        *({**action(name, 3), "consumes": take} for name in ("b", "c", "d")),
        {**action("m", 2), "produces": take},
        resources=[{"id": "s", "kind": "reservoir", "initial": 2}],
    )
    planned = [entry("c", 0, 3), entry("m", 0, 2), entry("b", 2, 5), entry("d", 2, 5)]
    assert begun(task, planned, 4, {"action": "m", "started": 3}) == {"b", "c", "m"}
    assert begun(task, planned, 4, {"action": "m", "finished": 2}) == {"b", "c", "d", "m"}


def test_what_is_one_happening_takes_and_gives_at_once() -> None:
    swap = {
        **action("swap", 0),
        "consumes": [{"resource": "s", "amount": 2}],
        "produces": [{"resource": "s", "amount": 1}],
    }
    task = task_of(swap, action("c", 4), resources=[{"id": "s", "kind": "reservoir", "initial": 1}])
    planned = [entry("swap", 1, 1), entry("c", 0, 4)]
    assert begun(task, planned, 3, {"action": "c", "status": "running"}) == {"c", "swap"}


def test_a_setup_is_that_of_the_mode_that_was_chosen() -> None:
    """In its other mode `b` would need no set-up."""
    times = [{"from": "red", "to": "blue", "time": 3}]
    paint = [
        {"id": k, "duration": 4, "uses": [{"resource": "r", "family": k}]} for k in ("red", "blue")
    ]
    task = task_of(
        *({"id": name, "modes": paint} for name in ("a", "b")),
        resources=[{"id": "r", "setups": {"times": times}}],
    )
    planned = [entry("a", 0, 4, "r", mode="red"), entry("b", 7, 11, "r", mode="blue")]
    assert begun(task, planned, 8, {"action": "a", "finished": 5}) == {"a"}
    assert begun(task, planned, 8, {"action": "a", "finished": 4}) == {"a", "b"}


# --- state ---


def test_what_the_world_does_by_itself_is_known() -> None:
    door = {"id": "door", "initial": False, "changes": [{"at": 3, "value": True}]}
    walk = {**action("walk", 4), "conditions": [{"at": "start", "var": "door", "value": True}]}
    task = task_of(walk, action("c", 2), state=[door])
    for start, has_begun in ((3, True), (5, True)):
        planned = [entry("c", 0, 2), entry("walk", start, start + 4)]
        found = begun(task, planned, 6, {"action": "c", "finished": "5/2"})
        assert ("walk" in found) is has_begun


def test_the_last_of_an_instant_is_in_doubt_the_one_that_is_needed() -> None:
    """`x` ends behind `y`, and says so by its rank."""
    ends = {"x": True, "y": False}
    sets = [
        {**action(name, {"min": 4, "max": 5}), "effects": [{"at": "end", "var": "v", "value": v}]}
        for name, v in ends.items()
    ]
    needs = {**action("z", 4), "conditions": [{"at": "start", "var": "v", "value": True}]}
    task = task_of(*sets, needs, action("c", 2), state=[{"id": "v"}])
    planned = [
        entry("x", 0, 5, end_rank=1),
        entry("y", 1, 5),
        entry("z", 6, 10),
        entry("c", 0, 2),
    ]
    assert begun(task, planned, 8, {"action": "c", "finished": 1}) == {"c", "x", "y", "z"}
    assert begun(task, planned, 8, {"action": "x", "finished": 7}) == {"c", "x", "y"}


def test_numbers_that_are_set_and_added_to_at_one_instant_are_in_doubt() -> None:
    add = {**action("a", 3), "effects": [{"at": "end", "var": "n", "add": 2}]}
    fill = {**action("s", 3), "effects": [{"at": "end", "var": "n", "set": 1}]}
    needs = {**action("z", 4), "conditions": [{"at": "start", "var": "n", "at_least": 3}]}
    task = task_of(
        add, fill, needs, action("c", 2), state=[{"id": "n", "kind": "number", "initial": 0}]
    )
    planned = [entry("s", 0, 3), entry("a", 0, 3, rank=1), entry("z", 4, 8), entry("c", 0, 2)]
    assert begun(task, planned, 6, {"action": "c", "finished": 1}) == {"a", "c", "s", "z"}
    assert begun(task, planned, 6, {"action": "a", "finished": 5}) == {"a", "c", "s"}


def test_what_had_not_begun_is_presumed_by_the_plan_that_has_it_begin_later() -> None:
    task = task_of(action("a", 3), action("b", 3), precedence=[edge("a", "b", "finish-start")])
    run = Execution(task, plan(entry("a", 0, 3), entry("b", 3, 6)), options=OPTIONS)
    run.advance(1)
    run.observe("a", status="not_begun")
    run.observe("b", status="not_begun")
    assert run.state().frozen == ()
    assert starts(run.replan().schedule) == {"a": 1, "b": 4}
    run.advance(5)
    assert [(e.id, e.start) for e in run.state().frozen] == [("a", 1), ("b", 4)]
    run.observe("b", status="not_begun", at="9/2")
    assert [(e.id, e.start) for e in run.state().frozen] == [("a", 1)]


def test_what_was_said_to_run_just_now_and_then_not_to_have_begun_has_not() -> None:
    run = Execution(task_of(action("a", 3)), plan(entry("a", 2, 5)), options=OPTIONS)
    run.advance(2)
    run.observe("a", status="running", started=2)
    assert run.replan().running == ("a",)
    run.observe("a", status="not_begun")
    assert run.state().frozen == ()
    assert run.replan().running == ()
    run.advance(3)
    assert [e.id for e in run.state().frozen] == ["a"]


# --- pauses ---

SHIFT = {"id": "shift", "every": "24 s"}
MORNING = {**SHIFT, "open": [{"from": 0, "to": 2}, {"from": 10, "to": 24}]}
PAUSING = task_of(
    {"id": "a", "duration": 4, "calendar": "shift", "breaks": "pause"},
    action("b", 3),
    calendars=[MORNING],
    precedence=[["a", "b"]],
)
PAUSED = plan(entry("a", 0, 12, paused=8), entry("b", 12, 15))


@pytest.mark.parametrize(
    ("now", "seen", "running", "starts_b"),
    [
        (6, {"started": 1}, ("a",), 13),
        (6, {"started": 1, "status": "running"}, ("a",), 13),
        (6, {"status": "running"}, ("a",), 12),
        (15, {"started": 1}, (), 15),
    ],
)
def test_work_that_was_observed_to_start_ends_after_its_pause(
    now: int, seen: dict[str, Any], running: tuple[str, ...], starts_b: int
) -> None:
    observed = event(now, {**SEEN, "action": "a", **seen})
    step = replan(PAUSING, PAUSED, now, [observed], options=OPTIONS)
    a = step.schedule["a"]
    assert (a.start, a.end, a.paused) == ((1, 13, 8) if "started" in seen else (0, 12, 8))
    assert (step.running, step.schedule["b"].start) == (running, starts_b)
    assert [has.duration for has in step.task.actions if has.id == "a"] == [4]
    assert not irc.validate(step.task, step.schedule, at=now).carried


def test_work_that_ranges_is_as_long_as_planned_without_its_pause() -> None:
    whole = {"min": 2, "max": 6}
    ranging = task_of(
        {"id": "a", "duration": whole, "calendar": "shift", "breaks": "pause"},
        action("b", 3),
        calendars=[MORNING],
        precedence=[["a", "b"]],
    )
    run = Execution(ranging, PAUSED, options=OPTIONS)
    run.apply(event(14, {**SEEN, "action": "a", "started": 1}))
    assert {e.id: e.end for e in run.state().frozen} == {"a": 13}


def test_another_duration_of_what_pauses_is_of_its_work() -> None:
    run = Execution(PAUSING, PAUSED, options=OPTIONS)
    run.apply(event(6, {"op": "set_duration", "action": "a", "duration": 5}))
    step = run.replan()
    assert (step.running, step.schedule["a"].end, step.schedule["b"].start) == (("a",), 13, 13)
    shorter = event(11, {"op": "set_duration", "action": "a", "duration": 2})
    with pytest.raises(irc.InputError, match="would have ended at 2 s"):
        run.apply(shorter)


def test_a_pause_is_that_of_the_resource_that_was_taken() -> None:
    """`day`, the first that `a` might have taken, is never closed."""
    either = [{"one_of": ["day", "late"]}]
    task = task_of(
        {"id": "a", "duration": 4, "uses": either, "breaks": "pause"},
        action("b", 9, "day"),
        resources=[{"id": "day"}, {"id": "late", "calendar": "shift"}],
        calendars=[MORNING],
    )
    planned = plan(entry("a", 0, 12, "late", paused=8), entry("b", 0, 9, "day"))
    seen = event(6, {**SEEN, "action": "a", "started": 1, "status": "running"})
    step = replan(task, planned, 6, [seen], options=OPTIONS)
    assert (step.running, step.schedule["a"].end) == (("a", "b"), 13)
    assert [has.duration for has in step.task.actions if has.id == "a"] == [4]
    over = event(16, {**SEEN, "action": "a", "finished": 15})
    step = replan(task, planned, 16, [over], options=OPTIONS)
    assert [has.duration for has in step.task.actions if has.id == "a"] == [7]
    assert not irc.validate(step.task, step.schedule, at=16).carried


# --- what was observed before ---


def test_what_was_observed_stays_observed_in_a_step_from_task_and_schedule() -> None:
    task = station(action("a", 9, "r"), action("b", 9, "r"), action("c", 9, "r"))
    planned = plan(entry("a", 1, 10, "r"), entry("b", 1, 10, "r"), entry("c", 10, 19, "r"))
    seen = event(2, {**SEEN, "action": "a", "started": 0})
    first = replan(task, planned, 2, [seen], options=OPTIONS)
    assert starts(first.schedule) == {"a": 0, "b": 1, "c": 9}
    seen = event(4, {**SEEN, "action": "c", "started": 3})
    step = replan(first.task, first.schedule, 4, [seen], options=OPTIONS)
    assert starts(step.schedule) == {"a": 0, "b": 9, "c": 3}


def test_a_start_that_was_observed_just_now_is_history_in_the_next_step_too() -> None:
    task = station(action("a", 9, "r"), capacity=1)
    seen = event(2, {**SEEN, "action": "a", "started": 2})
    first = replan(task, plan(entry("a", 4, 13, "r")), 2, [seen], options=OPTIONS)
    assert first.schedule["a"].status == BEGUN
    down = event(2, {"op": "set_capacity", "resource": "r", "capacity": 0})
    step = replan(first.task, first.schedule, 2, [down], options=OPTIONS)
    assert (step.running, starts(step.schedule)) == (("a",), {"a": 2})
    assert [v.rule for v in irc.validate(step.task, step.schedule, at=2).carried] == ["capacity"]
    later = replan(step.task, step.schedule, 3, (), options=OPTIONS)
    assert (later.schedule["a"].status, later.running) == (None, ("a",))


def test_a_start_that_the_task_fixes_is_open_until_it_is_past() -> None:
    """What an event makes of the instant binds it, and the validator says so too."""
    uses = [{"one_of": ["r", "q"], "amount": 1}]
    task = task_of(
        {"id": "a", "duration": 3, "start": 1, "uses": uses}, resources=[{"id": "q"}, {"id": "r"}]
    )
    down = event(1, {"op": "set_capacity", "resource": "r", "capacity": 0, "to": 5})
    step = replan(task, plan(entry("a", 1, 4, "r")), 1, [down], options=OPTIONS)
    assert (dict(step.schedule["a"].resources), step.running) == ({"q": 1}, ())
    old = irc.validate(step.task, plan(entry("a", 1, 4, "r")), at=1)
    assert [v.rule for v in old.violations] == ["capacity"]


def test_a_group_of_which_something_cannot_have_begun_is_done_in_part() -> None:
    order = {"id": "order", "actions": ["b", "d"], "required": False, "reward": 4}
    task = task_of(
        action("a", 2),
        action("b", 3),
        action("d", 3, deadline=6),
        precedence=[edge("a", "d", "finish-start")],
        groups=[order],
        objective=["maximize_reward"],
    )
    planned = plan(entry("a", 0, 2), entry("b", 0, 3), entry("d", 2, 5))
    step = replan(
        task, planned, 4, [event(4, {**SEEN, "action": "a", "finished": 4})], options=OPTIONS
    )
    assert (step.abandoned, starts(step.schedule)) == (("order",), {"a": 0, "b": 0})
    step = replan(
        task, planned, 4, [event(4, {**SEEN, "action": "a", "finished": 2})], options=OPTIONS
    )
    assert (step.abandoned, starts(step.schedule)) == ((), {"a": 0, "b": 0, "d": 2})


def test_an_occurrence_has_begun_only_behind_the_one_before_it() -> None:
    task = task_of(
        action("a", 3, "r", occurs={"min": 2, "max": 2}),
        action("b", 4, "r"),
        resources=[{"id": "r"}],
    )
    planned = plan(
        entry("b", 0, 4, "r"), entry("a", 4, 7, "r"), entry("a", 7, 10, "r", occurrence=2)
    )
    run = Execution(task, planned, options=OPTIONS)
    run.apply(event(8, {**SEEN, "action": "b", "finished": 5}))
    assert {key_of(e) for e in run.state().frozen} == {("b", 1)}
    run.apply(event(8, {**SEEN, "action": "a", "occurrence": 2, "started": 7}))
    assert {key_of(e) for e in run.state().frozen} == {("a", 1), ("a", 2), ("b", 1)}


# --- the oracle ---


@pytest.mark.parametrize("seed", [7004, 20020, 20176, 20248])
def test_judge_and_repair_agree_on_what_has_begun(seed: int) -> None:
    assert faults_of_repairs(seed, "observe") == []


@pytest.mark.parametrize("seed", [7004, 20170])
def test_they_agree_after_several_events_too(seed: int) -> None:
    assert faults_of_repairs(seed, None) == []


@pytest.mark.parametrize("seed", [44, 86, 149, 169, 188])
def test_they_agree_after_several_observations_of_one_plan(seed: int) -> None:
    assert list(presumptions(seed, OPTIONS)) == []
