"""When CP-SAT begins from the compiler's list schedule, which stays known in any case."""

from __future__ import annotations

import pytest

from builders import after_passes
from irc.model import Task
from irc.passes.serial_sgs import quick_makespan
from irc.problem import Problem
from irc.schedule import Status
from irc.targets import Budget, Outcome, SolveOptions
from irc_cpsat.encoding.builder import Model
from irc_cpsat.solving import deepening
from irc_cpsat.solving.deepening import DeepeningSearch
from irc_cpsat.solving.levels import LexicographicResult

FISHER_THOMPSON_6 = (
    "2 1 0 3 1 6 3 7 5 3 4 6, 1 8 2 5 4 10 5 10 0 10 3 4, 2 5 3 4 5 8 0 9 1 1 4 7, "
    "1 5 0 5 2 5 3 3 4 8 5 9, 2 9 1 3 4 5 5 4 0 3 3 1, 1 3 3 3 5 9 0 10 4 4 2 1"
)
"""H. Fisher and G. L. Thompson, 1963: machine and duration of each operation of six jobs."""


def shop() -> Problem:
    actions, precedence = [], []
    for j, job in enumerate(FISHER_THOMPSON_6.split(", ")):
        numbers = [int(word) for word in job.split()]
        for k, (machine, duration) in enumerate(zip(numbers[::2], numbers[1::2], strict=True)):
            uses = [{"resource": f"m{machine}"}]
            actions.append({"id": f"{j}.{k}", "duration": duration, "uses": uses})
            if k:
                precedence.append({"before": f"{j}.{k - 1}", "after": f"{j}.{k}"})
    resources = [{"id": f"m{m}"} for m in range(6)]
    document = {"resources": resources, "actions": actions, "precedence": precedence}
    return after_passes(Task.model_validate(document))


def started(monkeypatch: pytest.MonkeyPatch, problem: Problem) -> tuple[Model, Outcome]:
    """The model that CP-SAT would begin with, and the outcome where it finds nothing."""
    given: list[Model] = []

    def nothing(built: Model, *_: object) -> LexicographicResult:
        given.append(built)
        return LexicographicResult(Status.UNKNOWN)

    monkeypatch.setattr(deepening, "solve_levels", nothing)
    search = DeepeningSearch("ortools", problem, SolveOptions(), Budget(10))
    outcome = search.solve_at(problem, 1, 1.0)
    return given[0], outcome


def test_cpsat_begins_without_a_list_schedule_that_is_not_the_best(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem = shop()
    reached = quick_makespan(problem)
    assert reached is not None
    assert reached > problem.bounds.makespan.value
    built, outcome = started(monkeypatch, problem)
    assert len(built.model.proto.solution_hint.vars) == 0
    assert outcome.status is Status.FEASIBLE
    assert outcome.schedule is not None
    assert outcome.schedule.makespan == reached


def test_of_many_activities_cpsat_begins_from_the_list_schedule(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(deepening, "_HINTED_FROM", 36)
    built, _ = started(monkeypatch, shop())
    assert len(built.model.proto.solution_hint.vars) == len(built.model.proto.variables)
