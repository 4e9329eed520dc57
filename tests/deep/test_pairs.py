"""Each element of the vocabulary, and every pair of elements, against trying everything."""

from __future__ import annotations

import json
from collections.abc import Iterator

import pytest

from oracles.combined import document_with, pairs
from oracles.combined_judge import is_fault, smallest, verdict
from oracles.online_pairs import judged_step

PAIRS = pairs()


@pytest.mark.parametrize(("target", "limit"), [("cpsat", 30.0), ("pddl21", 2.0)])
def test_no_answer_is_wrong(seeds: Iterator[int], target: str, limit: float) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
    for seed in seeds:
        pair, shortcut = PAIRS[seed % len(PAIRS)], bool(seed % 2)
        document = document_with(pair, seed)
        said = verdict(document, target, limit, shortcut=shortcut)
        if is_fault(said):
            least = smallest(document, target, limit, shortcut=shortcut)
            pytest.fail(f"{pair} {seed}: {said}\n{json.dumps(least)}")


def test_no_step_of_an_execution_is_wrong(seeds: Iterator[int]) -> None:
    for seed in seeds:
        pair = PAIRS[seed % len(PAIRS)]
        said = judged_step(pair, seed)
        assert not is_fault(said), f"{pair} {seed}: {said}"
