"""Due dates with planners: lateness is never better than `cpsat` proves, and often as good."""

from __future__ import annotations

import random
from importlib.util import find_spec
from itertools import pairwise

import pytest

import irc
from builders import Document, after_passes, lettered, task_of
from irc.api import validate
from irc.model import Task
from irc.problem import Problem
from irc.schedule import Status
from irc_pddl21.search.dates import with_common_deadline

pytestmark = pytest.mark.skipif(
    find_spec("kairos") is None, reason="kairos has wheels for Linux only"
)

SECONDS = 3.0


def drawn(seed: int, objective: str) -> Task:
    """A few jobs on one or two machines, most of them with due dates that are hard to keep."""
    rng = random.Random(seed)
    jobs = [f"j{k}" for k in range(rng.randint(3, 5))]
    actions = [
        {
            "id": job,
            "duration": rng.randint(1, 5),
            "uses": [{"resource": rng.choice(("m1", "m2"))}],
            **(
                {"due": rng.randint(1, 9), "weight": rng.randint(1, 3)}
                if rng.random() < 0.8
                else {}
            ),
        }
        for job in jobs
    ]
    before = [list(pair) for pair in pairwise(jobs) if rng.random() < 0.3]
    return Task.model_validate(
        {
            "resources": [{"id": "m1"}, {"id": "m2"}],
            "actions": actions,
            "precedence": before,
            "objective": [f"minimize_{objective}", "minimize_makespan"],
        }
    )


def lateness(task: Task, schedule: irc.Schedule, objective: str) -> tuple[float, float]:
    """The objective's value, counted from the entries, and the makespan."""
    ends = {entry.id: entry.end for entry in schedule.entries}
    late = [(a.weight, max(0, ends[a.id] - a.due)) for a in task.actions if a.due is not None]
    values = {
        "tardiness": sum(weight * by for weight, by in late),
        "max_tardiness": max((weight * by for weight, by in late), default=0),
        "tardy": sum(weight for weight, by in late if by),
    }
    return float(values[objective]), float(schedule.makespan)


@pytest.mark.slow
@pytest.mark.parametrize("objective", ["tardiness", "max_tardiness", "tardy"])
@pytest.mark.parametrize("seed", range(3))
def test_lateness_is_what_cpsat_proves_or_more(objective: str, seed: int) -> None:
    task = drawn(seed, objective)
    best = irc.solve(task, "cpsat", time_limit=10)
    found = irc.solve(
        task, "pddl21", engine="kairos", time_limit=SECONDS, workers=1, shortcut=False
    )
    assert best.status is Status.OPTIMAL
    assert validate(task, found).valid
    mine, least = (lateness(task, schedule, objective) for schedule in (found, best))
    assert mine == least if found.status is Status.OPTIMAL else mine >= least
    assert objective != "tardiness" or mine[0] == least[0]


def with_chain(*actions: Document) -> Problem:
    """The problem of actions of which the first precedes the second."""
    return after_passes(task_of(*lettered(*actions), precedence=[["a", "b"]]))


def test_ends_with_deadlines_are_a_deadline_of_the_whole() -> None:
    found = with_common_deadline(with_chain({}, {"deadline": 7}, {"deadline": 9}))
    assert found.deadline == 9


@pytest.mark.parametrize("last", [{}, {"occurs": "optional", "deadline": 7}])
def test_an_end_without_a_deadline_leaves_the_whole_without_one(last: Document) -> None:
    assert with_common_deadline(with_chain({}, last, {"deadline": 9})).deadline is None
