"""What a schedule is worth: makespan, tardiness, reward and cost, in the task's unit."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from builders import act, problem_of
from irc.problem.objective_values import in_units, schedule_values
from irc.schedule import Entry, Schedule


def schedule(*entries: tuple[str, Any, Any]) -> Schedule:
    return Schedule(tuple(Entry(name, start, end, {}) for name, start, end in entries))


def test_an_empty_schedule_is_worth_nothing() -> None:
    problem = problem_of(act("a", occurs="optional", reward=3, cost=2, due=1))
    assert set(schedule_values(problem, schedule()).values()) == {0}


def test_each_occurrence_counts() -> None:
    problem = problem_of(act("a", occurs={"min": 0, "max": 3}, reward=3, cost=2, due=3, weight=5))
    values = schedule_values(problem, schedule(("a", 0, 2), ("a", 2, 4)))
    assert (
        values.items()
        >= {"makespan": 4, "tardiness": 5, "reward": 6, "cost": 4, "changes": 0}.items()
    )


def test_what_is_cancelled_costs_and_is_worth_nothing_to_itself_or_its_group() -> None:
    group = {"id": "g", "actions": ["a", "b"], "reward": 10, "due": 0}
    problem = problem_of(act("a", reward=3, cost=2, due=0), act("b"), groups=[group])
    cut, b = Entry("a", 0, 1, status="cancelled"), Entry("b", 0, 2)
    values = schedule_values(problem, Schedule((cut, b)))
    assert (
        values.items()
        >= {"makespan": 2, "tardiness": 0, "reward": 0, "cost": 2, "changes": 0}.items()
    )


def test_what_is_abandoned_is_worth_what_it_is_and_its_group_nothing() -> None:
    group = {"id": "g", "actions": ["a", "b"], "reward": 10, "due": 0, "required": False}
    problem = problem_of(act("a", reward=3, cost=2, due=1), act("b"), groups=[group])
    values = schedule_values(problem, Schedule((Entry("a", 0, 2, status="abandoned"),)))
    assert (
        values.items()
        >= {"makespan": 2, "tardiness": 1, "reward": 3, "cost": 2, "changes": 0}.items()
    )


def test_losses_and_refunds_are_kept_with_their_signs() -> None:
    problem = problem_of(act("a", reward=-3), act("b", reward=1))
    values = schedule_values(problem, schedule(("a", 0, 2), ("b", 0, 2)))
    assert values["reward"] == -2


@pytest.mark.parametrize(("due", "late"), [(3, 0), (2, 0), (1, 1), ("1/2", Fraction(3, 2))])
def test_only_what_ends_behind_its_due_date_is_late(due: Any, late: Any) -> None:
    problem = problem_of(act("a", due=due))
    assert schedule_values(problem, schedule(("a", 0, 2)))["tardiness"] == late


def test_a_weight_of_nothing_makes_lateness_harmless() -> None:
    problem = problem_of(act("a", due=0, weight=0))
    assert schedule_values(problem, schedule(("a", 0, 2)))["tardiness"] == 0


def group(**fields: Any) -> dict[str, Any]:
    return {"id": "g", "actions": ["a", "b"], "required": False, **fields}


def test_a_group_counts_once_and_is_as_late_as_its_last_member() -> None:
    problem = problem_of(act("a"), act("b"), groups=[group(reward=7, due=3, weight=2)])
    values = schedule_values(problem, schedule(("a", 0, 2), ("b", 4, 6)))
    assert (values["reward"], values["tardiness"]) == (7, 6)


@pytest.mark.parametrize("present", [(), ("a",)])
def test_a_group_that_is_not_complete_is_worth_nothing(present: tuple[str, ...]) -> None:
    problem = problem_of(act("a"), act("b"), groups=[group(reward=7, due=0)])
    values = schedule_values(problem, schedule(*((name, 0, 2) for name in present)))
    assert (values["reward"], values["tardiness"]) == (0, 0)


def test_an_empty_group_is_worth_nothing() -> None:
    problem = problem_of(act("a"), groups=[{"id": "g", "actions": [], "reward": 7}])
    assert schedule_values(problem, schedule(("a", 0, 2)))["reward"] == 0


def test_times_are_counted_in_ticks_and_the_rest_in_units() -> None:
    problem = problem_of(act("a", "1/3"))
    assert in_units(problem, "makespan", 2) == Fraction(2, 3)
    assert in_units(problem, "reward", 2) == 2
