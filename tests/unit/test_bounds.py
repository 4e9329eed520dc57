"""The lower bounds of the passes: never above the optimum, and most often equal to it."""

from __future__ import annotations

import heapq
import json
import random
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import pytest
from oracles.brute_force import optimal_makespan
from oracles.generators import big_capacity_task, contended_task, random_task
from ortools.sat.python import cp_model

from irc.lower import lower
from irc.model import Task
from irc.passes import destructive
from irc.passes.contention import drop_uncontended, merge_pools
from irc.passes.critical_path import heads_and_tails
from irc.passes.destructive import destructive_bound
from irc.passes.energy import energy_bound, loads
from irc.passes.reduction import reduce_transitively
from irc.problem import Activity, Arc, Bound, Claim, Problem, Renewable, Requirement, Shared

ROBO_CHALLENGE = Path(__file__).parents[3] / "shared" / "data" / "robo_challenge"

Document = dict[str, Any]


def prepared(problem: Problem) -> Problem:
    """The problem as the bounds find it."""
    return heads_and_tails(drop_uncontended(merge_pools(reduce_transitively(problem))))


def bounded(problem: Problem) -> Problem:
    return destructive_bound(energy_bound(prepared(problem)))


def bound_of(**document: Any) -> Bound:
    return bounded(lower(Task.model_validate(document))).bound


def energy_of(**document: Any) -> Bound:
    return energy_bound(prepared(lower(Task.model_validate(document)))).bound


def action(name: str, duration: Any, resource: str | None = None, **more: Any) -> Document:
    uses = [] if resource is None else [{"resource": resource, "amount": more.pop("amount", 1)}]
    return {"id": name, "duration": duration, "uses": uses, **more}


# --- never above the optimum --------------------------------------------------------------------

SMALL_TASKS: dict[str, Callable[[random.Random], Task]] = {
    "everything": lambda rng: random_task(rng, actions=(2, 9)),
    "choices": lambda rng: random_task(rng, actions=(4, 8), windows=False, tighten=0.0),
    "maximum lags": lambda rng: random_task(rng, actions=(4, 9), one_of=False, capacities=(1, 2)),
    "big capacities": lambda rng: big_capacity_task(rng, actions=(3, 9)),
    "robots": lambda rng: contended_task(rng, rng.randint(4, 10)),
}


def small_problems(kind: str, count: int) -> Iterator[tuple[Problem, int | None]]:
    """Prepared problems and their optimum, where the lags do not contradict each other."""
    for seed in range(count):
        task = SMALL_TASKS[kind](random.Random(f"{kind} {seed}"))
        best = optimal_makespan(task)
        try:
            yield prepared(lower(task)), best
        except ValueError:
            assert best is None


@pytest.mark.parametrize("kind", SMALL_TASKS)
def test_no_bound_exceeds_the_optimum(kind: str) -> None:
    compared = 0
    for problem, best in small_problems(kind, 120):
        by_energy = energy_bound(problem)
        bounds = [by_energy, destructive_bound(problem), destructive_bound(by_energy)]
        assert by_energy.bound.value >= problem.bound.value
        assert bounds[2].bound.value >= by_energy.bound.value
        if best is not None:
            assert max(p.bound.value for p in bounds) <= best
            compared += problem.has_contention
    assert compared > 50


@pytest.mark.parametrize("steps", [0, 40, 400, 4_000])
def test_an_early_end_of_the_budget_leaves_a_true_bound(
    steps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(destructive, "BASE_STEPS", steps)
    monkeypatch.setattr(destructive, "STEPS_PER_ACTIVITY", 0)
    for problem, best in small_problems("everything", 60):
        value = destructive_bound(problem).bound.value
        assert value >= problem.bound.value
        assert best is None or value <= best


@pytest.mark.parametrize("factor", [7, 10**6 + 3, 10**15])
def test_long_times_change_nothing_but_the_scale(factor: int) -> None:
    for problem, best in small_problems("robots", 25):
        value = bounded(scaled(problem, factor)).bound.value
        assert value % factor == 0 or value < best * factor
        assert value <= best * factor
        assert value >= factor * energy_bound(problem).bound.value


def scaled(problem: Problem, factor: int) -> Problem:
    """A task of robots and minimum lags with all times multiplied, in the same ticks."""
    return replace(
        problem,
        bound=Bound(0, ""),
        activities=tuple(
            replace(a, duration_min=a.duration_min * factor, duration_max=a.duration_max * factor)
            for a in problem.activities
        ),
        arcs=tuple(arc._replace(min_lag=arc.min_lag * factor) for arc in problem.arcs),
    )
