"""Objectives in their order, with honest statuses and bounds, within one time limit."""

from __future__ import annotations

import time
from collections.abc import Sequence
from itertools import permutations
from typing import Any

import pytest
from ortools.sat.python import cp_model

from builders import problem_for_cpsat
from irc.driver.judge import finish
from irc.driver.solve import solve_task
from irc.model import Task
from irc.schedule import ObjectiveValue, Schedule, Status
from irc.targets import Budget, SolveOptions
from irc_cpsat.encoding.builder import Builder, Model
from irc_cpsat.encoding.encode import write_model
from irc_cpsat.solving.deepening import DeepeningSearch
from irc_cpsat.solving.levels import LevelResult, solve_levels
from oracles.state_brute_force import optimum
from oracles.state_generators import reward_task

OBJECTIVES = ("minimize_makespan", "minimize_tardiness", "maximize_reward", "minimize_cost")


def shop(*objective: str, **fields: Any) -> Task:
    """Two presses' worth of work on one: each objective asks for another selection or order."""
    press = {"uses": [{"resource": "press"}]}
    return Task.model_validate(
        {
            "resources": [{"id": "press"}],
            "actions": [
                {"id": "long", "duration": 5, "due": 4, "weight": 1, "cost": 1, **press},
                {"id": "short", "duration": 2, "due": 2, "weight": 2, **press},
                {
                    "id": "extra",
                    "duration": 3,
                    "occurs": "optional",
                    "due": 3,
                    "reward": 4,
                    "cost": -2,
                    **press,
                },
                {"id": "chore", "duration": 1, "occurs": "optional", "reward": -1, "cost": -5},
            ],
            "objective": list(objective),
            **fields,
        }
    )


def solved(task: Task, seconds: float = 30, **options: Any) -> Schedule:
    return solve_task(task, SolveOptions(time_limit=seconds, workers=1, **options)).schedule


@pytest.mark.parametrize(
    "others", [(), ("minimize_makespan",), ("maximize_reward", "minimize_cost")]
)
def test_nothing_changes_where_there_is_no_earlier_schedule(others: tuple[str, ...]) -> None:
    """The objective stands at its place in the order, as 0, and takes nothing from the others."""
    plain = list(solved(shop(*others)).objective) if others else []
    for place in range(len(others) + 1):
        task = shop(*others[:place], "minimize_changes", *others[place:])
        schedule = solved(task)
        assert schedule.status is Status.OPTIMAL
        changes = ObjectiveValue("changes", 0, 0)
        assert list(schedule.objective) == [*plain[:place], changes, *plain[place:]]


@pytest.mark.slow
@pytest.mark.parametrize("order", [o for n in range(1, 5) for o in permutations(OBJECTIVES, n)])
def test_objectives_count_in_their_order(order: tuple[str, ...]) -> None:
    task = shop(*order)
    best, schedule = optimum(task), solved(task)
    assert best is not None
    assert schedule.status is Status.OPTIMAL
    assert tuple(o.value for o in schedule.objective) == best.vector
    assert all(o.bound == o.value for o in schedule.objective)


def test_doing_nothing_is_an_answer_where_nothing_pays() -> None:
    losses = [
        {"id": f"a{k}", "duration": 1, "occurs": "optional", "reward": -1 - k} for k in range(3)
    ]
    schedule = solved(Task.model_validate({"actions": losses, "objective": "maximize_reward"}))
    assert (schedule.status, schedule.entries) == (Status.OPTIMAL, ())


class _Stops:
    """CP-SAT that is stopped at a level, with a bound of its own."""

    def __init__(self, level: int, bound: float) -> None:
        self.level, self.bound, self.calls = level, bound, 0
        self.seconds: list[float] = []

    def __call__(
        self, built: Model, objective: str, earlier: Sequence[LevelResult], budget: Budget
    ) -> Any:
        solver = cp_model.CpSolver()
        solver.parameters.num_workers = 1
        status = solver.solve(built.model)
        self.seconds.append(budget.left)
        self.calls += 1
        if self.calls <= self.level:
            return status, solver
        return cp_model.FEASIBLE, _Bounded(solver, self.bound)


class _Bounded:
    def __init__(self, solver: cp_model.CpSolver, bound: float) -> None:
        self.solver, self.best_objective_bound = solver, bound

    def __getattr__(self, name: str) -> Any:
        return getattr(self.solver, name)


def stopped(task: Task, level: int, bound: float) -> tuple[Schedule, _Stops]:
    problem = problem_for_cpsat(task)
    stops = _Stops(level, bound)
    built = write_model(Builder(problem, bounds=True, hints=True))
    answer = solve_levels(built, stops, Budget(30))
    outcome = DeepeningSearch("ortools", problem, SolveOptions(), Budget()).outcome_of(
        problem, built, answer
    )
    return finish(task, problem, outcome, "cpsat", 0), stops


def test_a_reward_is_bounded_from_above() -> None:
    schedule, _ = stopped(shop("maximize_reward", "minimize_makespan"), 0, 6.9999999)
    assert schedule.status is Status.FEASIBLE
    assert [(o.name, o.value, o.bound) for o in schedule.objective] == [
        ("reward", 4, 7),
        ("makespan", 10, None),
    ]


def test_a_cost_is_bounded_from_below() -> None:
    schedule, _ = stopped(shop("minimize_cost", "maximize_reward"), 0, -7.0000001)
    assert [(o.value, o.bound) for o in schedule.objective] == [(-6, -7), (3, None)]


def test_behind_a_gap_no_bound_is_told() -> None:
    """What is best among schedules of an unproven cost bounds nothing."""
    task = shop("minimize_cost", "maximize_reward", "minimize_makespan")
    schedule, stops = stopped(task, 1, 9.0)
    assert schedule.status is Status.FEASIBLE
    assert [(o.value, o.bound) for o in schedule.objective] == [(-6, -6), (3, 9), (10, None)]
    assert stops.calls == 2


def test_a_bound_that_is_met_on_every_level_is_a_proof() -> None:
    schedule, _ = stopped(shop("minimize_cost", "maximize_reward"), 1, 3.0)
    assert schedule.status is Status.OPTIMAL


def test_levels_share_one_time_limit() -> None:
    _, stops = stopped(shop(*OBJECTIVES), 4, 0)
    assert len(stops.seconds) == 4
    assert stops.seconds == sorted(stops.seconds, reverse=True)
    assert stops.seconds[-1] < stops.seconds[0] <= 30


@pytest.mark.alone
@pytest.mark.parametrize("seed", [0, 1])
def test_the_time_limit_holds_over_all_levels(seed: int) -> None:
    began = time.perf_counter()
    schedule = solved(reward_task(seed), seconds=1.5)
    assert time.perf_counter() - began < 6
    assert schedule.status in (Status.OPTIMAL, Status.FEASIBLE)


def test_one_worker_and_one_seed_give_one_answer() -> None:
    task = shop("maximize_reward", "minimize_tardiness")
    first, *others = [solved(task, seed=7).entries for _ in range(3)]
    assert others == [first, first]
