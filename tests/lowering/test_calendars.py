"""Calendars are expanded to open times: over midnight, over changes of clocks, without end."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from irc.lowering.calendar_horizon import CalendarTimes
from irc.lowering.lower import lower
from irc.model import Task


def task_of(calendar: dict[str, Any], duration: Any = 1, **fields: Any) -> Task:
    return Task.model_validate(
        {
            "time_unit": "h",
            "calendars": [{"id": "c", **calendar}],
            "resources": [{"id": "r", "calendar": "c"}],
            "actions": [{"id": "a", "duration": duration, "uses": [{"resource": "r"}]}],
            **fields,
        }
    )


def opened(task: Task, until: int) -> list[tuple[Any, Any]]:
    times = CalendarTimes(task, task.clock).of(frozenset(["c"])).until(2 * until)
    return [(start, end) for start, end in times if start < until]


def test_a_cycle_repeats_from_the_beginning() -> None:
    calendar = {"every": "1 day", "open": [{"from": 6, "to": 14}]}
    assert opened(task_of(calendar), 72) == [(6, 14), (30, 38), (54, 62)]


def test_an_open_time_runs_over_the_end_of_its_cycle() -> None:
    calendar = {"every": "1 day", "open": [{"from": 22, "to": 6}]}
    assert opened(task_of(calendar), 50) == [(0, 6), (22, 30), (46, 54)]


def test_open_times_that_touch_are_one_and_closed_ones_cut_them() -> None:
    calendar = {
        "every": "1 day",
        "open": [{"from": 6, "to": 14}, {"from": 14, "to": 20}],
        "closed": [{"from": 8, "to": 9}],
    }
    assert opened(task_of(calendar), 40) == [(6, 8), (9, 20), (30, 44)]


@pytest.mark.parametrize(
    ("origin", "length"),
    [
        ("2026-10-24T12:00:00+02:00", 9),
        ("2026-03-28T12:00:00+01:00", 7),
        ("2026-06-28T12:00:00+02:00", 8),
    ],
)
def test_a_night_over_a_change_of_clocks_is_longer_or_shorter(origin: str, length: int) -> None:
    calendar = {"time_zone": "Europe/Berlin", "open": [{"from": "22:00", "to": "06:00"}]}
    assert opened(task_of(calendar, origin=origin), 24)[0] == (10, 10 + length)


def test_times_are_exact_in_any_unit_and_to_the_second() -> None:
    calendar = {"time_zone": "Europe/Berlin", "open": [{"from": "06:00:01", "to": "06:00:03"}]}
    task = task_of(calendar, "1 s", origin="2026-10-24T06:00:00+02:00")
    found = opened(task, 50)
    day = 25  # The clock is put back in the first night.
    assert found[0] == (Fraction(1, 3600), Fraction(3, 3600))
    assert found[1] == (day + Fraction(1, 3600), day + Fraction(3, 3600))
    assert lower(task).tick == Fraction(1, 3600)


def test_a_time_that_clocks_leave_out_or_show_twice() -> None:
    spring = {"time_zone": "Europe/Berlin", "open": [{"from": "02:30", "to": "05:00"}]}
    task = task_of(spring, origin="2026-03-29T00:00:00+01:00")
    assert opened(task, 20)[0] == (Fraction(5, 2), 4)
    autumn = {"time_zone": "Europe/Berlin", "open": [{"from": "02:30", "to": "05:00"}]}
    task = task_of(autumn, origin="2026-10-25T00:00:00+02:00")
    assert opened(task, 20)[0] == (Fraction(5, 2), 6)


def test_an_origin_without_a_zone_is_read_in_that_of_the_calendars() -> None:
    calendar = {"time_zone": "Europe/Berlin", "open": [{"from": "06:00", "to": "07:00"}]}
    task = task_of(calendar, origin="2026-10-24T06:00:00", deadline="2026-10-26T06:00:00")
    assert opened(task, 26)[:2] == [(0, 1), (25, 26)]
    assert task.number(task.deadline) == 49


def test_days_of_the_week_and_holidays() -> None:
    calendar = {
        "open": [{"days": ["Thursday", "fri"], "from": "08:00", "to": "12:00"}],
        "closed": ["2026-12-25", {"from": "2026-12-31", "to": "2027-01-01T09:00"}],
    }
    task = task_of(calendar, origin="2026-12-24T00:00:00+01:00")
    assert opened(task, 24 * 10) == [(8, 12), (24 * 8 + 9, 24 * 8 + 12)]


def test_an_open_time_that_comes_once_a_year_is_found() -> None:
    calendar = {"time_zone": "Europe/Berlin", "open": [{"from": "22:00", "to": "06:00"}]}
    problem = lower(task_of(calendar, 9, origin="2026-01-05T00:00:00+01:00"))
    lengths = {w.end - w.start for w in problem.resources[0].windows}
    assert 9 in lengths


def test_windows_override_the_calendar() -> None:
    calendar = {"every": "1 day", "open": [{"from": 6, "to": 14}]}
    task = task_of(calendar)
    resource = {"id": "r", "calendar": "c", "capacity": 2}
    resource["availability"] = [{"from": 0, "to": 7, "capacity": 1}]
    task = Task.model_validate(
        {**task.model_dump(by_alias=True, exclude_unset=True), "resources": [resource]}
    )
    windows = lower(task).resources[0].windows
    assert [tuple(w) for w in windows[:3]] == [(0, 7, 1), (7, 14, 2), (30, 38, 2)]


def test_many_actions_over_many_weeks_are_expanded_fast_and_far_enough() -> None:
    document = task_of(
        {
            "time_zone": "Europe/Berlin",
            "open": [{"days": ["mon", "tue", "wed", "thu", "fri"], "from": "06:00", "to": "14:00"}],
        },
        origin="2026-09-01T06:00:00+02:00",
    ).model_dump(by_alias=True, exclude_unset=True)
    document["actions"] = [
        {"id": f"a{k}", "duration": 6, "uses": [{"resource": "r"}]} for k in range(200)
    ]
    problem = lower(Task.model_validate(document))
    assert 200 <= len(problem.resources[0].windows) <= 400
