"""Robo Challenge through `cpsat`: every instance is proven as good as the benchmark knows."""

from __future__ import annotations

from pathlib import Path

import pytest

import irc
from irc.frontends.importers.robo import import_robo
from irc.schedule import Status
from irc.validation import validate
from paths import SHARED_DATA

FOLDER = SHARED_DATA / "robo_challenge"
INSTANCES = sorted(FOLDER.glob("*.json"))


@pytest.mark.shared_data
def test_every_instance_is_there() -> None:
    assert len(INSTANCES) == 70


@pytest.mark.slow
@pytest.mark.shared_data
@pytest.mark.parametrize("path", INSTANCES, ids=lambda path: path.stem)
def test_cpsat_proves_the_optimum_that_the_benchmark_states(path: Path) -> None:
    ((_, task),) = import_robo(path.read_text("utf-8"), path.name)
    schedule = irc.solve(task, "cpsat", shortcut=False, workers=1, time_limit=60)
    assert schedule.status is Status.OPTIMAL
    assert validate(task, schedule).valid
    worth = {value.name: value for value in schedule.objective}
    assert all(value.bound == value.value for value in schedule.objective)
    if "optimal_reward" in task.metadata:
        assert list(worth) == ["reward", "makespan"]
        assert worth["reward"].value == task.metadata["optimal_reward"]
    else:
        assert schedule.makespan == task.metadata["optimal_makespan"]
