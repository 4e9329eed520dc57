"""Random executions: every repair is valid, and as good as the exact continuation."""

from __future__ import annotations

import pytest

from laws import faults_of_repairs
from oracles.online_random import EACH

SEEDS = range(1000, 1003)


@pytest.mark.slow
@pytest.mark.parametrize("operation", EACH)
def test_after_an_event_the_rest_is_repaired_as_well_as_can_be(operation: str) -> None:
    assert {seed: told for seed in SEEDS if (told := faults_of_repairs(seed, operation))} == {}


@pytest.mark.slow
def test_after_several_events_of_any_kind_it_is_still() -> None:
    assert {
        seed: told for seed in range(1000, 1006) if (told := faults_of_repairs(seed, None))
    } == {}
