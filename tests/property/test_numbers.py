"""Number variables: the validator and a second, slow one agree on small random schedules."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

import irc
from irc.schedule import Entry, Schedule
from irc.validation import validate
from oracles.state_brute_force import optimum
from oracles.state_generators import number_task
from oracles.state_validity import is_valid


@pytest.mark.slow
def test_the_validator_agrees_on_schedules_of_any_kind() -> None:
    rng = random.Random(7)
    seen = {True: 0, False: 0}
    for seed in range(60):
        task = number_task(seed, "state")
        best = optimum(task) if irc.check(task).ok else None
        if best is None or len(best.schedule.entries) > 3:
            continue
        for _ in range(3):
            entries = tuple(_moved(entry, rng) for entry in best.schedule.entries)
            valid = is_valid(task, Schedule(entries))
            seen[valid] += 1
            assert validate(task, Schedule(entries)).valid is valid, (seed, entries)
    assert min(seen.values()) > 10, seen


def _moved(entry: Entry, rng: random.Random) -> Entry:
    start = entry.start if rng.random() < 0.5 else rng.randint(0, 5)
    return replace(entry, start=start, end=start + entry.end - entry.start, rank=0, end_rank=None)
