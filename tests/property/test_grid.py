"""The times that a makespan can have: no best schedule ends at another one."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace

import pytest

import irc
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.passes.grid import grid_of
from irc.problem import PreviousPlace, PreviousPlan, Problem
from irc.targets import Budget, Outcome, Program, SolveOptions, get_backend
from irc_cpsat.engines import OrTools
from oracles.brute_force import optimal_makespan
from oracles.coarse import coarse_task
from oracles.generators import random_task

PLAIN = OrTools(bounds=False, hints=False)
USUAL = OrTools()


def solved(task: Task, problem: Problem, engine: OrTools) -> Outcome:
    program = Program(get_backend("cpsat"), task, problem)
    return engine.solve(program, SolveOptions(workers=1), Budget(20))


def levels(outcome: Outcome) -> list[object]:
    return [(level.name, level.value) for level in outcome.levels]


def spread(task: Task, rng: random.Random) -> Task:
    """The task with durations and lags six times as long, and other times shifted a little."""
    document = task.model_dump(mode="json", by_alias=True, exclude_unset=True)
    for action in document["actions"]:
        duration = action["duration"]
        fixed = not isinstance(duration, dict)
        action["duration"] = duration * 6 if fixed else {k: v * 6 for k, v in duration.items()}
        for field in {"release", "start"} & action.keys():
            action[field] = action[field] * 6 + rng.randrange(4)
        for field in {"deadline", "latest_start"} & action.keys():
            action[field] = action[field] * 6 + 5
    for order in document.get("precedence", []):
        for field in {"min_lag", "max_lag"} & order.keys():
            order[field] *= 6
    return Task.model_validate(document)


@pytest.mark.parametrize("seed", range(60))
def test_what_brute_force_finds_is_on_the_grid(seed: int) -> None:
    rng = random.Random(seed)
    task = spread(random_task(rng, actions=(2, 4), tighten=0.0, task_deadline=False), rng)
    best = optimal_makespan(task)
    if best is None:
        return
    raw = lower(task)
    for problem in (raw, run_passes(raw)):
        ticks = int(best / problem.tick)
        assert grid_of(problem).up(ticks) == ticks
        assert problem.bounds.makespan.value <= ticks


def comparable() -> Iterator[tuple[int, Task, Problem]]:
    for seed in range(2_000, 2_060):
        task = coarse_task(random.Random(seed))
        if irc.check(task).ok:
            yield seed, task, lower(task)


@pytest.mark.slow
def test_answers_are_the_same_with_and_without_what_the_compiler_knows() -> None:
    different = {}
    for seed, task, raw in comparable():
        problem = run_passes(raw)
        if problem.deadline is not None and problem.bounds.makespan.value > problem.deadline:
            continue
        plain, usual = solved(task, raw, PLAIN), solved(task, problem, USUAL)
        if (plain.status, levels(plain)) != (usual.status, levels(usual)):
            different[seed] = levels(plain), levels(usual)
    assert different == {}


def test_a_time_off_the_grid_of_fixed_starts_is_not_asked_for() -> None:
    """Durations of 6 after a fixed start at 4: makespans are 0 or 4 modulo 6."""
    task = Task.model_validate(
        {
            "resources": [{"id": "oven"}],
            "actions": [
                {"id": "a", "duration": 6, "uses": [{"resource": "oven"}]},
                {"id": "b", "duration": 6, "uses": [{"resource": "oven"}]},
                {"id": "check", "duration": 1, "start": 3, "uses": [{"resource": "oven"}]},
            ],
        }
    )
    grid = grid_of(lower(task))
    assert (grid.step, grid.residues) == (6, (0, 3, 4))
    assert [*grid.between(5, 16)] == [6, 9, 10, 12, 15, 16]
    assert irc.solve(task).makespan == 16


def test_state_may_keep_happenings_a_tick_apart() -> None:
    task = coarse_task(random.Random(1))
    problem = lower(task)
    assert problem.variables
    assert grid_of(problem).up(7) == 7


def test_what_should_stay_in_place_keeps_its_time_on_the_grid() -> None:
    """(The release makes ticks of 1.)"""
    actions = [{"id": "a", "duration": 6}, {"id": "b", "duration": 6, "release": 1}]
    task = Task.model_validate({"actions": actions, "objective": "minimize_changes"})
    problem = replace(lower(task), previous=PreviousPlan((PreviousPlace(2, None, ()), None)))
    assert grid_of(problem).residues == (0, 1, 2)
