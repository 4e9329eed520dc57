"""Exact time: every way to write one, and what none of them may lose."""

from __future__ import annotations

import json
from datetime import datetime, timedelta, timezone
from decimal import Decimal
from fractions import Fraction
from math import gcd
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from irc.model.quantities import MAX_DIGITS, Quantity, TimeError, exact
from irc.model.times import (
    Clock,
    common_tick,
    format_number,
    json_number,
    parse_instant,
    parse_number,
    parse_span,
    unit_seconds,
)

SECONDS = Clock(Fraction(1))

exact_numbers = st.fractions(max_denominator=10**6).map(exact) | st.integers(-(10**30), 10**30)
decimals = st.decimals(allow_nan=False, allow_infinity=False, places=6, min_value=-(10**9))


# --- reading ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("written", "value"),
    [
        (12, 12),
        ("12", 12),
        (" 12 ", 12),
        ("+7", 7),
        ("-3", -3),
        (0.1, Fraction(1, 10)),
        (2.5, Fraction(5, 2)),
        (60.0, 60),
        (1e-6, Fraction(1, 10**6)),
        (Decimal("0.10"), Fraction(1, 10)),
        (Decimal("1E+3"), 1000),
        ("0.1", Fraction(1, 10)),
        (".5", Fraction(1, 2)),
        ("5.", 5),
        ("2e3", 2000),
        ("25e-1", Fraction(5, 2)),
        ("1/3", Fraction(1, 3)),
        ("-4 / 6", Fraction(-2, 3)),
        ("6/3", 2),
        (Fraction(8, 4), 2),
        ("-0.0", 0),
        (10**MAX_DIGITS - 1, 10**MAX_DIGITS - 1),
        ("0." + "0" * (MAX_DIGITS - 1) + "1", Fraction(1, 10**MAX_DIGITS)),
    ],
)
def test_numbers_are_read_exactly(written: Any, value: Any) -> None:
    read = parse_span(written)
    assert (read, type(read)) == (value, type(value))


@pytest.mark.parametrize(
    ("written", "seconds"),
    [
        ("90 days", 90 * 86_400),
        ("1 h 30 min", 5400),
        ("1h30min", 5400),
        ("1 hour, 30 minutes", 5400),
        ("1 hour and 30 minutes", 5400),
        ("1 hr. 5 min.", 3900),
        ("1 h .5 min", 3630),
        ("1h.5min", 3630),
        ("-1 h 30 min", -5400),
        ("- 2 min", -120),
        ("1.5 H", 5400),
        ("250 ms", Fraction(1, 4)),
        ("1 µs", Fraction(1, 10**6)),
        ("3 us", Fraction(3, 10**6)),
        ("2 weeks", 14 * 86_400),
        ("1 year", 365 * 86_400),
        ("5 m", 300),
        ("PT1H30M", 5400),
        ("pt1h30m", 5400),
        ("P1DT0.5S", Fraction(172_801, 2)),
        ("PT1,5S", Fraction(3, 2)),
        ("P2W", 14 * 86_400),
        ("P1Y", 365 * 86_400),
    ],
)
def test_texts_with_units_are_exact_seconds(written: str, seconds: Any) -> None:
    assert SECONDS.number(parse_span(written)) == seconds


@pytest.mark.parametrize("written", ["2 months", "2 mo", "P2M", "1 month 1 month"])
@pytest.mark.parametrize("days", [28, 30])
def test_a_month_has_the_days_that_the_task_says(written: str, days: int) -> None:
    clock = Clock(unit_seconds("day"), days)
    assert clock.number(parse_span(written)) == 2 * days


def test_m_is_a_minute_in_time_and_a_month_in_a_date() -> None:
    both = parse_span("P1MT1M")
    assert isinstance(both, Quantity)
    assert (both.seconds, both.months) == (60, 1)


@pytest.mark.parametrize(
    ("written", "reason"),
    [
        ("", "an empty text"),
        ("   ", "an empty text"),
        ("-", "'-' is not a time"),
        ("soon", "cannot read 'soon'"),
        ("5 parsecs", "unknown unit 'parsecs'"),
        ("1 h 30", "cannot read '30'"),
        ("h", "cannot read 'h'"),
        ("1 h and", "cannot read 'and'"),
        ("1.5.2 s", "cannot read"),
        ("5 min -3 s", "cannot read '-3 s'"),
        ("1/0", "divides by zero"),
        ("P", "cannot read 'P'"),
        ("PT", "cannot read 'PT'"),
        ("P1H", "cannot read 'P1H'"),
        ("PT1.2.3S", "is not a number"),
        ("0x10", "unknown unit 'x'"),
        ("1_000", "cannot read"),
        ("nan", "cannot read"),
        ("1e41", "out of range"),
        ("1e-41", "out of range"),
        ("1e999999999999999999999", "out of range"),
        ("9" * 90, "digits"),
        ("x" * 1000, "'xxx"),
        (10**MAX_DIGITS, "out of range"),
        (-(10**MAX_DIGITS), "out of range"),
        (float("nan"), "finite"),
        (float("inf"), "finite"),
        (Decimal("-Infinity"), "finite"),
        (True, "expected a time"),
        (None, "expected a time"),
        ([5], "expected a time"),
        ({"h": 1}, "expected a time"),
    ],
)
def test_what_is_no_time_is_refused_with_a_reason(written: Any, reason: str) -> None:
    with pytest.raises(TimeError) as refused:
        parse_span(written)
    assert reason in str(refused.value)
    assert len(str(refused.value)) < 250


@given(decimals)
def test_a_decimal_is_never_read_through_a_binary_float(value: Decimal) -> None:
    assert parse_span(value) == parse_number(str(value)) == Fraction(value)


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e30, max_value=1e30))
def test_a_python_float_means_its_shortest_decimal_text(value: float) -> None:
    if value and abs(value) < 1e-20:
        return  # More than the digits that are read; refused above.
    assert parse_span(value) == Fraction(repr(value))


UNITS = ["us", "µs", "ms", "s", "sec", "m", "min", "h", "hour", "d", "days", "w", "mo", "years"]


@pytest.mark.parametrize("unit", UNITS)
def test_units_in_texts_and_time_units_agree(unit: str) -> None:
    clock = Clock(unit_seconds(unit, 31), 31)
    assert clock.number(parse_span(f"2.5 {unit}")) == Fraction(5, 2)
    assert clock.number(parse_span(f"3{unit.upper() if unit.isascii() else unit}")) == 3


def test_an_unknown_time_unit_is_refused_with_those_known() -> None:
    with pytest.raises(TimeError, match=r"'fortnight'; known are ms, s, min"):
        unit_seconds("fortnight")


# --- date-times ---------------------------------------------------------------------------------

UTC = timezone.utc  # noqa: UP017 - the same on every supported Python
ORIGIN = datetime(2026, 3, 1, 8, tzinfo=UTC)


@pytest.mark.parametrize(
    ("written", "minutes"),
    [
        ("2026-03-01T08:00:00Z", 0),
        ("2026-03-01T09:30:00Z", 90),
        ("2026-03-01T10:30:00+01:00", 90),
        ("2026-03-01 09:30:00Z", 90),
        ("2026-03-01T07:59:59.999999Z", Fraction(-1, 60_000_000)),
        ("2026-03-01T08:00:00,5Z", Fraction(1, 120)),
        ("90 min", 90),
        (90, 90),
    ],
)
def test_a_date_time_counts_from_the_origin(written: Any, minutes: Any) -> None:
    clock = Clock(unit_seconds("min"), origin=ORIGIN)
    assert clock.number(parse_instant(written)) == minutes


def test_a_date_alone_is_its_midnight() -> None:
    assert parse_instant("2026-03-01") == datetime(2026, 3, 1)


@pytest.mark.parametrize(
    ("written", "reason"),
    [
        ("2026-02-30", "is not a date-time that exists"),
        ("2026-03-01T25:00", "is not a date-time that exists"),
        ("2026-03-01Tea", "is not a date-time that exists"),
        ("2026-03-01T08:00:00.1234567Z", "finer than a microsecond"),
        ("March 1st", "cannot read"),
    ],
)
def test_what_is_no_date_time_is_refused_with_a_reason(written: str, reason: str) -> None:
    with pytest.raises(TimeError, match=reason):
        parse_instant(written)


def test_a_date_time_is_no_length_of_time() -> None:
    with pytest.raises(TimeError, match="cannot read"):
        parse_span("2026-03-01T08:00:00Z")


@pytest.mark.parametrize(
    ("origin", "written", "reason"),
    [
        (None, "2026-03-01T08:00:00Z", "needs the task's 'origin'"),
        (ORIGIN, "2026-03-01T08:00:00", "must both have a time zone"),
        (ORIGIN.replace(tzinfo=None), "2026-03-01T08:00:00Z", "must both have a time zone"),
    ],
)
def test_a_date_time_needs_an_origin_of_its_kind(origin: Any, written: str, reason: str) -> None:
    with pytest.raises(TimeError, match=reason):
        Clock(Fraction(1), origin=origin).number(parse_instant(written))


@given(st.timedeltas(min_value=timedelta(-(10**5)), max_value=timedelta(10**5)))
def test_date_times_are_exact_to_the_microsecond(distance: timedelta) -> None:
    clock = Clock(Fraction(1, 10**6), origin=ORIGIN)
    written = (ORIGIN + distance).isoformat()
    assert clock.number(parse_instant(written)) == distance // timedelta(microseconds=1)


# --- writing ------------------------------------------------------------------------------------


@pytest.mark.slow
@given(exact_numbers)
def test_what_is_written_is_read_back_equal(value: Any) -> None:
    assert parse_number(format_number(value)) == value
    through_json = json.loads(json.dumps(json_number(value)), parse_float=Decimal)
    assert parse_span(through_json) == value


@pytest.mark.slow
@given(st.integers(-(10**9), 10**9), st.integers(1, 10**6))
def test_a_whole_number_is_always_an_int(numerator: int, denominator: int) -> None:
    value = parse_number(f"{numerator}/{denominator}")
    assert isinstance(value, int) == (numerator % denominator == 0)


@pytest.mark.parametrize(
    ("value", "text", "in_json"),
    [
        (0, "0", 0),
        (-12, "-12", -12),
        (Fraction(1, 2), "0.5", 0.5),
        (Fraction(-1, 20), "-0.05", -0.05),
        (Fraction(5, 4), "1.25", 1.25),
        (Fraction(1, 3), "1/3", "1/3"),
        (Fraction(-22, 7), "-22/7", "-22/7"),
        (Fraction(1, 10**6), "0.000001", 1e-6),
        (Fraction(1, 2**60), "1/1152921504606846976", "1/1152921504606846976"),
        (10**20 + Fraction(1, 2), "100000000000000000000.5", "100000000000000000000.5"),
    ],
)
def test_numbers_are_written_exactly_and_short(value: Any, text: str, in_json: Any) -> None:
    assert format_number(value) == text
    written = json_number(value)
    assert (written, type(written)) == (in_json, type(in_json))


# --- ticks --------------------------------------------------------------------------------------


@pytest.mark.slow
@given(st.lists(exact_numbers, max_size=8))
def test_the_tick_is_the_largest_that_divides_every_time(values: list[Any]) -> None:
    tick = common_tick(values)
    counts = [Fraction(value) / tick for value in values]
    assert tick > 0
    assert all(count.denominator == 1 for count in counts)
    assert gcd(*(int(count) for count in counts)) in (0, 1)
    assert any(counts) or tick == 1


@pytest.mark.parametrize(
    ("values", "tick"),
    [
        ([], 1),
        ([0, 0], 1),
        ([58_000_000, 29_000_000, 0], 29_000_000),
        ([Fraction(1, 10), 3], Fraction(1, 10)),
        ([Fraction(1, 3), Fraction(1, 4)], Fraction(1, 12)),
        ([-6, 9], 3),
    ],
)
def test_ticks_of_known_times(values: list[Any], tick: Any) -> None:
    assert common_tick(values) == tick
