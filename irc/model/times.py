"""Exact time: the forms that a user may write, as rational numbers of the task's time unit.

Nothing here passes through a binary float: a JSON decimal is read as a decimal, a Python `float`
through its shortest decimal text.
"""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime, tzinfo
from decimal import Decimal
from fractions import Fraction
from math import floor, gcd, lcm
from typing import NamedTuple

from irc.model.quantities import (
    DAY,
    MAX_DIGITS,
    MONTH_NAMES,
    UNIT_EXAMPLES,
    UNIT_SECONDS,
    Number,
    Quantity,
    Span,
    TimeError,
    exact,
    from_decimal,
    shown,
)

Instant = int | Fraction | Quantity | datetime
"""A point in time: a span after t = 0, or a date-time, read against the task's `origin`."""


def parse_number(text: str) -> Number:
    """The exact value of a decimal ("0.1", "2e3") or a ratio ("1/3"); `TimeError` otherwise."""
    from irc.model.time_text import parse_number

    return parse_number(text)


def parse_span(raw: object) -> Span:
    """A length of time as it stands in JSON or Python, kept as it was written.

    Takes integers, decimals, `Fraction`s and texts ("90 days", "1 h 30 min", "PT1H30M", "1/3").
    Raises `TimeError` otherwise. The sign is not judged here.
    """
    if type(raw) is int:
        if abs(raw) >= 10**MAX_DIGITS:
            raise TimeError(f"the number is out of range: at most {MAX_DIGITS} digits are read")
        return raw
    if isinstance(raw, str):
        from irc.model.time_text import parse_text

        return parse_text(raw.strip())
    if isinstance(raw, Fraction):
        return exact(raw)
    if isinstance(raw, Decimal):
        return from_decimal(raw)
    if isinstance(raw, float):
        return from_decimal(Decimal(repr(raw)))
    if isinstance(raw, Quantity):
        return raw
    raise TimeError("expected a time: a number, or a text with units such as '1 h 30 min'")


def parse_instant(raw: object) -> Instant:
    """A point in time: all that `parse_span` takes, and ISO 8601 date-times."""
    if isinstance(raw, datetime):
        return raw
    if isinstance(raw, str):
        from irc.model.time_text import parse_date

        date = parse_date(raw.strip())
        if date is not None:
            return date
    return parse_span(raw)


def parse_day_time(raw: object) -> str | Span:
    """A time of day ("06:00", "22:30:15", "24:00"), which stays text, or a length of time.

    Raises `TimeError` for a time that no clock shows.
    """
    if isinstance(raw, str) and ":" in raw:
        from irc.model.time_text import day_time

        return day_time(raw.strip())
    return parse_span(raw)


def unit_seconds(unit: str, days_per_month: Number = 30) -> Fraction:
    """Seconds in one `unit` ("s", "min", "day", "month" …). Raises `TimeError` if unknown."""
    name = unit.strip().lower()
    if name in MONTH_NAMES:
        return Fraction(days_per_month) * DAY
    if name not in UNIT_SECONDS:
        raise TimeError(f"unknown time unit {shown(unit)}; known are {UNIT_EXAMPLES}")
    return UNIT_SECONDS[name]


class Clock(NamedTuple):
    """Turns times as written into exact numbers of one task's time unit."""

    unit: Fraction
    """Seconds in the task's time unit."""
    days_per_month: Number = 30
    origin: datetime | None = None
    resolution: Number | None = None
    """Times are read as multiples of it, in the task's time unit; None: exactly."""
    zone: tzinfo | None = None
    """The zone of date-times that name none; None: they count from an `origin` that names none."""

    def number(self, value: Instant) -> Number:
        """`value` in the task's time unit, rounded to the resolution if there is one.

        Raises `TimeError` for a date-time when the task has no `origin`, or where only one of the
        two has a time zone.
        """
        number = self.exact(value)
        return number if self.resolution is None else rounded(number, self.resolution)

    def exact(self, value: Instant) -> Number:
        """`value` in the task's time unit, as it was written. Raises what `number` raises."""
        if isinstance(value, (int, Fraction)):
            return value
        if isinstance(value, Quantity):
            seconds = value.seconds + value.months * Fraction(self.days_per_month) * DAY
            return exact(seconds / self.unit)
        if self.origin is None:
            raise TimeError("a date-time needs the task's 'origin' (the date-time of t = 0)")
        origin = self.origin
        if self.zone is not None:
            value, origin = in_utc(value, self.zone), in_utc(origin, self.zone)
        if (value.tzinfo is None) != (origin.tzinfo is None):
            raise TimeError("the date-time and the task's 'origin' must both have a time zone")
        delta = value - origin
        micros = (delta.days * DAY + delta.seconds) * 1_000_000 + delta.microseconds
        return exact(Fraction(micros, 1_000_000) / self.unit)


def in_utc(value: datetime, zone: tzinfo) -> datetime:
    """A date-time in UTC; one that names no zone is read in `zone`.

    Of a local time that clocks show twice it is the first; a local time that they leave out is
    read as if they had not been put forward yet (PEP 495, fold 0).
    """
    return (value if value.tzinfo else value.replace(tzinfo=zone)).astimezone(UTC)


def rounded(value: Number, resolution: Number) -> Number:
    """The multiple of `resolution` that is nearest to `value`; a half goes up."""
    if type(value) is int and resolution.numerator == 1:
        return value
    steps = Fraction(value) / resolution
    return exact(floor(steps + Fraction(1, 2)) * Fraction(resolution))


def common_tick(values: Iterable[Number]) -> Fraction:
    """The largest rational that divides every value: their gcd; 1 when all are 0."""
    numerator, denominator = 0, 1
    for value in values:
        if type(value) is int:
            numerator = gcd(numerator, value * denominator)
        else:
            wider = lcm(denominator, value.denominator)
            numerator = gcd(
                numerator * (wider // denominator), value.numerator * (wider // value.denominator)
            )
            denominator = wider
    return Fraction(numerator, denominator) if numerator else Fraction(1)


def format_number(value: Number) -> str:
    """Shortest exact text: "12", "0.5"; "1/3" where no decimal ends (or none that is read)."""
    if isinstance(value, int):
        return str(value)
    rest, twos, fives = value.denominator, 0, 0
    while rest % 2 == 0:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    places = max(twos, fives)
    if rest != 1 or places > MAX_DIGITS:
        return f"{value.numerator}/{value.denominator}"
    digits = str(abs(value.numerator) * 10**places // value.denominator).rjust(places + 1, "0")
    text = f"{digits[:-places]}.{digits[-places:]}" if places else digits
    return f"-{text}" if value < 0 else text


def json_number(value: Number) -> int | float | str:
    """`value` for JSON: whole numbers as integers, decimals that end as decimals, else "1/3".

    A decimal longer than a binary float's shortest text stays text, so nothing is rounded.
    """
    if isinstance(value, int):
        return value
    text = format_number(value)
    if "/" in text:
        return text
    short = float(text)
    return short if Fraction(repr(short)) == value else text
