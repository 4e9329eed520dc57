"""Calendars of actions and work that pauses in PDDL2.1 text, and what a planner makes of them."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from builders import Document, lettered, task_of
from irc.diagnostics import InputError
from irc.driver.compile import compile_task
from irc.problem.work_times import FOREVER
from irc.schedule import Schedule
from irc.validation import validate
from irc_pddl21.encoding import work
from irc_pddl21.encoding.encode import encode
from irc_pddl21.encoding.grounded import Grounded
from irc_pddl21.encoding.latest import latest_ends

SHIFT: Document = {"id": "shift", "every": 24, "open": [{"from": 6, "to": 14}]}
BOOTH: Document = {"id": "booth", "calendar": "shift"}


def grounded(*actions: Document, **more: Any) -> Grounded:
    task = task_of(*lettered(*actions), calendars=[SHIFT], **more)
    return encode(compile_task(task, "pddl21").problem)


def planned(*actions: Document, **more: Any) -> Schedule:
    pytest.importorskip("kairos")
    task = task_of(*lettered(*actions), calendars=[SHIFT], **more)
    schedule = irc.solve(task, "pddl21", engine="kairos", time_limit=5, shortcut=False)
    assert validate(task, schedule).valid
    return schedule


def test_there_is_an_operator_for_each_pause() -> None:
    use = {"resource": "booth"}
    paint = {"duration": 10, "breaks": "pause", "release": 13, "uses": [use]}
    found = grounded(paint, resources=[BOOTH], deadline=63)
    assert {o.name: o.duration for o in found.encoding.operators} == {
        "a__booth_1__pause_16": (26 * found.scale,) * 2,
        "a__booth_1__pause_32": (42 * found.scale,) * 2,
    }


def test_open_times_that_no_schedule_reaches_are_left_out() -> None:
    inspect = {"duration": 2, "calendar": "shift"}
    found = grounded(inspect, deadline=40)
    assert max(t.time for t in found.encoding.timed) <= 41 * found.scale


def test_deadlines_and_lags_give_the_latest_ends() -> None:
    task = task_of(
        *lettered({"duration": 2}, {"duration": 5, "deadline": 40}, {"duration": 1}),
        precedence=[{"before": "a", "after": "b", "min_lag": 3}],
    )
    assert latest_ends(compile_task(task, "pddl21").problem) == [32, 40, FOREVER]


@pytest.mark.parametrize(
    ("action", "start", "end"),
    [
        ({"duration": 9, "breaks": "pause"}, 6, 31),
        ({"duration": 8, "breaks": "avoid"}, 6, 14),
        ({"duration": {"min": 9, "max": 20}, "breaks": "pause", "release": 14}, 30, 55),
        ({"duration": 9, "breaks": "pause", "release": 13, "latest_start": 13}, 13, 38),
    ],
)
def test_a_planner_keeps_open_times(action: Document, start: int, end: int) -> None:
    schedule = planned({**action, "uses": [{"resource": "booth"}]}, resources=[BOOTH])
    assert (schedule["a"].start, schedule["a"].end) == (start, end)


def test_a_moment_at_which_the_calendar_closes_is_no_start() -> None:
    schedule = planned({"duration": 0, "calendar": "shift", "release": 14})
    assert schedule["a"].start == 30


def test_what_pauses_keeps_its_unit_and_what_does_not_waits() -> None:
    schedule = planned(
        {"duration": 10, "breaks": "pause", "uses": [{"resource": "booth"}]},
        {"duration": 2, "uses": [{"resource": "booth"}]},
        resources=[BOOTH],
        precedence=[{"before": "a", "after": "b", "type": "start-start"}],
    )
    assert (schedule["a"].end, schedule["b"].start) == (32, 32)


def test_what_may_pause_where_nothing_ever_closes_does_not() -> None:
    task = task_of(*lettered({"duration": 3, "breaks": "pause"}))
    (operator,) = encode(compile_task(task, "pddl21").problem).encoding.operators
    assert operator.duration == (10, 10)
    assert operator.at_start == ["todo_a"]


def test_too_many_pauses_are_refused_at_their_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(work, "MOST_TIMINGS", 1)
    paint = {"duration": 3, "breaks": "pause", "uses": [{"resource": "booth"}]}
    with pytest.raises(InputError) as refused:
        grounded(paint, resources=[BOOTH])
    (error,) = refused.value.report.errors
    assert error.pointer == ("actions", 0, "breaks")
