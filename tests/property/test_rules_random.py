"""Random tasks in which the three rules of an instant meet, against brute force.

The whole of it is `benchmarks/rules_random.py`.
"""

from __future__ import annotations

import pytest

import irc
from irc.execution import replan
from irc.schedule import Status
from oracles.online_judge import judge_step
from oracles.rules_random import rules_event, rules_task
from oracles.state_brute_force import optimum

SEEDS = {"cpsat": range(40, 60), "pddl21": range(40, 43)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("target", "seed"), [(target, seed) for target, seeds in SEEDS.items() for seed in seeds]
)
def test_answers_before_and_after_a_change_of_the_world_are_exact(target: str, seed: int) -> None:
    task = rules_task(seed)
    best = optimum(task)
    schedule = irc.solve(task, target=target, time_limit=5)
    if schedule.status is Status.OPTIMAL:
        assert best is not None
        assert schedule.makespan == best.vector[0]
        assert irc.validate(task, schedule).valid
    elif schedule.status is Status.INFEASIBLE:
        assert best is None
    event = rules_event(seed, schedule) if schedule.answered else None
    if event is None:
        return
    step = replan(task, schedule, event.at, [event], target=target, time_limit=5)
    if step.schedule.status is not Status.UNKNOWN:
        assert judge_step(task, schedule, step, [event]).faults == []
