"""Random tasks with calendars and pauses, for as long as is wanted."""

from __future__ import annotations

from collections.abc import Iterator

from conformance.test_pauses import agrees
from oracles.pause_generators import pausing_task


def test_the_answer_is_the_best(seeds: Iterator[int]) -> None:
    for seed in seeds:
        agrees(pausing_task(seed))
