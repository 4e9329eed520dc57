"""Tasks with one element of the vocabulary, on both targets, against trying everything."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from element_laws import judge_exact, judge_planner
from oracles.elements import KINDS, TooHardError


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
@pytest.mark.parametrize("kind", KINDS)
def test_every_road_says_the_same(seeds: Iterator[int], kind: str, target: str) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
    for seed in seeds:
        try:
            task, best = KINDS[kind](seed)
        except TooHardError:
            continue
        if target == "cpsat":
            judge_exact(task, best)
        else:
            judge_planner(task, best)
