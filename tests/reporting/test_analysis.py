"""The analysis of schedules: against a second computation, and what single rows say."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime, timedelta
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any

import pytest

import irc
from builders import act, task_of
from irc.lowering.lower import lower
from irc.model import Task
from irc.reporting.analysis import Analysis, analyse
from irc.reporting.rows import ActionRow
from irc.schedule import Entry, Schedule
from reporting.shops import hours_counted, orders_counted, shop

SHOPS = range(20)


@cache
def _analysed(seed: int) -> tuple[dict[str, Any], list[dict[str, Any]], Analysis]:
    document = shop(seed)
    task = Task.model_validate(document)
    schedule = irc.solve(document, time_limit=5, workers=1)
    assert irc.validate(document, schedule).valid
    return document, schedule.to_dict()["actions"], analyse(task, schedule)


@pytest.mark.parametrize("seed", SHOPS)
def test_orders_are_what_a_second_computation_finds(seed: int) -> None:
    document, entries, analysis = _analysed(seed)
    expected = orders_counted(document, entries)
    assert {row.order for row in analysis.orders} == expected.keys()
    for row in analysis.orders:
        for field, value in expected[row.order].items():
            assert getattr(row, field) == value, (row.order, field)
    tardiness = next(o.value for o in analysis.schedule.objective if o.name == "tardiness")
    assert sum(row.weight * (row.tardiness or 0) for row in analysis.orders) == tardiness


@pytest.mark.parametrize("seed", SHOPS)
def test_resources_are_what_counting_hours_finds(seed: int) -> None:
    document, entries, analysis = _analysed(seed)
    expected = hours_counted(document, entries)
    for row in analysis.resources:
        for field, value in expected[row.resource].items():
            assert getattr(row, field) == value, (row.resource, field)
        assert row.busy + row.setup + row.idle + row.closed == analysis.span


@pytest.mark.parametrize("seed", SHOPS)
def test_days_share_out_what_resources_do(seed: int) -> None:
    _, entries, analysis = _analysed(seed)
    for row in analysis.resources:
        assert sum(day.used[row.resource] for day in analysis.days) == row.used
    assert sum(day.begun for day in analysis.days) == len(entries)
    assert sum(day.ended for day in analysis.days) == len(entries)
    assert [day.end for day in analysis.days[:-1]] == [day.start for day in analysis.days[1:]]
    assert all(b.day.date() - a.day.date() == timedelta(1) for a, b in pairwise(analysis.days))


@pytest.mark.parametrize("seed", SHOPS)
def test_every_action_has_a_reason_and_the_chain_ends_with_the_makespan(seed: int) -> None:
    _, _, analysis = _analysed(seed)
    ends = {row.key: row.end for row in analysis.actions}
    for row in analysis.actions:
        for reason in row.why:
            if reason.kind in ("precedence", "resource", "setup") and reason.after is not None:
                assert ends[reason.after] <= row.start
    assert ends[analysis.critical[-1]] == analysis.span
    assert all(row.critical for row in analysis.actions if row.key in analysis.critical)


def test_the_day_on_which_clocks_change_has_23_hours() -> None:
    task = task_of(
        act("a", 40),
        time_unit="h",
        origin="2026-03-28T20:00:00+01:00",
        calendars=[
            {"id": "c", "time_zone": "Europe/Berlin", "open": [{"from": "0:00", "to": "24:00"}]}
        ],
    )
    days = analyse(task, Schedule((Entry("a", 0, 40),))).days
    assert [(d.start, d.end) for d in days] == [(0, 4), (4, 27), (27, 40)]
    assert [d.day.utcoffset() for d in days] == [timedelta(hours=h) for h in (1, 1, 2)]


def _why(task: Task, *entries: Entry) -> dict[str, list[tuple[str, Any]]]:
    rows = analyse(task, Schedule(entries)).actions
    return {row.action: [(r.kind, r.after and r.after[0]) for r in row.why] for row in rows}


BOOTH = {"uses": [{"resource": "booth"}]}


@pytest.mark.parametrize(
    ("fields", "task_fields", "second", "expected"),
    [
        ({}, {}, (0, 2), [("origin", None)]),
        ({"release": 3}, {}, (3, 5), [("release", None)]),
        ({"start": 3}, {}, (3, 5), [("start", None)]),
        ({"earliest_end": 5}, {}, (3, 5), [("earliest_end", None)]),
        (BOOTH, {}, (2, 4), [("resource", "first")]),
        ({}, {"precedence": [["first", "second"]]}, (2, 4), [("precedence", "first")]),
        (
            {},
            {"precedence": [{"before": "first", "after": "second", "min_lag": 5}]},
            (7, 9),
            [("precedence", "first")],
        ),
        (
            {},
            {
                "precedence": [
                    {"before": "first", "after": "second", "type": "start-finish", "min_lag": 5}
                ]
            },
            (3, 5),
            [("precedence", "first")],
        ),
        ({}, {}, (3, 5), []),
        (
            {"consumes": [{"resource": "dough", "amount": 1}]},
            {},
            (2, 4),
            [("stock", "first")],
        ),
        ({"conditions": [{"at": "start", "var": "hot"}]}, {}, (2, 4), [("state", "first")]),
        ({"conditions": [{"at": "all", "var": "light"}]}, {}, (4, 6), [("world", None)]),
        ({"calendar": "late"}, {}, (6, 8), [("closed", None)]),
        (
            {"calendar": "late"},
            {"precedence": [["first", "second"]]},
            (6, 8),
            [("closed", None), ("precedence", "first")],
        ),
        (
            {"uses": [{"resource": "team", "amount": 2}]},
            {},
            (9, 11),
            [("capacity", None)],
        ),
    ],
)
def test_an_action_starts_when_it_does_for_a_reason(
    fields: dict[str, Any],
    task_fields: dict[str, Any],
    second: tuple[int, int],
    expected: list[tuple[str, Any]],
) -> None:
    task = task_of(
        act(
            "first",
            2,
            **BOOTH,
            produces=[{"resource": "dough"}],
            effects=[{"at": "end", "var": "hot"}],
        ),
        act("second", 2, **fields),
        resources=[
            {"id": "booth"},
            {"id": "team", "capacity": 2, "availability": [{"from": 0, "to": 9, "capacity": 1}]},
            {"id": "dough", "kind": "reservoir"},
        ],
        state=[{"id": "hot"}, {"id": "light", "changes": [{"at": 4, "value": True}]}],
        calendars=[{"id": "late", "every": 10, "open": [{"from": 6, "to": 10}]}],
        **task_fields,
    )
    held = {use["resource"]: use.get("amount", 1) for use in fields.get("uses", ())}
    why = _why(task, Entry("first", 0, 2, {"booth": 1}), Entry("second", *second, held))
    assert why["second"] == expected


def test_a_maximum_lag_and_a_set_up_are_reasons() -> None:
    task = task_of(
        act("a", 2, uses=[{"resource": "booth", "family": "red"}]),
        act("b", 2, uses=[{"resource": "booth", "family": "blue"}]),
        act("c", 1),
        precedence=[{"before": "c", "after": "b", "max_lag": 1}],
        resources=[
            {"id": "booth", "setups": {"times": [{"from": "red", "to": "blue", "time": 3}]}}
        ],
    )
    booth = {"booth": 1}
    why = _why(task, Entry("a", 0, 2, booth), Entry("b", 5, 7, booth), Entry("c", 3, 4))
    assert why == {"a": [("origin", None)], "b": [("setup", "a")], "c": [("max_lag", "b")]}


def test_without_reasons_all_else_is_the_same() -> None:
    orders = [{"id": "o", "actions": ["a", "b"], "due": 2}]
    task = task_of(act("a", 3), act("b", 1), act("c", 1), precedence=[["a", "c"]], groups=orders)
    schedule = Schedule((Entry("a", 0, 3), Entry("b", 0, 1), Entry("c", 3, 4)))
    whole = analyse(task, schedule)
    quick = analyse(task, schedule, lower(task), {"a": 0, "b": 3, "c": 0}, reasons=False)
    assert whole.action(("c", 1)).why
    assert quick.actions == tuple(replace(row, why=()) for row in whole.actions)
    assert (quick.orders, quick.resources) == (whole.orders, whole.resources)
    assert whole.critical == (("a", 1), ("c", 1))
    assert quick.critical == (("c", 1),)


def test_slack_is_known_with_orders_and_not_with_state() -> None:
    orders = [{"id": "o", "actions": ["a", "b"]}]
    plain = task_of(act("a", 3), act("b", 1), groups=orders)
    rows = analyse(plain, Schedule((Entry("a", 0, 3), Entry("b", 0, 1)))).actions
    assert {row.action: (row.slack, row.critical, row.orders) for row in rows} == {
        "a": (0, True, ("o",)),
        "b": (2, False, ("o",)),
    }
    with_state = task_of(
        act("a", 3, effects=[{"at": "end", "var": "x"}]), act("b", 1), state=[{"id": "x"}]
    )
    analysis = analyse(with_state, Schedule((Entry("a", 0, 3), Entry("b", 0, 1))))
    assert not analysis.slack_known
    found: list[ActionRow] = list(analysis.actions)
    assert {row.action: (row.slack, row.critical) for row in found} == {
        "a": (None, True),
        "b": (None, False),
    }


def test_an_order_that_is_not_complete_has_no_end() -> None:
    task = task_of(
        act("a", 3),
        act("b", 1),
        groups=[{"id": "o", "actions": ["a", "b"], "required": False, "due": 2}],
    )
    (row,) = analyse(task, Schedule((Entry("a", 0, 3, status="abandoned"),))).orders
    assert (row.present, row.end, row.lateness, row.due) == (False, None, None, 2)


def test_cancelled_work_ends_no_order_and_changes_nothing_at_its_end() -> None:
    task = task_of(
        act("a", 3, occurs="optional", due=2, produces=[{"resource": "dough"}]),
        resources=[{"id": "dough", "kind": "reservoir", "initial": 1}],
    )
    analysis = analyse(task, Schedule((Entry("a", 0, 1, status="cancelled"),)))
    assert analysis.orders[0].end is None
    assert analysis.stocks[0].levels == ((0, 1),)


def test_levels_follow_ranks_and_exact_amounts() -> None:
    task = task_of(
        act("pour", 1, effects=[{"at": "end", "var": "fuel", "add": "1/3"}]),
        act("empty", 1, effects=[{"at": "start", "var": "fuel", "set": 0}]),
        state=[{"id": "fuel", "kind": "number", "initial": 2}],
    )
    entries = Entry("pour", 0, 1, end_rank=0), Entry("empty", 1, 2, rank=1)
    (fuel,) = analyse(task, Schedule(entries)).states
    assert fuel.values == ((0, 2), (1, 0))
    swapped = Entry("pour", 0, 1, end_rank=1), Entry("empty", 1, 2)
    (fuel,) = analyse(task, Schedule(swapped)).states
    assert fuel.values == ((0, 2), (1, Fraction(1, 3)))


def test_pauses_are_the_closed_times_within() -> None:
    task = task_of(
        act("a", 5, breaks="pause", uses=[{"resource": "booth"}]),
        resources=[{"id": "booth", "calendar": "day"}],
        calendars=[{"id": "day", "every": 10, "open": [{"from": 0, "to": 3}]}],
    )
    (row,) = analyse(task, Schedule((Entry("a", 0, 12, {"booth": 1}, paused=7),))).pauses
    assert row.spans == ((3, 10),)


def test_dates_beyond_the_year_9999_are_left_out() -> None:
    task = task_of(act("a", 10_000), time_unit="year", origin="2026-01-01T00:00:00")
    analysis = analyse(task, Schedule((Entry("a", 0, 10_000),)))
    assert analysis.dates is None
    assert analysis.days == ()


def test_an_empty_schedule_has_an_analysis() -> None:
    task = task_of(act("a", 1, occurs="optional"), origin="2026-01-01T00:00:00Z")
    analysis = analyse(task, Schedule(()))
    assert (analysis.span, analysis.actions, analysis.critical) == (0, (), ())
    assert [day.day for day in analysis.days] == [datetime.fromisoformat("2026-01-01T00:00:00Z")]
