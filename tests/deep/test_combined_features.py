"""Tasks that combine two or three features, on both targets, against exact optima.

A fault is shown as the smallest document that still has it; it becomes a case of
`tests/conformance/test_edges.py`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

import pytest

from oracles.combined import combined_document, features_of
from oracles.combined_judge import is_fault, smallest, verdict


@pytest.mark.parametrize(("target", "limit"), [("cpsat", 30.0), ("pddl21", 4.0)])
@pytest.mark.parametrize("most", [3, 5])
def test_no_answer_is_wrong(seeds: Iterator[int], target: str, limit: float, most: int) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
    for seed in seeds:
        document = combined_document(seed, most)
        said = verdict(document, target, limit)
        if is_fault(said):
            least = smallest(document, target, limit)
            pytest.fail(f"{features_of(seed, most)}: {said}\n{json.dumps(least)}")
