"""Random tasks with calendars and pauses: the answer is the best one, and every answer is valid."""

from __future__ import annotations

import pytest

from irc.driver.solve import solve_task
from irc.model import Task
from irc.schedule import Status
from irc.targets import SolveOptions
from irc.validation import validate
from oracles.pause_generators import pausing_task
from oracles.pauses import optimum

HORIZON = 24


def agrees(task: Task) -> None:
    """Compares the answer of cpsat with the brute force."""
    schedule = solve_task(task, SolveOptions(target="cpsat", time_limit=30, workers=1)).schedule
    best = optimum(task, HORIZON)
    if best is None:
        assert schedule.status is Status.INFEASIBLE or schedule.makespan > HORIZON
        return
    assert validate(task, best.schedule).valid
    assert schedule.status is Status.OPTIMAL
    values = tuple(o.value for o in schedule.objective)
    assert values == best.values or (values < best.values and schedule.makespan > HORIZON)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(12), 125, 136, 251, 262])
def test_the_answer_is_the_best(seed: int) -> None:
    agrees(pausing_task(seed))


def paint(**fields: object) -> Task:
    return Task.model_validate(
        {
            "time_unit": "h",
            "calendars": [{"id": "shift", "every": "1 day", "open": [{"from": 6, "to": 14}]}],
            "resources": [{"id": "booth", "calendar": "shift"}],
            "actions": [{"id": "paint", "uses": [{"resource": "booth"}], **fields}],
        }
    )


@pytest.mark.parametrize(
    ("fields", "end", "paused"),
    [
        ({"duration": 8}, 14, 0),
        ({"duration": 8, "breaks": "pause"}, 14, 0),
        ({"duration": 9, "breaks": "pause"}, 31, 16),
        ({"duration": 17, "breaks": "pause"}, 55, 32),
        ({"duration": 9, "breaks": "pause", "release": 13}, 38, 16),
        ({"duration": {"min": 9, "max": 20}, "breaks": "pause", "release": 14}, 55, 16),
    ],
)
def test_the_end_of_work_that_pauses(fields: dict[str, object], end: int, paused: int) -> None:
    schedule = solve_task(paint(**fields), SolveOptions(target="cpsat")).schedule
    (entry,) = schedule.entries
    assert (schedule.status, entry.end, entry.paused) == (Status.OPTIMAL, end, paused)


def test_a_lunch_break_may_lie_within() -> None:
    task = Task.model_validate(
        {
            "resources": [
                {"id": "mechanic", "availability": [{"from": 4, "to": 5, "capacity": 0}]}
            ],
            "actions": [
                {
                    "id": "overhaul",
                    "duration": 5,
                    "uses": [{"resource": "mechanic"}],
                    "breaks": "pause",
                }
            ],
        }
    )
    assert solve_task(task, SolveOptions(target="cpsat")).schedule.makespan == 6


def test_what_pauses_keeps_its_resources() -> None:
    paint = {
        "id": "paint",
        "duration": 10,
        "uses": [{"resource": "booth"}, {"resource": "gun"}],
        "breaks": "pause",
    }
    task = Task.model_validate(
        {
            "time_unit": "h",
            "calendars": [{"id": "shift", "every": "1 day", "open": [{"from": 6, "to": 14}]}],
            "resources": [{"id": "booth", "calendar": "shift"}, {"id": "gun"}],
            "actions": [paint, {"id": "spray", "duration": 7, "uses": [{"resource": "gun"}]}],
        }
    )
    schedule = solve_task(task, SolveOptions(target="cpsat")).schedule
    assert schedule.makespan == 33  # spray from 0 to 7, paint from 7 to 14 and 30 to 33
