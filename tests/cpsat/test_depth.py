"""How many occurrences of repeated actions are tried, and what is claimed of the answer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from builders import problem_for_cpsat, task_of
from irc.diagnostics import Code, InputError
from irc.driver.judge import finish
from irc.driver.solve import solve_task
from irc.model import Task
from irc.problem import Problem
from irc.schedule import Entry, Schedule, Status
from irc.targets import Budget, ObjectiveLevel, Outcome, SolveOptions
from irc_cpsat.encoding.builder import Builder, OutOfTimeError
from irc_cpsat.encoding.encode import write_model
from irc_cpsat.solving.deepening import DeepeningSearch
from irc_cpsat.solving.depth import SLOTS_LIMIT, depths, enough

CHOP = {"id": "chop", "duration": 2, "occurs": {"min": 0}}


def eat(pieces: int, *, at_once: bool = False, **fields: Any) -> Task:
    """So many pieces are needed, of which each cut makes one."""
    chop = {**CHOP, "produces": [{"resource": "pieces", "amount": 1}]}
    if at_once:
        chop["duration"] = 0
    eaten = [{"resource": "pieces", "amount": pieces}]
    return Task.model_validate(
        {
            "resources": [{"id": "pieces", "kind": "reservoir"}],
            "actions": [chop, {"id": "eat", "duration": 1, "consumes": eaten}],
            **fields,
        }
    )


def outcome(
    *values: tuple[str, int, int | None], status: Status = Status.FEASIBLE, length: int = 8
) -> Outcome:
    return Outcome(
        status,
        "ortools",
        Schedule((Entry("chop", 0, length, {}),)),
        bound=next((bound or 0 for name, _, bound in values if name == "makespan"), 0),
        levels=tuple(ObjectiveLevel(*value) for value in values),
    )


def run_with(problem: Problem, answers: Callable[[Problem, int, float], Outcome]) -> Outcome:
    run = DeepeningSearch("ortools", problem, SolveOptions(), Budget())
    run.solve_at = answers  # type: ignore[method-assign]
    return run.run()


@pytest.mark.parametrize("pieces", [1, 3, 7, 13])
def test_occurrences_are_added_until_there_are_enough(pieces: int) -> None:
    answer = solve_task(eat(pieces), SolveOptions(time_limit=30, workers=1))
    assert answer.schedule.status is Status.OPTIMAL
    assert answer.schedule.makespan == 2 * pieces + 1


def test_within_a_deadline_too_many_occurrences_are_proven_impossible() -> None:
    answer = solve_task(eat(7, deadline=14), SolveOptions(time_limit=30, workers=1))
    assert answer.schedule.status is Status.INFEASIBLE


def test_occurrences_without_length_prove_nothing_where_none_suffice() -> None:
    starved = eat(65, at_once=True)
    answer = solve_task(starved, SolveOptions(time_limit=30, workers=1))
    assert answer.schedule.status is Status.UNKNOWN
    assert "at most 64 occurrences" in answer.notes[0].message


def test_more_occurrences_than_a_model_is_given_are_told() -> None:
    often = {**CHOP, "occurs": {"min": SLOTS_LIMIT + 1, "max": SLOTS_LIMIT + 9}}
    with pytest.raises(InputError, match=f"at most {SLOTS_LIMIT:,} occurrences"):
        solve_task(task_of(often), SolveOptions(time_limit=30, workers=1))


@pytest.mark.slow
def test_many_repeated_actions_get_one_occurrence_each() -> None:
    problem = problem_for_cpsat(
        task_of(*({**CHOP, "id": f"chop{k}"} for k in range(SLOTS_LIMIT // 2 + 1)))
    )
    assert list(depths(problem)) == [1]


def test_as_many_occurrences_are_enough_as_fit_one_after_another() -> None:
    problem = problem_for_cpsat(task_of({**CHOP, "release": 3}))
    assert enough(problem, 12) == 4
    assert enough(problem, None) is None
    soon = problem_for_cpsat(task_of({**CHOP, "release": 3, "latest_start": 8}))
    assert (enough(soon, None), enough(soon, 7)) == (3, 2)


def test_a_bound_of_too_few_occurrences_is_no_bound() -> None:
    task = task_of(CHOP, objective=["minimize_cost", "minimize_makespan"])
    problem = problem_for_cpsat(task)
    shallow = outcome(("cost", 5, 5), ("makespan", 8, 4))
    found = run_with(problem, lambda _problem, _depth, _share: shallow)
    assert [level.bound for level in found.levels] == [None, None]
    assert finish(task, problem, found, "cpsat", 0).status is Status.FEASIBLE


def test_a_shallow_optimum_without_a_deeper_proof_is_only_feasible() -> None:
    problem = problem_for_cpsat(task_of(CHOP, objective="minimize_cost"))
    found = run_with(problem, lambda *_: outcome(("cost", 5, 5), status=Status.OPTIMAL))
    assert found.status is Status.FEASIBLE
    assert found.levels == (ObjectiveLevel("cost", 5, None),)
    assert found.notes


def test_a_worse_answer_of_a_deeper_model_does_not_displace_the_best() -> None:
    problem = problem_for_cpsat(task_of(CHOP))
    deep = outcome(("makespan", 9, 6), length=9)
    shallow = outcome(("makespan", 8, 8), status=Status.OPTIMAL)
    found = run_with(problem, lambda _p, depth, _s: shallow if depth == 1 else deep)
    assert (found.status, found.schedule, found.bound) == (Status.FEASIBLE, shallow.schedule, 6)
    assert found.levels == (ObjectiveLevel("makespan", 8, 6),)


def test_more_reward_is_better_in_a_deeper_model() -> None:
    problem = problem_for_cpsat(task_of(CHOP, objective="maximize_reward", deadline=12))
    deep = outcome(("reward", 9, 9), status=Status.OPTIMAL)
    found = run_with(
        problem, lambda _p, depth, _s: outcome(("reward", 8, 8)) if depth == 1 else deep
    )
    assert found is deep


def test_a_model_that_is_not_complete_in_time_is_no_answer() -> None:
    """The time may be over while a model is written: what is asked then ends at once."""
    raw: dict[str, Any] = {
        "state": [{"id": "light"}],
        "actions": [
            {"id": "on", "duration": 1, "effects": [{"at": "end", "var": "light"}]},
            {"id": "read", "duration": 1, "conditions": [{"at": "start", "var": "light"}]},
        ],
    }
    problem = problem_for_cpsat(Task.model_validate(raw))
    builder = Builder(problem, True, True)
    builder.is_over = lambda: True
    with pytest.raises(OutOfTimeError, match="before its model was complete"):
        write_model(builder)
    search = DeepeningSearch("cpsat", problem, SolveOptions(), Budget(0.0))
    found = search.solve_at(problem, 1, 1.0)
    assert found.status is Status.UNKNOWN
    assert [note.code for note in found.notes] == [Code.NO_ANSWER]
