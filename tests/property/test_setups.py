"""Set-ups: `cpsat` finds the optimum of brute force, and re-timing and validator agree with it."""

from __future__ import annotations

import random

import pytest

import irc
from irc.model import Task
from oracles.setups import best, random_task

_FIRST, _COUNT = 20_000, 30


def answer_of(document: dict[str, object]) -> tuple[object, ...] | None:
    """The values of the objectives by `cpsat`, as the validator computes them."""
    task = Task.model_validate(document)
    schedule = irc.solve(task, time_limit=30, workers=1)
    if schedule.status == "infeasible":
        return None
    assert schedule.status == "optimal"
    verdict = irc.validate(task, schedule)
    assert verdict.valid, verdict
    names = (name.split("_", 1) for name in task.objective)
    return tuple(
        -verdict.objective[name] if way == "maximize" else verdict.objective[name]
        for way, name in names
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(_FIRST, _FIRST + _COUNT))
def test_cpsat_finds_the_optimum_of_brute_force(seed: int) -> None:
    document = random_task(random.Random(seed))
    assert answer_of(document) == best(document)


def test_a_use_that_could_be_elsewhere_may_save_a_setup() -> None:
    """Between `a` and what was first, `c` breaks the triangle: 2 instead of 5."""
    rows = [
        {"from": "*", "to": "blue", "time": 5},
        {"from": "green", "to": "blue", "time": 2},
    ]
    document = {
        "resources": [{"id": "m", "setups": {"initial": "clean", "times": rows}}, {"id": "p"}],
        "actions": [
            {"id": "a", "duration": 3, "uses": [{"resource": "m", "family": "blue"}]},
            {"id": "c", "duration": 1, "uses": [{"one_of": ["m", "p"], "family": "green"}]},
        ],
    }
    assert answer_of(document) == best(document) == (6,)
