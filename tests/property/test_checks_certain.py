"""What the checks call impossible is impossible: an exact search finds no schedule either."""

from __future__ import annotations

import pytest

import irc
from oracles.state_brute_force import TooLargeError, optimum
from oracles.state_generators import MIXES, state_task

TASKS, BATCHES = 1600, 8
CODES = {"IRC306", "IRC307", "IRC308"}
"""(The generator draws no occurrences of at most 0.)"""


def told_of(seed: int) -> set[str]:
    """The codes of all errors about a random task."""
    return {d.code.id for d in irc.check(state_task(seed)).errors}


def has_schedule(seed: int) -> bool:
    """Whether there is a valid schedule, or the search is too large to say there is none."""
    try:
        return optimum(state_task(seed), max_situations=200_000) is not None
    except TooLargeError:
        pytest.fail(f"task {seed} is called impossible and too large to search")


@pytest.mark.parametrize("batch", range(BATCHES))
def test_no_task_with_a_schedule_is_called_impossible(batch: int) -> None:
    wrong = [
        seed
        for seed in range(batch, TASKS, BATCHES)
        if (codes := told_of(seed))
        and (not codes <= {c for c in codes if c > "IRC3"} or has_schedule(seed))
    ]
    assert wrong == []


def test_each_check_finds_something_among_the_random_tasks() -> None:
    told = set().union(*(told_of(seed) for seed in range(TASKS)))
    assert told >= CODES
    assert len(MIXES) < TASKS
