"""Re-timing with calendars and pauses: nothing can move earlier by itself, in the same order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import pytest

import irc
from irc.driver.solve import solve_task
from irc.lowering.lower import lower
from irc.model import Task
from irc.problem.decisions import Decision
from irc.retiming.retime import retime
from irc.schedule import Entry, Schedule
from irc.targets import SolveOptions
from irc.validation import validate
from oracles.pause_generators import pausing_task


def _earlier(task: Task, entry: Entry, others: Sequence[Entry]) -> Iterator[Schedule]:
    """The schedules in which an entry, that works as long as before, starts earlier."""
    worked = entry.end - entry.start - entry.paused
    before = [o.end for o in others if set(o.resources) & set(entry.resources)]
    first = max((int(end) for end in before if end <= entry.start), default=0)
    for start in range(first, int(entry.start)):
        for end in range(start + int(worked), int(entry.end) + 1):
            paused = end - start - worked
            moved = replace(entry, start=start, end=end, paused=paused)
            yield Schedule((*others, moved), task=task.name)


def _stays(task: Task, entry: Entry) -> bool:
    """Whether an entry keeps its open time: by a limit of its pause, or a resource's calendar."""
    action = next(a for a in task.actions if a.id == entry.id)
    windowed = {r.id for r in task.resources if r.availability or r.calendar is not None}
    return action.max_pause is not None or bool(windowed & set(entry.resources))


@pytest.mark.parametrize("seed", [*range(16), 108])
def test_no_entry_can_move_earlier(seed: int) -> None:
    task = pausing_task(seed)
    schedule = solve_task(task, SolveOptions(target="cpsat", time_limit=30, workers=1)).schedule
    for k, entry in enumerate(schedule.entries):
        others = [*schedule.entries[:k], *schedule.entries[k + 1 :]]
        if not _stays(task, entry):
            for moved in _earlier(task, entry, others):
                assert not validate(task, moved).valid, (entry, moved.entries[-1])


DAYS = {"id": "c", "every": 24, "open": [{"from": 0, "to": 8}]}


@pytest.mark.parametrize(
    ("fields", "place", "expected"),
    [
        ({"duration": 4, "breaks": "pause"}, (24, 28), (0, 4)),
        ({"duration": 12, "breaks": "pause", "release": 6}, (48, 76), (6, 50)),
        ({"duration": 4, "breaks": "pause", "release": 6}, (48, 52), (6, 26)),
        ({"duration": 4, "breaks": "pause", "release": 9}, (48, 52), (24, 28)),
        ({"duration": 4, "release": 6}, (48, 52), (24, 28)),
        ({"duration": {"min": 4, "max": 6}, "release": 6}, (48, 52), (24, 28)),
        # Its limit keeps what pauses in its open time.
        ({"duration": 4, "breaks": "pause", "release": 6, "max_pause": 0}, (48, 52), (48, 52)),
    ],
)
def test_an_answer_moves_to_an_earlier_day(
    fields: dict[str, object], place: tuple[int, int], expected: tuple[int, int]
) -> None:
    task = Task.model_validate(
        {"time_unit": "h", "calendars": [DAYS], "actions": [{"id": "a", "calendar": "c", **fields}]}
    )
    problem = lower(task)
    tick = problem.to_units(1)
    (placed,) = retime(problem, [Decision(*(int(time / tick) for time in place))])
    assert (problem.to_units(placed.start), problem.to_units(placed.end)) == expected


def test_stock_beside_a_calendar_has_points_of_its_own() -> None:
    """What is taken at an instant comes behind what is given then, at the first open time."""
    schedule = irc.solve(
        {
            "resources": [{"id": "s", "kind": "reservoir"}],
            "calendars": [{"id": "shift", "every": 2, "open": [{"from": 1, "to": 0}]}],
            "actions": [
                {"id": "take", "duration": 0, "consumes": [{"resource": "s"}]},
                {"id": "give", "duration": 0, "produces": [{"resource": "s"}], "calendar": "shift"},
            ],
        }
    )
    assert (schedule.status, schedule.makespan) == ("optimal", 1)
