"""Each element of the vocabulary alone, and pairs of them: cpsat against trying everything."""

from __future__ import annotations

import json
from collections import Counter

import pytest

from irc.model import Task
from oracles.combined import combined_document, document_with, pairs
from oracles.combined_judge import is_fault, verdict
from oracles.exhaustive import TooHardError, best_of
from oracles.state_brute_force import TooLargeError, optimum


@pytest.mark.slow
def test_cpsat_answers_as_trying_everything_does() -> None:
    seen: Counter[str] = Counter()
    for k, pair in enumerate(pairs()):
        if k % 48 == 0:
            document = document_with(pair, 1)
            said = verdict(document, "cpsat", 30.0, shortcut=False)
            assert not is_fault(said), f"{pair}: {said}\n{json.dumps(document)}"
            seen[said] += 1
    assert seen["optimal"] >= 6, seen


@pytest.mark.slow
def test_two_oracles_find_the_same_best_values() -> None:
    """One walks through all schedules tick by tick; the other one places and ranks."""
    seen: Counter[str] = Counter()
    for seed in range(50):
        try:
            task = Task.model_validate(combined_document(seed, 2))
            walked, tried = optimum(task, max_situations=20_000), best_of(task, 20_000)
        except (ValueError, LookupError, TooLargeError, TooHardError):
            continue
        assert tried == (walked and walked.vector), seed
        seen["none" if tried is None else "some"] += 1
    assert seen["some"] >= 15, seen
