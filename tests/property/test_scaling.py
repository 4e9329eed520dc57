"""What changes a makespan by a known factor, and what changes it not at all."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irc
from irc.model import Task
from irc.model.quantities import exact
from irc.model.times import format_number, unit_seconds
from irc.schedule import Status
from oracles.brute_force import longest_path
from oracles.generators import contended_task, hostile_names, random_task

Document = dict[str, Any]

TIMES = frozenset(
    (
        *("duration", "min", "max", "release", "deadline", "start", "latest_start", "earliest_end"),
        *("min_lag", "max_lag"),
    )
)
NO_CONTENTION: dict[str, Any] = {"resources": (0, 0), "tighten": 0.0}

seeds = st.integers(0, 10**6)
factors = st.fractions(Fraction(1, 1000), 1000, max_denominator=1000)


def with_times(task: Task, written: Any) -> Document:
    """The document of a task of whole numbers, with each time replaced by `written(time)`."""

    def walk(raw: Any, key: str = "") -> Any:
        if isinstance(raw, dict):
            return {k: walk(v, k) for k, v in raw.items()}
        if isinstance(raw, list):
            return [walk(item, key) for item in raw]
        return written(raw) if key in TIMES and raw is not None else raw

    document: Document = walk(task.model_dump(mode="json", by_alias=True, exclude_unset=True))
    return document


def times(factor: Fraction) -> Any:
    return lambda time: format_number(exact(time * factor))


def makespan(task: Task | Document, **options: Any) -> Any:
    schedule = irc.solve(task, workers=1, **options)
    assert schedule.status is Status.OPTIMAL
    return schedule.makespan


def contended(seed: int) -> Task:
    rng = random.Random(seed)
    return contended_task(rng, 6) if seed % 2 else random_task(rng, tighten=0.0)


# --- scaling ------------------------------------------------------------------------------------


@pytest.mark.slow
@settings(max_examples=30)
@given(seeds, factors)
def test_scaling_all_times_scales_the_critical_path(seed: int, factor: Fraction) -> None:
    task = random_task(random.Random(seed), **NO_CONTENTION)
    assert makespan(with_times(task, times(factor))) == makespan(task) * factor


@pytest.mark.slow
@settings(max_examples=30)
@given(seeds, factors)
def test_scaling_all_times_scales_the_optimum_of_cp_sat(seed: int, factor: Fraction) -> None:
    task = contended(seed)
    scaled = with_times(task, times(factor))
    assert makespan(scaled, shortcut=False) == makespan(task, shortcut=False) * factor


@pytest.mark.slow
@settings(max_examples=30)
@given(seeds)
def test_scaling_changes_no_file_of_any_target(seed: int) -> None:
    """Targets work in ticks, and only the manifest knows how long one is."""
    task = contended(seed)
    scaled = with_times(task, times(Fraction(7, 3)))
    for target in ("cpsat", "pddl21"):
        assert irc.compile(scaled, target).files == irc.compile(task, target).files


@pytest.mark.parametrize("factor", [Fraction(1, 10**12), Fraction(10**30), Fraction(1, 3)])
def test_times_of_any_size_are_exact(factor: Fraction) -> None:
    task = contended_task(random.Random("sizes"), 8)
    assert makespan(with_times(task, times(factor))) == makespan(task) * factor


# --- units --------------------------------------------------------------------------------------

UNITS = ["ms", "s", "min", "h", "day", "week", "month", "year"]


@pytest.mark.slow
@settings(max_examples=30)
@given(seeds, st.sampled_from(UNITS), st.sampled_from(UNITS))
def test_the_unit_of_the_task_changes_numbers_not_times(seed: int, one: str, other: str) -> None:
    """Texts with units mean the same in tasks of any unit; the answer is in the task's own."""
    task = random_task(random.Random(seed), **NO_CONTENTION)
    document = with_times(task, lambda time: f"{time} {one}")
    first = makespan({**document, "time_unit": one})
    second = makespan({**document, "time_unit": other})
    assert first * unit_seconds(one) == second * unit_seconds(other)
    assert first == makespan(task)


@pytest.mark.slow
@settings(max_examples=20)
@given(seeds)
def test_numbers_and_texts_can_be_mixed(seed: int) -> None:
    task = contended(seed)
    rng = random.Random(seed)
    ways = (
        lambda time: time * 60,
        lambda time: f"{time} min",
        lambda time: f"{time * 60} s",
        lambda time: f"{time * 60_000} ms",
        lambda time: f"{time * 180}/3",
        lambda time: f"PT{time}M" if time >= 0 else f"{time} min",
    )
    mixed = with_times(task, lambda time: rng.choice(ways)(time))
    assert makespan(mixed) == 60 * makespan(task)


@pytest.mark.slow
@settings(max_examples=30)
@given(seeds, st.integers(1, 31))
def test_months_are_as_long_as_the_task_says(seed: int, days: int) -> None:
    task = random_task(random.Random(seed), **NO_CONTENTION)
    document = with_times(task, lambda time: f"{time} months")
    longer = {**document, "time_unit": "day", "days_per_month": days}
    assert makespan(longer) == days * makespan(task)


# --- names and order ----------------------------------------------------------------------------


@pytest.mark.slow
@settings(max_examples=30)
@given(seeds)
def test_other_names_change_no_makespan(seed: int) -> None:
    task = contended(seed)
    assert makespan(hostile_names(task, random.Random(seed))) == makespan(task)


@pytest.mark.slow
@settings(max_examples=30)
@given(seeds)
def test_more_capacity_makes_nothing_later(seed: int) -> None:
    task = contended(seed)
    document = task.model_dump(mode="json", by_alias=True, exclude_unset=True)
    for resource in document["resources"]:
        resource["capacity"] = resource.get("capacity", 1) + 1
    assert makespan(document) <= makespan(task)


@pytest.mark.slow
@settings(max_examples=30)
@given(seeds)
def test_without_resources_a_makespan_is_a_longest_path(seed: int) -> None:
    off = dict.fromkeys(
        ("types", "max_lags", "ranges", "windows", "fixed_starts", "task_deadline"), False
    )
    task = random_task(random.Random(seed), **NO_CONTENTION, **off)
    assert makespan(task) == longest_path(task)


@pytest.mark.slow
@settings(max_examples=20)
@given(seeds)
def test_another_precedence_makes_nothing_earlier(seed: int) -> None:
    task = contended_task(random.Random(seed), 6)
    document = task.model_dump(mode="json", by_alias=True, exclude_unset=True)
    first, *_, last = [action["id"] for action in document["actions"]]
    document["precedence"] = [*document["precedence"], {"before": first, "after": last}]
    assert makespan(document) >= makespan(task)
