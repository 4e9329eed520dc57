"""Timed changes of state: `cpsat`, the validator and trying everything agree on small tasks."""

from __future__ import annotations

import random

import pytest

import irc
from irc.schedule import Entry, Schedule, Status
from oracles.timed_changes import best_makespan, holds, random_task

HORIZON = 7
"""Later than any of these tasks can need: the last change, and all actions in turn."""


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_the_optimum_is_that_of_trying_everything(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(8):
        document = random_task(rng)
        task = irc.Task(**document).ir
        wanted = best_makespan(document, HORIZON)
        if not irc.check(task).ok:
            assert wanted is None, document
            continue
        schedule = irc.solve(task, "cpsat", time_limit=20)
        if wanted is None:
            assert schedule.status is Status.INFEASIBLE or schedule.makespan > HORIZON, document
            continue
        assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, wanted), document
        placing = {e.id: (int(e.start), e.rank) for e in schedule.entries}
        assert holds(document, placing), document


@pytest.mark.slow
def test_the_validator_agrees_on_any_schedule_with_ranks() -> None:
    rng = random.Random(5)
    seen = {True: 0, False: 0}
    for _ in range(150):
        document = random_task(rng)
        task = irc.Task(**document).ir
        placing = {
            action["id"]: (rng.randint(0, 4), rng.randint(0, 2)) for action in document["actions"]
        }
        if not any(rank for _, rank in placing.values()):
            continue  # Without ranks the validator looks for some.
        length = {action["id"]: action["duration"] for action in document["actions"]}
        entries = [
            Entry(name, time, time + length[name], rank=rank)
            for name, (time, rank) in placing.items()
        ]
        valid = irc.validate(task, Schedule(tuple(entries))).valid
        seen[valid] += 1
        assert valid is holds(document, placing), (document, placing)
    assert min(seen.values()) > 5, seen
