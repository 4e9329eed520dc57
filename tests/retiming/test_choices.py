"""Re-timing with stock, calendars, modes, and actions that are absent or occur repeatedly."""

from __future__ import annotations

from typing import Any

import pytest

from builders import stock_task
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes.unroll import unroll
from irc.problem import Problem
from irc.problem.decisions import ABSENT, AnswerError, Decision
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule
from irc.validation import validate


def retimed(problem: Problem, task: Task, *decisions: Decision) -> Schedule:
    """The schedule of decisions in the problem's order, once the validator has agreed."""
    schedule = schedule_of(problem, retime(problem, decisions))
    verdict = validate(task, schedule)
    assert verdict.valid, verdict.violations
    return schedule


def spans(schedule: Schedule) -> list[tuple[str, Any, Any]]:
    return [(entry.id, entry.start, entry.end) for entry in schedule.entries]


def makes(name: str, amount: int, **fields: Any) -> dict[str, Any]:
    produces = [{"resource": "flour", "amount": amount}]
    return {"id": name, "duration": 2, "produces": produces, **fields}


def takes(name: str, amount: int, **fields: Any) -> dict[str, Any]:
    consumes = [{"resource": "flour", "amount": amount}]
    return {"id": name, "duration": 2, "consumes": consumes, **fields}


# Stock


def test_who_takes_waits_for_who_makes() -> None:
    task = stock_task(makes("a_mill", 2), takes("bake", 2))
    schedule = retimed(lower(task), task, Decision(3, 5), Decision(9, 11))
    assert spans(schedule) == [("a_mill", 0, 2), ("bake", 2, 4)]


def test_what_is_in_stock_from_the_start_is_not_waited_for() -> None:
    task = stock_task(takes("bake", 2), takes("cook", 1), initial=3)
    schedule = retimed(lower(task), task, Decision(3, 5), Decision(3, 5))
    assert spans(schedule) == [("bake", 0, 2), ("cook", 0, 2)]


def test_who_makes_waits_for_room() -> None:
    task = stock_task(takes("bake", 2, release=4), makes("mill", 2), initial=2, max=3)
    schedule = retimed(lower(task), task, Decision(5, 7), Decision(6, 8))
    assert spans(schedule) == [("mill", 2, 4), ("bake", 4, 6)]


def test_changes_that_only_fit_together_are_no_answer() -> None:
    """Neither 2 more nor 2 less than 1 is within [0, 2], and one of them comes first."""
    task = stock_task(makes("a_mill", 2), takes("bake", 2, release=5), initial=1, max=2)
    with pytest.raises(AnswerError, match="no order of 'a_mill', 'bake' at one instant"):
        retime(lower(task), (Decision(8, 10), Decision(10, 12)))


def test_a_swap_of_what_one_happening_takes_and_gives_counts_together() -> None:
    """A milestone that takes 2 and gives 2 leaves [0, 2] at no time."""
    swap = {**takes("swap", 2), **makes("swap", 2), "duration": 0}
    task = stock_task(swap, initial=1, max=2)
    schedule = retimed(lower(task), task, Decision(4, 4))
    assert spans(schedule) == [("swap", 0, 0)]


def test_a_level_that_may_be_passed_either_way_ties_nobody() -> None:
    task = stock_task(makes("a_mill", 2, release=6), takes("bake", 2), initial=2, max=9)
    schedule = retimed(lower(task), task, Decision(8, 10), Decision(10, 12))
    assert spans(schedule) == [("bake", 0, 2), ("a_mill", 6, 8)]


def test_the_order_of_changes_is_kept() -> None:
    task = stock_task(
        takes("a", 2), makes("b", 2), takes("c", 2), makes("d", 2, release=9), initial=2, max=2
    )
    schedule = retimed(
        lower(task), task, Decision(2, 4), Decision(3, 5), Decision(6, 8), Decision(20, 22)
    )
    assert spans(schedule) == [("a", 0, 2), ("b", 0, 2), ("c", 2, 4), ("d", 9, 11)]


# Calendars


def calendar_task(capacity: int, windows: list[dict[str, Any]], *lengths: int) -> Task:
    return Task.model_validate(
        {
            "resources": [{"id": "oven", "capacity": capacity, "availability": windows}],
            "actions": [
                {"id": f"a{k}", "duration": length, "uses": [{"resource": "oven"}]}
                for k, length in enumerate(lengths)
            ],
        }
    )


def test_what_starts_after_a_closed_window_goes_no_further_than_its_end() -> None:
    task = calendar_task(1, [{"from": 1, "to": 4, "capacity": 0}], 2)
    assert spans(retimed(lower(task), task, Decision(7, 9))) == [("a0", 4, 6)]


def test_a_window_of_more_capacity_is_not_left() -> None:
    task = calendar_task(1, [{"from": 3, "to": 9, "capacity": 2}], 3, 4)
    schedule = retimed(lower(task), task, Decision(4, 7), Decision(5, 9))
    assert spans(schedule) == [("a0", 3, 6), ("a1", 3, 7)]


def test_what_takes_no_time_heeds_no_calendar() -> None:
    task = calendar_task(1, [{"from": 0, "to": 4, "capacity": 0}], 0)
    assert spans(retimed(lower(task), task, Decision(7, 7))) == [("a0", 0, 0)]


def test_an_answer_inside_a_closed_window_is_refused() -> None:
    task = calendar_task(1, [{"from": 0, "to": 4, "capacity": 0}], 2)
    with pytest.raises(AnswerError, match="more of 'oven' is held"):
        retime(lower(task), [Decision(1, 3)])


def test_of_two_ovens_the_one_that_is_open_is_taken() -> None:
    closed = [{"from": 0, "to": 9, "capacity": 0}]
    task = Task.model_validate(
        {
            "resources": [{"id": "a_oven", "availability": closed}, {"id": "b_oven"}],
            "actions": [{"id": "bake", "duration": 2, "uses": [{"one_of": ["a_oven", "b_oven"]}]}],
        }
    )
    (entry,) = retimed(lower(task), task, Decision(3, 5)).entries
    assert (entry.start, dict(entry.resources)) == (0, {"b_oven": 1})


# Modes and presence


MODES = Task.model_validate(
    {
        "resources": [{"id": "hand"}, {"id": "mixer"}],
        "actions": [
            {
                "id": "stir",
                "modes": [
                    {"id": "by_hand", "duration": 5, "uses": [{"resource": "hand"}]},
                    {"id": "machine", "duration": 2, "uses": [{"resource": "mixer"}]},
                ],
            },
            {"id": "whip", "duration": 3, "uses": [{"resource": "mixer"}], "occurs": "optional"},
        ],
        "precedence": [{"before": "whip", "after": "stir"}],
    }
)


def test_a_chosen_mode_holds_its_own_resources_for_its_own_time() -> None:
    problem = lower(MODES)
    schedule = retimed(problem, MODES, Decision(9, 11, mode=1), Decision(2, 5))
    assert spans(schedule) == [("whip", 0, 3), ("stir", 3, 5)]
    stir = schedule.entries[1]
    assert (stir.mode, dict(stir.resources)) == ("machine", {"mixer": 1})


def test_an_absent_activity_binds_nobody_and_has_no_entry() -> None:
    schedule = retimed(lower(MODES), MODES, Decision(9, 14, mode=0), ABSENT)
    assert spans(schedule) == [("stir", 0, 5)]
    assert dict(schedule.entries[0].resources) == {"hand": 1}


def test_an_answer_without_the_mode_is_refused() -> None:
    with pytest.raises(AnswerError, match="no mode of 'stir'"):
        retime(lower(MODES), [Decision(9, 14), ABSENT])


def test_nothing_present_gives_an_empty_schedule() -> None:
    task = Task.model_validate({"actions": [{"id": "a", "duration": 1, "occurs": "optional"}]})
    assert retimed(lower(task), task, ABSENT).entries == ()


# Repeated actions


REPEATED = Task.model_validate(
    {"actions": [{"id": "cut", "duration": 2, "occurs": {"min": 0, "max": 3}}]}
)


def test_occurrences_follow_each_other_and_are_numbered_by_start() -> None:
    problem = unroll(lower(REPEATED), 3)
    schedule = retimed(problem, REPEATED, Decision(9, 11), Decision(1, 3), Decision(5, 7))
    assert [(e.occurrence, e.start) for e in schedule.entries] == [(1, 0), (2, 2), (3, 4)]


def test_an_occurrence_without_the_one_before_is_renumbered() -> None:
    problem = unroll(lower(REPEATED), 3)
    schedule = retimed(problem, REPEATED, ABSENT, ABSENT, Decision(5, 7))
    assert [(e.occurrence, e.start) for e in schedule.entries] == [(1, 0)]
