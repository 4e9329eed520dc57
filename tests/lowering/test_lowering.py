"""Lowering: exact times become the largest whole ticks, and the order of writing is forgotten."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from builders import Document, problem_of
from irc.diagnostics import InputError
from irc.driver.compile import compile_task
from irc.lowering.elements import natural_order
from irc.lowering.lower import lower
from irc.model import Task
from irc.model.quantities import exact
from irc.passes.mandatory import mandatory_part
from irc.problem import Arc, Problem, Requirement
from oracles.brute_force import optimal_makespan
from oracles.generators import big_capacity_task, hostile_names, random_task, tasks

Shuffle = Callable[[Document, random.Random], Document]


def one(duration: Any, **more: Any) -> Document:
    return {"id": "a", "duration": duration, **more}


# --- ticks --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("document", "tick", "ticks"),
    [
        ({"actions": [one(58_000_000)]}, 58_000_000, 1),
        ({"actions": [one(0)]}, 1, 0),
        ({"actions": [one("0.1")]}, Fraction(1, 10), 1),
        ({"actions": [one(0.1)], "deadline": 1}, Fraction(1, 10), 1),
        ({"actions": [one("1/3")], "deadline": "1/2"}, Fraction(1, 6), 2),
        ({"actions": [one("90 min")], "time_unit": "h"}, Fraction(3, 2), 1),
        ({"actions": [one("90 min", release="1 h")], "time_unit": "h"}, Fraction(1, 2), 3),
        ({"actions": [one("1 min")], "time_unit": "day"}, Fraction(1, 1440), 1),
        ({"actions": [one("2 months")], "time_unit": "day"}, 60, 1),
        ({"actions": [one("2 months")], "time_unit": "day", "days_per_month": 31}, 62, 1),
        ({"actions": [one(3)], "time_unit": "month", "deadline": "95 days"}, Fraction(1, 6), 18),
        ({"actions": [one(6, release=4)]}, 2, 3),
        ({"actions": [one(6, deadline=9)]}, 3, 2),
        ({"actions": [one(6, start=4)]}, 2, 3),
        ({"actions": [one({"min": 4, "max": 6})]}, 2, 2),
        ({"actions": [one(6)], "deadline": 16}, 2, 3),
        ({"actions": [one(6), {"id": "b", "duration": 9}]}, 3, 2),
    ],
)
def test_the_tick_is_the_largest_that_divides_every_time(
    document: Document, tick: Any, ticks: int
) -> None:
    problem = problem_of(**document)
    assert problem.tick == tick
    assert problem.activities[0].duration_min == ticks


def test_lags_count_for_the_tick_with_either_sign() -> None:
    both = [one(6), {"id": "b", "duration": 6}]
    edge = {"before": "a", "after": "b"}
    assert problem_of(actions=both, precedence=[{**edge, "min_lag": -4}]).tick == 2
    assert problem_of(actions=both, precedence=[{**edge, "max_lag": 9}]).tick == 3


def test_times_of_what_may_be_absent_count_too() -> None:
    problem = problem_of(actions=[one(6), {"id": "b", "duration": 4, "occurs": "optional"}])
    assert (problem.tick, [a.id for a in problem.activities]) == (2, ["a", "b"])


def test_a_date_time_is_counted_from_the_origin() -> None:
    problem = problem_of(
        origin="2026-03-01T08:00:00+01:00",
        time_unit="h",
        deadline="2026-03-02",
        actions=[one(2, release="2026-03-01T08:30:00Z")],
    )
    assert problem.to_units(problem.activities[0].release) == Fraction(3, 2)
    assert problem.deadline is None  # It names no time zone, though the origin does.


@pytest.mark.parametrize("seed", range(40))
def test_ticks_and_units_say_the_same(seed: int) -> None:
    rng = random.Random(f"ticks {seed}")
    task = random_task(rng)
    factor = Fraction(rng.randint(1, 60), rng.randint(1, 60))
    document = scaled(task, factor)
    plain, other = lower(task), lower(Task.model_validate(document))
    assert other.tick == plain.tick * factor or not any_time(plain)
    assert other.activities == plain.activities
    assert other.arcs == plain.arcs
    assert other.deadline == plain.deadline


def any_time(problem: Problem) -> bool:
    times = [problem.deadline or 0, *(a.duration_max + a.release for a in problem.activities)]
    return any(times) or any(arc.min_lag or arc.max_lag for arc in problem.arcs)


_TIMES = (
    *("duration", "min", "max", "release", "deadline", "start", "latest_start", "earliest_end"),
    *("min_lag", "max_lag"),
)


def scaled(task: Task, factor: Fraction) -> Document:
    """The document with every time multiplied, as a text such as "7/3"."""

    def walk(raw: Any, key: str = "") -> Any:
        if isinstance(raw, dict):
            return {k: walk(v, k) for k, v in raw.items()}
        if isinstance(raw, list):
            return [walk(item, key) for item in raw]
        if key in _TIMES and raw is not None:
            value = Fraction(raw) * factor
            return f"{value.numerator}/{value.denominator}"
        return raw

    document: Document = walk(task.model_dump(mode="json", by_alias=True, exclude_unset=True))
    return document


# --- canonical order ----------------------------------------------------------------------------


def test_everything_is_in_the_order_of_names() -> None:
    problem = problem_of(
        resources=[{"id": "z"}, {"id": "k", "capacity": 3}],
        actions=[
            {"id": "b", "duration": 1},
            {
                "id": "a",
                "duration": 1,
                "uses": [{"resource": "z"}, {"one_of": ["z", "k", "z"], "amount": 2}],
            },
        ],
        precedence=[
            {"before": "b", "after": "a", "min_lag": -1},
            ["b", "a"],
            {"before": "a", "after": "b", "min_lag": -9},
        ],
    )
    assert [a.id for a in problem.activities] == ["a", "b"]
    assert [(r.id, r.capacity) for r in problem.resources] == [("k", 3), ("z", 1)]
    assert problem.activities[0].uses == (Requirement((0, 1), 2, origin=1), Requirement((1,), 1))
    assert problem.arcs == (
        Arc(1, 0, origin=1),
        Arc(0, 1, min_lag=-9, origin=2),
        Arc(1, 0, min_lag=-1, origin=0),
    )


def test_equal_precedences_written_differently_are_one() -> None:
    edge = {"before": "a", "after": "b"}
    problem = problem_of(
        actions=[one(60), {"id": "b", "duration": 60}],
        precedence=[
            edge,
            ["a", "b"],
            {**edge, "min_lag": "0 min"},
            {**edge, "min_lag": 60},
            {**edge, "min_lag": "1 min"},
            {"predecessor": "a", "successor": "b", "lag": "PT60S"},
        ],
    )
    assert problem.arcs == (Arc(0, 1, origin=0), Arc(0, 1, min_lag=1, origin=3))


def test_a_latest_start_is_in_ticks_and_counts_for_the_tick() -> None:
    problem = problem_of(
        actions=[one(60, latest_start="1 min 30 s"), {"id": "b", "duration": 60}],
    )
    assert problem.tick == 30
    assert [a.latest_start for a in problem.activities] == [3, None]


@pytest.mark.parametrize(
    ("kind", "from_end", "to_end"),
    [
        ("finish-start", True, False),
        ("start-start", False, False),
        ("finish-finish", True, True),
        ("start-finish", False, True),
    ],
)
def test_each_precedence_type_binds_its_two_points(kind: str, from_end: bool, to_end: bool) -> None:
    edge = {"before": "a", "after": "b", "type": kind, "min_lag": 1, "max_lag": 2}
    problem = problem_of(actions=[one(1), {"id": "b", "duration": 1}], precedence=[edge])
    assert problem.arcs == (Arc(0, 1, from_end, to_end, 1, 2, 0),)


# --- a relaxation of what it cannot say ---------------------------------------------------------


def test_modes_become_the_range_of_their_durations() -> None:
    modes = [{"id": "slow", "duration": {"min": 6, "max": 8}}, {"id": "fast", "duration": 2}]
    (activity,) = problem_of(actions=[{"id": "a", "modes": modes}]).activities
    assert (activity.duration_min, activity.duration_max, activity.is_fixed) == (1, 4, False)


def test_of_a_calendar_the_greatest_capacity_counts() -> None:
    window = {"from": 1, "to": 2, "capacity": 5}
    problem = problem_of(resources=[{"id": "r", "availability": [window]}], actions=[])
    assert problem.resources[0].windows == ((1, 2, 5),)
    assert (problem.contention.pools[0].capacity, problem.contention.pools[0].least_capacity) == (
        5,
        1,
    )
    assert mandatory_part(problem)[0].resources[0].capacity == 5


def test_the_mandatory_part_leaves_out_what_may_be_absent() -> None:
    whole = problem_of(
        actions=[
            one(1),
            {"id": "b", "duration": 1, "occurs": "optional"},
            {"id": "c", "duration": 1, "occurs": {"min": 1, "max": 1}},
            {"id": "d", "duration": 1, "occurs": {"min": 1, "max": 2}},
            {"id": "e", "duration": 1},
            {"id": "f", "duration": 1},
        ],
        groups=[
            {"id": "order", "actions": ["e"], "required": False},
            {"id": "must", "actions": ["f"]},
        ],
        precedence=[["a", "b"], ["a", "c"], ["e", "f"]],
    )
    problem, _ = mandatory_part(whole)
    assert [a.id for a in problem.activities] == ["a", "c", "d", "f"]
    assert problem.arcs == (Arc(0, 1, origin=1),)
    assert [a.id for a in whole.activities if a.details.optional] == ["b", "e"]
    assert whole.activities[3].details.repeats == (1, 2)


@pytest.mark.slow
@settings(
    max_examples=25,
    phases=[Phase.generate],  # Whole documents take minutes to shrink.
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(tasks())
def test_any_task_can_be_lowered(task: Task) -> None:
    problem = lower(task)
    names = [a.id for a in problem.activities]
    assert names == sorted(set(names), key=natural_order)
    sound = {a.id for a in task.actions if type(a.duration) is int and a.duration >= 0}
    assert sound <= set(names)
    for activity in problem.activities:
        written = task.actions[activity.origin[1]]
        assert written.id == activity.id
        if written.modes or not hasattr(written.duration, "min"):
            continue
        assert problem.to_units(activity.duration_min) == task.number(written.duration.min)
    for arc in problem.arcs:
        edge = task.precedence[arc.origin]
        assert (edge.before, edge.after) == (names[arc.before], names[arc.after])
        assert problem.to_units(arc.min_lag) == task.number(edge.min_lag)


# --- shuffling changes no byte ------------------------------------------------------------------


def programs(document: Document) -> dict[str, Any]:
    """What each target makes of a document: its files and its manifest, or that it is refused."""
    found: dict[str, Any] = {}
    for target in ("cpsat", "pddl21"):
        try:
            program = compile_task(Task.model_validate(document), target)
        except InputError as error:
            found[target] = sorted(d.code.id for d in error.report)
        else:
            found[target] = (dict(program.files), program.manifest_text())
    return found


def documented(task: Task) -> Document:
    document: Document = task.model_dump(mode="json", by_alias=True, exclude_unset=True)
    return document


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_shuffling_arrays_and_keys_changes_no_byte_of_any_target(
    seed: int, shuffled: Shuffle
) -> None:
    rng = random.Random(f"shuffle {seed}")
    task = big_capacity_task(rng) if seed % 8 == 7 else random_task(rng, tighten=0.0)
    document = documented(hostile_names(task, rng) if seed % 2 else task)
    document["metadata"] = {"b": [2, {"d": 1, "c": 0.5}], "a": None}
    expected = programs(document)
    for _ in range(3):
        other = shuffled(document, rng)
        assert programs(other) == expected


@pytest.mark.parametrize("seed", range(10))
def test_another_way_to_write_the_times_changes_no_byte_of_any_target(seed: int) -> None:
    task = random_task(random.Random(f"writing {seed}"), tighten=0.0)
    document = documented(task)
    again = scaled(task, Fraction(1))
    assert again != document
    assert programs(again) == programs(document)


def test_a_repetition_changes_no_byte_of_any_target() -> None:
    rng = random.Random("repetition")
    document = documented(random_task(rng, tighten=0.0, actions=(5, 8)))
    twice = {
        **document,
        **{key: document[key] * 2 for key in ("actions", "resources", "precedence")},
    }
    assert programs(twice) == programs(document)


@pytest.mark.parametrize("seed", range(20))
def test_lowering_keeps_the_optimum_in_units(seed: int) -> None:
    """Through another tick and unit: the brute force reads the task, not the problem."""
    from irc.driver.solve import solve_task

    rng = random.Random(f"optimum {seed}")
    task = random_task(rng, tighten=0.0, actions=(2, 6))
    best = optimal_makespan(task)
    assert best is not None
    factor = Fraction(rng.randint(1, 9), rng.randint(1, 9))
    other = Task.model_validate({**scaled(task, factor), "time_unit": "min"})
    assert solve_task(other).schedule.makespan == exact(best * factor)
