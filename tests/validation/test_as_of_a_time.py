"""Judging as of a time: what only the history causes is carried, all else is a violation."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import act, stock_task, task_of
from irc.events.apply import apply
from irc.model import Event, Task
from irc.model.quantities import TimeError
from irc.schedule import Entry, ObjectiveValue, Schedule
from irc.validation import SHOWN_PER_RULE, InexactTimeError, Verdict, validate

Rules = tuple[list[str], list[str]]


def told(verdict: Verdict) -> Rules:
    """The rules violated and the rules carried."""
    return [v.rule for v in verdict.violations], [v.rule for v in verdict.carried]


def judged(task: Task, at: Any, *entries: Entry) -> Rules:
    verdict = validate(task, Schedule(entries), at)
    without = validate(task, Schedule(entries))
    assert not without.carried
    assert verdict.valid == (not verdict.violations)
    if not verdict.carried:
        assert verdict.violations == without.violations
    return told(verdict)


# What is history


def test_what_began_before_is_history_and_what_begins_then_is_not() -> None:
    task = task_of(act("a", 3, deadline=2))
    assert judged(task, 1, Entry("a", 0, 3)) == ([], ["deadline"])
    assert judged(task, 0, Entry("a", 0, 3)) == (["deadline"], [])


def test_what_was_observed_to_begin_just_then_is_history() -> None:
    for task in (task_of(act("a", 3, deadline=6)), task_of(act("a", 3, deadline=6, start=4))):
        begun = Entry("a", 4, 7, status="begun")
        assert judged(task, 4, begun) == ([], ["deadline"])
        early = validate(task, Schedule((begun,)), 3)
        assert told(early) == (["status", "deadline"], [])
        assert judged(task, 4, Entry("a", 4, 7)) == (["deadline"], [])


def test_a_change_of_the_world_just_then_is_history() -> None:
    late = {"at": "start", "var": "v", "value": True}
    change = act("v at 4", 0, start=4, effects=[late])
    task = task_of(change, act("b", 5, effects=[{**late, "value": False}]), state=[{"id": "v"}])
    ranked = [Entry("v at 4", 4, 4, rank=1), Entry("b", 4, 9, rank=1)]
    assert judged(task, 4, *ranked) == (["interference"], [])
    begun = [ranked[0], Entry("b", 4, 9, rank=1, status="begun")]
    assert judged(task, 4, *begun) == ([], ["interference"])


def test_without_a_time_nothing_is_carried_and_nothing_is_said_of_it() -> None:
    task, schedule = task_of(act("a", 3, deadline=2)), Schedule((Entry("a", 0, 3),))
    verdict = validate(task, schedule)
    assert (told(verdict), verdict.at) == ((["deadline"], []), None)
    assert "carried" not in verdict.to_dict()


def test_times_are_exact() -> None:
    with pytest.raises(InexactTimeError):
        validate(task_of(act("a", 3)), Schedule((Entry("a", 0, 3),)), 0.5)  # type: ignore[arg-type]


# What is never carried


def test_what_is_missing_unknown_or_misstated_is_never_carried() -> None:
    task = task_of(act("a", 3), act("b", 3), goals=["c"], deadline=90)
    task = task.model_copy(update={"actions": (*task.actions, *task_of(act("c", 1)).actions)})
    assert judged(task, 50, Entry("a", 0, 3), Entry("x", 0, 3)) == (
        ["unknown", "presence", "presence", "goal"],
        [],
    )
    lie = Schedule((Entry("a", 0, 3),), objective=(ObjectiveValue("makespan", 2),))
    assert told(validate(task_of(act("a", 3)), lie, 50)) == (["objective"], [])
    group = {"id": "g", "actions": ["a", "b"], "required": False}
    assert judged(task_of(act("a", 3), act("b", 3), groups=[group]), 50, Entry("a", 0, 3)) == (
        ["group"],
        [],
    )


def test_only_what_has_begun_is_abandoned_and_only_what_has_ended_was_cancelled() -> None:
    group = {"id": "g", "actions": ["a", "b"], "required": False}
    task = task_of(act("a", 3), act("b", 3), groups=[group])
    abandoned = Entry("a", 1, 4, status="abandoned")
    assert judged(task, 2, abandoned) == ([], [])
    assert told(validate(task, Schedule((abandoned,)), 1)) == (["status"], [])
    over = task_of(act("a", 9, occurs="optional", deadline=4))
    cancelled = Entry("a", 1, 4, status="cancelled")
    assert judged(over, 4, cancelled) == ([], [])
    assert told(validate(over, Schedule((cancelled,)), 3)) == (["status"], [])


# Time windows and precedence


def test_the_length_of_what_has_ended_is_a_fact_and_that_of_what_runs_is_not() -> None:
    task = task_of(act("a", 3))
    assert judged(task, 2, Entry("a", 0, 2)) == ([], ["duration"])
    assert judged(task, 1, Entry("a", 0, 2)) == (["duration"], [])
    assert judged(task, 9, Entry("a", 2, 1)) == (["duration"], [])


def test_a_deadline_missed_by_choice_is_not_carried() -> None:
    task = task_of(act("a", {"min": 4, "max": 9}, deadline=6))
    assert judged(task, 1, Entry("a", 0, 8)) == (["deadline"], [])
    assert judged(task, 7, Entry("a", 0, 8)) == ([], ["deadline"])
    assert judged(task, 1, Entry("a", 0, 6)) == ([], [])
    long = task_of(act("a", {"min": 7, "max": 9}, deadline=6))
    assert judged(long, 1, Entry("a", 0, 8)) == ([], ["deadline"])


def test_releases_and_deadlines_that_came_too_late_are_carried() -> None:
    task = task_of(act("a", 3, release=2), act("b", 3, release=2), deadline=5)
    ran, plan = Entry("a", 1, 4), Entry("b", 5, 8)
    assert judged(task, 3, ran, plan) == (["deadline"], ["release"])


def test_a_late_start_is_carried_once_it_has_been() -> None:
    task = task_of(act("a", 3, latest_start=2))
    assert judged(task, 4, Entry("a", 3, 6)) == ([], ["latest_start"])
    assert judged(task, 3, Entry("a", 3, 6)) == (["latest_start"], [])


def test_an_order_between_two_that_began_is_carried_and_one_to_what_is_open_is_not() -> None:
    task = task_of(act("a", 4), act("b", 4), act("c", 1), precedence=[("a", "b"), ("a", "c")])
    began = Entry("a", 0, 4), Entry("b", 1, 5)
    assert judged(task, 2, *began, Entry("c", 4, 5)) == ([], ["precedence"])
    assert judged(task, 2, *began, Entry("c", 3, 4)) == (["precedence"], ["precedence"])
    assert judged(task, 1, *began, Entry("c", 4, 5)) == (["precedence"], [])


def test_a_lag_that_a_better_end_would_keep_is_not_carried() -> None:
    def task(**lag: Any) -> Task:
        ranged = act("b", {"min": 2, "max": 8})
        edge = {"before": "a", "after": "b", "type": "finish-finish", **lag}
        return task_of(act("a", 4), ranged, precedence=[edge])

    a = Entry("a", 0, 4)
    assert judged(task(min_lag=3), 5, a, Entry("b", 1, 6)) == (["precedence"], [])
    assert judged(task(min_lag=9), 5, a, Entry("b", 1, 6)) == ([], ["precedence"])
    assert judged(task(max_lag=2), 5, a, Entry("b", 1, 7)) == (["precedence"], [])
    assert judged(task(max_lag=0), 5, a, Entry("b", 1, 7)) == ([], ["precedence"])


def test_occurrences_that_overlapped_are_carried_unless_one_is_open() -> None:
    task = task_of(act("a", 4, occurs={"max": 2}))
    entries = Entry("a", 0, 4), Entry("a", 2, 6, occurrence=2)
    assert judged(task, 3, *entries) == ([], ["occurrence"])
    assert judged(task, 2, *entries) == (["occurrence"], [])


# Resources


def saw_task(*actions: dict[str, Any], capacity: int = 2) -> Task:
    task = task_of(
        *({**action, "uses": [{"resource": "saw"}]} for action in actions),
        resources=[{"id": "saw", "capacity": capacity}],
    )
    failure = {"op": "set_capacity", "resource": "saw", "capacity": 1}
    return apply(task, Event(at=2, changes=[failure]))


HELD = {"saw": 1}


def test_capacity_cut_below_what_is_running_is_carried() -> None:
    task = saw_task(act("a", 4), act("b", 5), act("c", 1))
    running = Entry("a", 0, 4, HELD), Entry("b", 0, 5, HELD)
    assert judged(task, 2, *running, Entry("c", 5, 6, HELD)) == ([], ["capacity"])


@pytest.mark.parametrize("start", [2, 3])
def test_more_use_on_top_of_an_overload_is_not(start: int) -> None:
    task = saw_task(act("a", 4), act("b", 5), act("c", 1))
    running = Entry("a", 0, 4, HELD), Entry("b", 0, 5, HELD)
    violated, _ = judged(task, 2, *running, Entry("c", start, start + 1, HELD))
    assert violated == ["capacity"]


def test_an_open_use_that_outlasts_an_overload_is_a_violation() -> None:
    task = saw_task(act("a", 4), act("b", 5), act("c", 9))
    running = Entry("a", 0, 4, HELD), Entry("b", 0, 5, HELD)
    assert judged(task, 2, *running, Entry("c", 4, 13, HELD)) == (["capacity"], ["capacity"])


def takes(name: str, amount: int = 1, at: str = "start", **fields: Any) -> dict[str, Any]:
    return act(name, 1, consumes=[{"resource": "flour", "amount": amount, "at": at}], **fields)


def gives(name: str, amount: int = 1, at: str = "start", **fields: Any) -> dict[str, Any]:
    return act(name, 1, produces=[{"resource": "flour", "amount": amount, "at": at}], **fields)


def test_stock_that_history_lacks_is_carried_and_what_is_open_must_not_take_more() -> None:
    task = stock_task(takes("ran"), takes("plan"))
    assert judged(task, 3, Entry("ran", 0, 1), Entry("plan", 3, 4)) == (
        ["reservoir"],
        ["reservoir"],
    )
    assert judged(stock_task(takes("ran")), 3, Entry("ran", 0, 1)) == ([], ["reservoir"])


def test_a_lack_mended_in_part_is_still_only_of_the_past() -> None:
    late = {**takes("late", 1, "end"), "duration": 9}
    task = stock_task(takes("early", 2), gives("fill"), late)
    entries = Entry("early", 0, 1), Entry("late", 1, 10), Entry("fill", 5, 6)
    assert judged(task, 3, *entries) == ([], ["reservoir", "reservoir"])


def test_taking_what_mended_a_lack_is_a_violation() -> None:
    task = stock_task(takes("ran"), gives("fill"), takes("plan"))
    entries = Entry("ran", 0, 1), Entry("fill", 5, 6), Entry("plan", 7, 8)
    assert judged(task, 3, *entries) == (["reservoir"], ["reservoir"])


def test_taking_at_the_instant_at_which_history_mends_its_lack_is_a_violation() -> None:
    fills = {**gives("fill", 2, "end"), "duration": 5}
    task = stock_task(takes("ran"), fills, takes("plan", 2))
    ran = Entry("ran", 0, 1), Entry("fill", 0, 5)
    assert judged(task, 3, *ran, Entry("plan", 5, 6)) == (["reservoir"], ["reservoir"])
    assert judged(stock_task(takes("ran"), fills), 3, *ran) == ([], ["reservoir"])


def test_a_level_that_history_exceeds_is_treated_alike() -> None:
    task = stock_task(gives("ran", 2), gives("plan"), takes("drain", 2), max=1)
    ran = Entry("ran", 0, 1)
    drained = Entry("drain", 4, 5)
    assert judged(task, 3, ran, drained, Entry("plan", 5, 6)) == ([], ["reservoir"])
    assert judged(task, 3, ran, drained, Entry("plan", 3, 4)) == (["reservoir"], ["reservoir"])


def test_a_level_that_starts_out_of_bounds_is_nobodys_history() -> None:
    task = stock_task(act("ran", 1), initial=3, max=1)
    assert judged(task, 3, Entry("ran", 0, 1)) == (["reservoir"], [])


# State


def on(at: str, value: bool = True) -> dict[str, Any]:
    return {"at": at, "var": "on", "value": value}


def lamp(*actions: dict[str, Any], initial: bool = False, **fields: Any) -> Task:
    return task_of(*actions, state=[{"id": "on", "initial": initial}], **fields)


RANKS = pytest.mark.parametrize("ranks", [{}, {"rank": 2}], ids=["found", "given"])
"""Of an entry that decides whether the schedule gives ranks; the other entries have rank 0."""


@RANKS
def test_a_condition_that_history_does_not_meet_is_carried(ranks: dict[str, int]) -> None:
    task = lamp(act("need", 2, conditions=[on("start")]), act("late", 1))
    need = Entry("need", 1, 3)
    assert judged(task, 2, need, Entry("late", 5, 6, **ranks)) == ([], ["state"])
    assert judged(task, 1, need, Entry("late", 5, 6, **ranks)) == (["state"], [])


@RANKS
def test_an_open_effect_that_breaks_what_runs_is_a_violation(ranks: dict[str, int]) -> None:
    task = lamp(
        act("runs", 9, conditions=[on("all")]),
        act("plan", 1, effects=[on("start", False)]),
        initial=True,
    )
    runs = Entry("runs", 0, 9)
    assert judged(task, 3, runs, Entry("plan", 5, 6, **ranks)) == (["state"], [])
    assert judged(task, 6, runs, Entry("plan", 5, 6, **ranks)) == ([], ["state"])
    assert judged(task, 3, runs, Entry("plan", 9, 10, **ranks)) == ([], [])


@RANKS
def test_what_runs_and_breaks_what_is_planned_is_a_violation(ranks: dict[str, int]) -> None:
    task = lamp(
        act("runs", 9, effects=[on("end", False)]),
        act("plan", 4, conditions=[on("all")]),
        initial=True,
    )
    runs = Entry("runs", 0, 9)
    assert judged(task, 3, runs, Entry("plan", 7, 11, **ranks)) == (["state"], [])
    assert judged(task, 3, runs, Entry("plan", 4, 8, **ranks)) == ([], [])


@RANKS
def test_what_history_broke_and_mended_is_not_to_be_broken_again(ranks: dict[str, int]) -> None:
    task = lamp(
        act("runs", 9, conditions=[on("all")]),
        act("off", 1, effects=[on("start", False)]),
        act("back", 1, effects=[on("start")]),
        act("plan", 1, effects=[on("start", False)]),
        initial=True,
    )
    history = Entry("runs", 0, 9), Entry("off", 1, 2)
    back, plan = Entry("back", 2, 3), Entry("plan", 5, 6, **ranks)
    assert judged(task, 4, *history, back, plan) == (["state"], ["state"])
    # As long as it is off anyhow, switching it off does no harm.
    assert judged(task, 4, *history, Entry("back", 6, 7), plan) == ([], ["state"])
    assert judged(task, 4, *history, back, Entry("plan", 9, 10, **ranks)) == ([], ["state"])


@RANKS
def test_what_never_held_may_be_mended_and_then_must_stay(ranks: dict[str, int]) -> None:
    task = lamp(
        act("runs", 9, conditions=[on("all")]),
        act("fix", 1, effects=[on("start")]),
        act("plan", 1, effects=[on("start", False)]),
    )
    runs, fix = Entry("runs", 0, 9), Entry("fix", 4, 5)
    assert judged(task, 3, runs, fix, Entry("plan", 9, 10, **ranks)) == ([], ["state"])
    assert judged(task, 3, runs, fix, Entry("plan", 6, 7, **ranks)) == (["state"], ["state"])


def test_a_world_that_changed_by_itself_is_history() -> None:
    task = lamp(act("runs", 9, conditions=[on("all"), on("end")]), act("plan", 1), initial=True)
    failure = {"op": "set_state", "var": "on", "value": False}
    revised = apply(task, Event(at=3, changes=[failure]))
    (fact,) = (a.id for a in revised.actions if a.id not in ("runs", "plan"))
    entries = Entry("runs", 0, 9), Entry(fact, 3, 3), Entry("plan", 3, 4)
    assert judged(revised, 3, *entries) == ([], ["state", "state"])


@RANKS
def test_a_condition_of_what_is_open_is_never_carried(ranks: dict[str, int]) -> None:
    task = lamp(act("ran", 1, conditions=[on("start")]), act("plan", 1, conditions=[on("start")]))
    entries = Entry("ran", 0, 1), Entry("plan", 5, 6, **ranks)
    assert judged(task, 3, *entries) == (["state"], ["state"])


def test_interference_is_carried_only_among_what_began() -> None:
    task = lamp(
        act("a", 5, effects=[on("start", False)]),
        act("b", 5, conditions=[on("end")], effects=[on("end")]),
        act("c", 1, effects=[on("start", False)]),
        initial=True,
        goals=[{"var": "on", "value": False}],
    )
    a, c = Entry("a", 0, 5), Entry("c", 7, 8, rank=1)
    b = Entry("b", 2, 7)
    assert judged(task, 3, a, b, c) == ([], ["state"])
    assert judged(task, 3, a, b, Entry("c", 7, 8), Entry("late", 9, 9, rank=1))[0] == [
        "unknown",
        "interference",
    ]


def test_history_keeps_the_ranks_that_it_was_given() -> None:
    task = lamp(
        act("light", 5, effects=[on("start")]),
        act("need", 5, conditions=[on("start")]),
        act("plan", 1),
    )
    light, plan = Entry("light", 1, 6), Entry("plan", 8, 9)
    # One rank later it could; no ranks at all are looked for, and here the entry must give it.
    assert judged(task, 4, light, Entry("need", 1, 6), plan) == ([], [])
    assert judged(task, 4, light, Entry("need", 1, 6, rank=1), plan) == ([], [])
    ranked = Entry("plan", 8, 9, rank=1)
    assert judged(task, 4, light, Entry("need", 1, 6), ranked) == ([], ["state", "interference"])


def test_what_has_ended_keeps_the_rank_of_its_end_when_an_observation_fixes_its_duration() -> None:
    task = lamp(
        act("light", 5, effects=[on("end")]),
        act("watch", {"min": 1, "max": 9}, conditions=[on("end")]),
        act("plan", 1),
    )
    entries = Entry("light", 0, 5), Entry("watch", 0, 5, end_rank=1), Entry("plan", 6, 7)
    assert judged(task, 6, *entries) == ([], [])
    change = {"op": "observe", "action": "watch", "started": 0, "finished": 5}
    observed = apply(task, Event(at=6, changes=[change]))
    assert judged(observed, 6, *entries) == ([], ["rank"])


def test_a_history_that_some_ranks_explain_is_not_to_blame() -> None:
    task = lamp(
        act("light", 5, effects=[on("start")]),
        act("need", 5, conditions=[on("start")]),
        act("plan", 1, conditions=[on("start", False)]),
    )
    entries = Entry("light", 1, 6), Entry("need", 1, 6), Entry("plan", 8, 9)
    assert judged(task, 4, *entries) == (["state"], [])


def test_state_goals_are_never_carried() -> None:
    task = lamp(act("a", 3, effects=[on("end", False)]), initial=True, goals=[{"var": "on"}])
    assert judged(task, 9, Entry("a", 0, 3)) == (["goal"], [])


# The limit on what is told


def test_what_is_carried_never_crowds_out_a_violation() -> None:
    many = SHOWN_PER_RULE + 3
    actions = [act(f"a{i}", 1, deadline=0) for i in range(many)] + [act("plan", 1, deadline=0)]
    entries = [Entry(f"a{i}", i, i + 1) for i in range(many)]
    task, plan = task_of(*actions), Entry("plan", many, many + 1)
    verdict = validate(task, Schedule((*entries, plan)), many)
    assert (len(verdict.carried), dict(verdict.carried_omitted)) == (
        SHOWN_PER_RULE,
        {"deadline": 3},
    )
    assert [v.actions for v in verdict.violations] == [("plan",)]
    assert (verdict.valid, dict(verdict.omitted)) == (False, {})
    assert validate(task_of(*actions[:-1]), Schedule(tuple(entries)), many).valid


# How it is told


def test_what_is_carried_is_a_note_in_the_text_and_a_list_in_json() -> None:
    task = task_of(act("a", 3, deadline=2))
    verdict = irc.validate(task, Schedule((Entry("a", 0, 3),)), "1 s")
    assert str(verdict) == (
        "valid: makespan 3 s\n"
        "note: 1 violation carried, caused only by entries that began before 1 s:\n"
        "  rule 2, deadline: 'a' ends at 3 s, after its deadline (2 s)"
    )
    document = verdict.to_dict()
    assert (document["valid"], document["at"], document["violations"]) == (True, 1, [])
    (carried,) = document["carried"]
    assert (carried["rule"], carried["actions"], carried["times"]) == ("deadline", ["a"], [3, 2])


def test_the_time_is_read_in_the_tasks_unit() -> None:
    task = task_of(act("a", 3, deadline=2), time_unit="min")
    schedule = Schedule((Entry("a", 1, 4),))
    assert irc.validate(task, schedule, "61 s").valid
    assert not irc.validate(task, schedule, 1).valid
    with pytest.raises(TimeError):
        irc.validate(task, schedule, "soon")
