"""Slack judged from the other side: delay one action, re-time forwards, look at the end."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import pytest

from builders import after_passes
from irc.lowering.lower import lower
from irc.passes import run_passes
from irc.passes.serial_sgs import list_schedule
from irc.problem import Activity, Problem, Renewable, Requirement
from irc.problem.decisions import AnswerError, Decision, Placed
from irc.retiming.retime import earliest_schedule, retime
from irc.retiming.slack import slacks
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Entry, Schedule
from irc.validation import validate
from oracles.generators import contended_task, random_task


def earliest_slacks(document: Mapping[str, Any]) -> dict[str, int]:
    problem = after_passes(document)
    return slacks(problem, schedule_of(problem, earliest_schedule(problem)))


def by_rule(problem: Problem) -> tuple[Placed, ...] | None:
    """A schedule by the list rule, with the resources that the rule chose."""
    found = list_schedule(problem)
    if found is None:
        return None
    decisions = []
    for i, (decision, choice) in enumerate(zip(*found, strict=True)):
        activity = problem.activities[i]
        chosen = [problem.contention.fixed_choices.get((i, u)) for u in range(len(activity.uses))]
        for claim, r in zip(activity.open_demands, choice, strict=True):
            members = problem.contention.pools[r].members
            chosen[claim.use] = members[0] if len(members) == 1 else None
        decisions.append(replace(decision, chosen=tuple(chosen)))
    return retime(problem, decisions)


def delayed(
    problem: Problem, placed: Sequence[Placed], index: int, ticks: int
) -> tuple[Placed, ...] | None:
    """The schedule when one action starts later by `ticks`; None where something forbids that."""
    activities = list(problem.activities)
    release = placed[index].start + ticks
    activities[index] = replace(activities[index], release=release)
    decisions = [Decision(p.start, p.end, p.resources) for p in placed]
    try:
        later = retime(replace(problem, activities=tuple(activities)), decisions)
    except AnswerError:
        return None
    if max(p.end for p in later) > max(p.end for p in placed):
        return None
    deadlines = (problem.effective_deadline(i) for i in range(len(placed)))
    met = all(d is None or p.end <= d for d, p in zip(deadlines, later, strict=True))
    return later if met else None


@pytest.mark.slow
def test_any_action_can_be_delayed_by_its_slack_and_not_by_a_tick_more() -> None:
    judged = delays = 0
    for seed in range(250):
        task = random_task(random.Random(seed), tighten=0)
        problem = run_passes(lower(task))
        placed = by_rule(problem)
        if not placed:
            continue
        slack = slacks(problem, schedule_of(problem, placed))
        for i, activity in enumerate(problem.activities):
            later = delayed(problem, placed, i, slack[activity.id])
            assert later is not None, (seed, activity.id)
            assert later[i].start == placed[i].start + slack[activity.id]
            assert validate(task, schedule_of(problem, later)).valid, (seed, activity.id)
            assert delayed(problem, placed, i, slack[activity.id] + 1) is None, (seed, activity.id)
            delays += slack[activity.id] > 0
        judged += 1
    assert judged > 150
    assert delays > 100


def test_a_larger_contended_schedule_keeps_its_makespan_too() -> None:
    problem = run_passes(lower(contended_task(random.Random(5), 60)))
    placed = by_rule(problem)
    assert placed is not None
    slack = slacks(problem, schedule_of(problem, placed))
    assert 0 in slack.values()
    for i, activity in enumerate(problem.activities):
        assert delayed(problem, placed, i, slack[activity.id]) is not None
        assert delayed(problem, placed, i, slack[activity.id] + 1) is None


def test_only_what_lies_off_the_critical_path_has_slack() -> None:
    assert earliest_slacks(
        {
            "actions": [
                {"id": "boil", "duration": 10},
                {"id": "chop", "duration": 3},
                {"id": "cook", "duration": 5},
            ],
            "precedence": [["boil", "cook"], ["chop", "cook"]],
        }
    ) == {"boil": 0, "chop": 7, "cook": 0}


def test_actions_in_a_row_have_their_slack_in_common() -> None:
    found = earliest_slacks(
        {
            "actions": [
                {"id": "bake", "duration": 10},
                {"id": "chop", "duration": 2},
                {"id": "mix", "duration": 3},
            ],
            "precedence": [["chop", "mix"]],
        }
    )
    assert found == {"bake": 0, "chop": 5, "mix": 5}


def test_the_order_on_a_resource_takes_slack_away() -> None:
    document = {
        "resources": [{"id": "knife"}],
        "actions": [
            {"id": "first", "duration": 4, "uses": [{"resource": "knife"}]},
            {"id": "second", "duration": 5, "uses": [{"resource": "knife"}]},
            {"id": "other", "duration": 6},
        ],
    }
    problem = after_passes(document)
    placed = retime(problem, [Decision(0, 4), Decision(0, 6), Decision(4, 9)])
    assert slacks(problem, schedule_of(problem, placed)) == {"first": 0, "other": 3, "second": 0}


def test_what_overlaps_on_a_resource_may_part() -> None:
    document = {
        "resources": [{"id": "knife", "capacity": 2}],
        "actions": [
            {"id": "a", "duration": 4, "uses": [{"resource": "knife"}]},
            {"id": "b", "duration": 9, "uses": [{"resource": "knife"}]},
        ],
    }
    assert earliest_slacks(document) == {"a": 5, "b": 0}


@pytest.mark.parametrize(
    ("limit", "slack"),
    [
        ({"deadline": 5}, 2),
        ({"deadline": 50}, 7),
        ({"start": 0}, 0),
        ({"latest_start": 4}, 4),
        ({"latest_start": 50}, 7),
        ({}, 7),
    ],
)
def test_a_window_of_its_own_limits_the_delay(limit: dict[str, int], slack: int) -> None:
    document = {
        "actions": [{"id": "long", "duration": 10}, {"id": "short", "duration": 3, **limit}]
    }
    assert earliest_slacks(document) == {"long": 0, "short": slack}


def test_a_maximum_lag_holds_an_action_to_an_earlier_one() -> None:
    found = earliest_slacks(
        {
            "actions": [
                {"id": "long", "duration": 20},
                {"id": "grill", "duration": 4, "deadline": 6},
                {"id": "serve", "duration": 1},
            ],
            "precedence": [{"before": "grill", "after": "serve", "max_lag": 3}],
        }
    )
    assert found == {"grill": 2, "long": 0, "serve": 5}


def test_slack_is_in_ticks() -> None:
    document = {"actions": [{"id": "long", "duration": 100}, {"id": "short", "duration": "1/4"}]}
    problem = after_passes(document)
    found = slacks(problem, schedule_of(problem, earliest_schedule(problem)))
    assert problem.to_units(found["short"]) == 100 - problem.to_units(1)
    assert problem.to_ticks(problem.to_units(found["short"])) == found["short"]


def test_what_was_chosen_to_have_no_length_keeps_none() -> None:
    found = earliest_slacks(
        {
            "actions": [
                {"id": "long", "duration": 9},
                {"id": "pause", "duration": {"min": 0, "max": 4}, "deadline": 7, "start": 2},
                {"id": "mark", "duration": 0},
            ],
            "precedence": [{"before": "mark", "after": "pause", "type": "finish-finish"}],
        }
    )
    assert found == {"long": 0, "mark": 2, "pause": 0}


def test_a_chosen_mode_keeps_its_duration() -> None:
    problem = after_passes(
        {
            "actions": [
                {"id": "long", "duration": 9},
                {"id": "cut", "duration": {"min": 2, "max": 6}},
            ]
        }
    )
    entries = (Entry("cut", 0, 6, mode="by hand"), Entry("long", 0, 9))
    assert slacks(problem, Schedule(entries)) == {"cut": 3, "long": 0}


def test_zero_durations_neither_hold_nor_wait_for_a_resource() -> None:
    use = (Requirement((0,), 1),)
    problem = Problem(
        None,
        "s",
        after_passes({"actions": [{"id": "a", "duration": 1}]}).tick,
        (Activity("busy", 8, 8, uses=use), Activity("mark", 0, 0, uses=use)),
        (Renewable("desk", 1),),
    )
    entries = (Entry("busy", 0, 8, {"desk": 1}), Entry("mark", 0, 0, {"desk": 1}))
    assert slacks(problem, Schedule(entries)) == {"busy": 0, "mark": 8}


def test_no_entries_no_slack() -> None:
    problem = after_passes({"actions": [{"id": "a", "duration": 1}]})
    assert slacks(problem, Schedule(())) == {}


@pytest.mark.parametrize(
    ("entries", "told"),
    [
        ((Entry("a", 0, 1),), "exactly the actions"),
        ((Entry("a", 0, 1), Entry("a", 1, 2), Entry("b", 2, 3)), "exactly the actions"),
        ((Entry("a", 0, 1, {"moon": 1}), Entry("b", 1, 2)), "no resource 'moon'"),
        ((Entry("a", 1, 2), Entry("b", 0, 1)), "'a' is later"),
    ],
)
def test_a_schedule_of_something_else_is_refused(entries: tuple[Entry, ...], told: str) -> None:
    problem = after_passes(
        {
            "actions": [{"id": "a", "duration": 1}, {"id": "b", "duration": 1}],
            "precedence": [["a", "b"]],
        }
    )
    with pytest.raises(AnswerError, match=told):
        slacks(problem, Schedule(entries))


def test_an_order_that_contradicts_the_lags_is_refused() -> None:
    problem = after_passes(
        {
            "resources": [{"id": "knife"}],
            "actions": [
                {"id": "a", "duration": 2, "uses": [{"resource": "knife"}]},
                {"id": "b", "duration": 2, "uses": [{"resource": "knife"}]},
            ],
            "precedence": [["a", "b"]],
        }
    )
    entries = (Entry("b", 0, 2, {"knife": 1}), Entry("a", 2, 4, {"knife": 1}))
    with pytest.raises(AnswerError, match="contradicts the lags"):
        slacks(problem, Schedule(entries))


@pytest.mark.slow
def test_ranks_decide_nothing_where_there_is_neither_state_nor_stock() -> None:
    """Each schedule that is valid with its ranks is valid without, and has the same slack."""
    rng = random.Random("ranks of plain schedules")
    seen = 0
    for _ in range(400):
        task = contended_task(rng, 4)
        problem = run_passes(lower(task))
        placed = by_rule(problem)
        if placed is None or problem.has_calendars:
            continue
        plain = schedule_of(problem, placed)
        entries = tuple(
            replace(e, rank=(rank := rng.randint(0, 2)), end_rank=rank) for e in plain.entries
        )
        if not validate(task, Schedule(entries)).valid:
            continue
        seen += any(e.rank for e in entries)
        assert validate(task, plain).valid
        assert slacks(problem, Schedule(entries)) == slacks(problem, plain)
    assert seen > 20
