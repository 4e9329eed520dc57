"""Random tasks with one element of the vocabulary: both targets against trying everything."""

from __future__ import annotations

from collections import Counter

import pytest

from element_laws import judge_exact, judge_planner
from oracles.elements import KINDS, TooHardError

SEEDS = {
    "modes": range(12),
    "numbers": range(16),
    "objectives": range(12),
    "couplings": range(12),
    "selections": range(12),
    "sequences": range(12),
    "batches": range(20),
    "small pairs": range(15),
    "setups": range(12),
    "pauses": range(12),
}
PLANNED = {
    "modes": range(100, 106),
    "numbers": range(100, 112),
    "objectives": range(100, 108),
    "couplings": range(100, 104),
    "selections": range(100, 105),
    "setups": range(100, 104),
    "pauses": range(100, 108),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_cpsat_finds_and_proves_the_best_answer(kind: str) -> None:
    seen: Counter[str] = Counter()
    for seed in SEEDS[kind]:
        try:
            task, best = KINDS[kind](seed)
        except TooHardError:
            continue
        seen[judge_exact(task, best)] += 1
    assert seen["optimal"] >= 5, seen


@pytest.mark.slow
@pytest.mark.parametrize("kind", PLANNED)
def test_pddl21_says_nothing_untrue(kind: str) -> None:
    pytest.importorskip("kairos")
    seen: Counter[str] = Counter()
    for seed in PLANNED[kind]:
        try:
            task, best = KINDS[kind](seed)
        except TooHardError:
            continue
        seen[judge_planner(task, best, seconds=1.0)] += 1
    assert seen["optimal"] + seen["feasible"] >= 1, seen
