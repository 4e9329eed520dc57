"""What the checks call impossible is impossible: an exact search finds no schedule either."""

from __future__ import annotations

import pytest

from laws import has_schedule, told_of

TASKS, BATCHES = 480, 6


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(BATCHES))
def test_no_task_with_a_schedule_is_called_impossible(batch: int) -> None:
    called = [seed for seed in range(batch, TASKS, BATCHES) if told_of(seed)]
    assert len(called) > TASKS // BATCHES // 10
    assert [seed for seed in called if has_schedule(seed)] == []


@pytest.mark.slow
def test_each_check_finds_something_among_the_random_tasks() -> None:
    """(The generator draws no occurrences of at most 0.)"""
    told = set().union(*(told_of(seed) for seed in range(200)))
    assert told >= {"IRC306", "IRC307", "IRC308"}
