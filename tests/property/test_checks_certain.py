"""What the checks call impossible is impossible: an exact search finds no schedule either."""

from __future__ import annotations

import pytest

import irc
from oracles.state_brute_force import TooLargeError, optimum
from oracles.state_generators import state_task

TASKS, BATCHES = 1600, 8


def told_of(seed: int) -> set[str]:
    """The codes of all errors about a random task."""
    return {d.code.id for d in irc.check(state_task(seed)).errors}


def has_schedule(seed: int) -> bool:
    """Whether there is a valid schedule; a search that is too large is no proof of none."""
    try:
        return optimum(state_task(seed), max_situations=200_000) is not None
    except TooLargeError:
        return True


@pytest.mark.parametrize("batch", range(BATCHES))
def test_no_task_with_a_schedule_is_called_impossible(batch: int) -> None:
    called = [seed for seed in range(batch, TASKS, BATCHES) if told_of(seed)]
    assert len(called) > TASKS // BATCHES // 10
    assert [seed for seed in called if has_schedule(seed)] == []


def test_each_check_finds_something_among_the_random_tasks() -> None:
    """(The generator draws no occurrences of at most 0.)"""
    told = set().union(*(told_of(seed) for seed in range(200)))
    assert told >= {"IRC306", "IRC307", "IRC308"}
