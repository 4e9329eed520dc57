"""The resolution of a task: what is rounded, how, and when it is derived."""

from __future__ import annotations

import json
import pickle
from fractions import Fraction
from math import floor
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from irc.errors import IrcError
from irc.model import Task
from irc.model.canonical import task_sha256, written_task
from irc.model.resolution import in_words, pinned, running_resolution, times_of, with_times
from irc.model.times import rounded


def task(*durations: Any, **more: Any) -> Task:
    actions = [{"id": f"a{k}", "duration": d} for k, d in enumerate(durations)]
    return Task.model_validate({"actions": actions, **more})


numbers = st.fractions(min_value=-50, max_value=50, max_denominator=10**6)
resolutions = st.fractions(min_value=Fraction(1, 1000), max_value=20, max_denominator=1000)


@pytest.mark.slow
@given(numbers, resolutions)
def test_a_time_is_read_as_the_nearest_multiple_and_a_half_goes_up(
    value: Fraction, resolution: Fraction
) -> None:
    near = rounded(value, resolution)
    assert near == resolution * floor(value / resolution + Fraction(1, 2))
    assert (Fraction(near) / resolution).denominator == 1
    assert abs(near - value) <= resolution / 2
    assert type(near) is int or Fraction(near).denominator > 1


@given(numbers, numbers, resolutions)
def test_rounding_keeps_the_order(a: Fraction, b: Fraction, resolution: Fraction) -> None:
    if a <= b:
        assert rounded(a, resolution) <= rounded(b, resolution)


def test_whole_numbers_are_rounded_too_where_the_resolution_is_coarser() -> None:
    coarse = task(90, resolution="1 min")
    assert coarse.number(90) == 120
    assert coarse.number(89) == 60
    assert task(90, resolution="7 s").number(90) == 91


@pytest.mark.parametrize("written", [0, -1, "0 s", "-1 ms"])
def test_a_resolution_is_more_than_nothing(written: Any) -> None:
    with pytest.raises((IrcError, ValueError), match="more than 0"):
        task(1, resolution=written)


@pytest.mark.parametrize(
    ("durations", "derived"),
    [
        ((1, 2), None),
        (("1/3", "1/7"), None),
        ((0.1, 0.25), None),
        ((0.000000001,), None),
        ((0.1 + 0.2,), Fraction(1, 10_000)),
        ((5, 1 / 3), Fraction(1, 10_000)),
        ((0.33333333333333331, 7), Fraction(1, 10_000)),
        (("0.33333333333333331 min",), Fraction(1, 1000)),
        (("1234567.3000000001",), Fraction(1, 1000)),
        ((0.0001 * 3,), Fraction(1, 10**7)),
    ],
)
def test_a_resolution_is_derived_where_a_time_has_more_digits_than_a_clock(
    durations: tuple[Any, ...], derived: Fraction | None
) -> None:
    assert task(*durations).clock.resolution == derived


def test_an_exact_time_of_a_large_or_small_unit_is_not_raw() -> None:
    assert task("86.492 ms", "16/17", time_unit="month").clock.resolution is None
    assert task(Fraction(86_492, 432 * 10**9), time_unit="month").clock.resolution is None
    assert task(1.2345, 0.00025, time_unit="us").clock.resolution is None
    assert task(0.1 + 0.2, time_unit="us").clock.resolution is not None
    assert task(1 / 3, time_unit="month").clock.resolution is not None


def test_a_raw_time_anywhere_in_the_task_counts() -> None:
    raw = 0.1 + 0.2
    windows = [{"from": raw, "to": 4, "capacity": 0}]
    lag = {"before": "a0", "after": "a1", "min_lag": raw}
    for more in (
        {"deadline": raw},
        {"resources": [{"id": "r", "availability": windows}]},
        {"precedence": [lag]},
        {"groups": [{"id": "g", "actions": ["a0"], "due": raw}]},
    ):
        assert task(1, 2, **more).clock.resolution == Fraction(1, 1000)
    later = [{"at": raw, "changes": []}]
    assert task(1, 2, events=later).clock.resolution is None


def test_a_thousandth_of_the_smallest_duration_is_kept_apart() -> None:
    def running(*durations: Any, **more: Any) -> Any:
        made = task(*durations, **more)
        return running_resolution(made, made.clock) * made.clock.unit

    assert running(5, 2) == Fraction(1, 1000)
    assert running(5, 0) == Fraction(1, 1000)
    assert running(5, 0.5) == Fraction(1, 10_000)
    assert running(5, {"min": 0, "max": 0.02}) == Fraction(1, 100_000)
    assert running(5, 2, time_unit="us") == Fraction(1, 10**9)
    assert running(5, 2, time_unit="day") == Fraction(1, 1000)
    assert running(5, 2, resolution="1 min") == 60


@pytest.mark.parametrize(
    ("unit", "resolution", "text"),
    [
        ("s", "1 ms", "1 ms"),
        ("min", 1, "60 s"),
        ("h", "0.1 ms", "100 us"),
        ("s", 1e-9, "0.000000001 s"),
    ],
)
def test_a_resolution_is_shown_in_a_unit_of_its_size(unit: str, resolution: Any, text: str) -> None:
    made = task(100, time_unit=unit, resolution=resolution)
    assert made.clock.resolution is not None
    assert in_words(made.clock.resolution, made.clock) == text


def test_a_derived_resolution_stays_when_the_task_changes() -> None:
    raw = task(0.1 + 0.2, 1)
    fixed = pinned(raw)
    assert fixed.resolution == raw.clock.resolution
    longer = fixed.model_copy(update={"actions": fixed.actions[1:]})
    assert longer.clock.resolution == raw.clock.resolution
    exact = task(1, 2)
    assert pinned(exact) is exact


def test_a_copy_of_a_task_has_a_clock_of_its_own() -> None:
    raw = task(0.1 + 0.2, 1)
    assert raw.clock.resolution is not None
    assert raw.model_copy(update={"actions": raw.actions[1:]}).clock.resolution is None
    assert pickle.loads(pickle.dumps(raw)).clock == raw.clock


def test_the_document_keeps_what_was_written_and_equal_meanings_have_one_hash() -> None:
    raw = task(0.1 + 0.2, resolution="1 ms")
    assert written_task(raw)["actions"][0]["duration"] == 0.1 + 0.2
    assert json.loads(raw.model_dump_json())["resolution"] == "1 ms"
    assert task_sha256(raw) == task_sha256(task(0.3, resolution=0.001))


def test_every_time_of_a_part_is_found_and_can_be_changed() -> None:
    made = task(
        {"min": 1, "max": "3 s"},
        2,
        deadline=9,
        resources=[{"id": "r", "availability": [{"from": 4, "to": 5, "capacity": 0}]}],
        events=[{"at": 3, "changes": [{"op": "set_capacity", "resource": "r", "capacity": 7}]}],
    )
    found = {"/".join(map(str, place)) for place, _ in times_of(made)}
    assert found == {
        "deadline",
        "actions/0/duration/min",
        "actions/0/duration/max",
        "actions/1/duration",
        "resources/0/availability/0/from",
        "resources/0/availability/0/to",
        "events/0/at",
    }
    doubled = with_times(made, lambda value, _: made.clock.exact(value) * 2)
    assert doubled.deadline == 18
    assert doubled.resources[0].availability[0].capacity == 0
    assert doubled.actions[0].duration.max == 6
    assert with_times(made, lambda value, _: value) is made
