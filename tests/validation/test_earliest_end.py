"""Rule 2.9: no action ends before its earliest end; and the range of a start."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from irc.frontends.dsl.reader import read_dsl
from irc.schedule import Entry, Schedule


def broken(end: int, **fields: Any) -> set[str]:
    task = irc.Task(actions=[{"id": "a", "duration": {"min": 1, "max": 9}, **fields}]).ir
    found = irc.validate(task, Schedule((Entry("a", 0, end),)))
    return {violation.rule for violation in found.violations}


def test_an_end_at_the_very_time_is_late_enough() -> None:
    assert broken(6, earliest_end=6) == set()
    assert broken(5, earliest_end=6) == {"earliest_end"}


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_both_targets_wait_for_it(target: str) -> None:
    actions = [
        {"id": "a", "duration": 2, "earliest_end": 7},
        {"id": "b", "duration": {"min": 1, "max": 4}, "earliest_end": 9},
        {"id": "c", "duration": 1, "uses": [{"resource": "r"}]},
        {"id": "d", "duration": 1, "uses": [{"resource": "r"}]},
    ]
    task = irc.Task(resources=[{"id": "r"}], actions=actions, precedence=[["a", "c"]])
    schedule = irc.solve(task, target, shortcut=False, time_limit=5)
    ends = {e.id: e.end for e in schedule.entries}
    assert schedule.makespan == 9
    assert (ends["a"], ends["b"]) == (7, 9)


def test_a_range_of_starts_is_a_release_and_a_latest_start() -> None:
    task = irc.Task(actions=[{"id": "a", "duration": 2, "start": {"min": 3, "max": "5 s"}}]).ir
    action = task.actions[0]
    assert (action.release, task.number(action.latest_start), action.start) == (3, 5, None)


def test_a_range_of_starts_and_a_release_are_one_too_many() -> None:
    report = irc.check({"actions": [{"id": "a", "duration": 2, "start": {"min": 3}, "release": 1}]})
    assert "mean the same" in str(report)


def test_the_range_of_a_start_in_the_dsl() -> None:
    document = read_dsl("a 5 starts at 3 .. 6 ends from 9").document
    (action,) = irc.Task(**document).ir.actions
    assert (action.release, action.latest_start, action.earliest_end) == (3, 6, 9)


def test_what_ended_too_early_is_carried_when_it_was_observed() -> None:
    task = irc.Task(
        actions=[{"id": "a", "duration": 4, "earliest_end": 4}, {"id": "b", "duration": 3}],
        precedence=[["a", "b"]],
    ).ir
    plan = irc.solve(task)
    event = irc.Event(2).observe("a", started=0, finished=2)
    step = irc.replan(task, plan, 2, [event])
    assert {e.id: e.start for e in step.schedule.entries} == {"a": 0, "b": 2}


def test_an_end_that_cannot_be_that_late_is_an_error_before_any_solver() -> None:
    report = irc.check(
        {"actions": [{"id": "a", "duration": 2, "latest_start": 3, "earliest_end": 9}]}
    )
    (error,) = report.errors
    assert error.pointer == ("actions", 0, "earliest_end")
    assert "at most 5 s" in (error.hint or "")
