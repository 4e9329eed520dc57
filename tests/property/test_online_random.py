"""Random executions: every repair is valid, and as good as the exact continuation."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from irc.execution import replan
from irc.execution.step import Step
from irc.model import Event, Task
from irc.model.times import Number
from irc.schedule import Schedule
from oracles.online_judge import judge_step
from oracles.online_random import OPERATIONS, play

SEEDS = range(1000, 1006)


def repaired(task: Task, schedule: Schedule, at: Number, events: Sequence[Event]) -> Step:
    return replan(task, schedule, at, events, time_limit=20, workers=1)


def faults(seed: int, operation: str | None) -> list[str]:
    found: list[str] = []
    over: frozenset[str] = frozenset()
    for one in play(seed, operation, repaired):
        judged = judge_step(
            one.task, one.schedule, one.step, one.events, over, max_situations=20_000
        )
        over = judged.over
        found += judged.faults
    return found


@pytest.mark.parametrize("operation", OPERATIONS)
def test_after_an_event_the_rest_is_repaired_as_well_as_can_be(operation: str) -> None:
    assert {seed: told for seed in SEEDS if (told := faults(seed, operation))} == {}


def test_after_several_events_of_any_kind_it_is_still() -> None:
    assert {seed: told for seed in range(1000, 1012) if (told := faults(seed, None))} == {}
