"""Exact time: what a user may write, and how it becomes a rational number of the task's time unit.

Nothing here passes through a binary float: a JSON decimal is read as a decimal, a Python `float`
through its shortest decimal text.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from decimal import Decimal
from fractions import Fraction
from math import gcd, lcm

from irc.errors import IrcError

Number = int | Fraction
"""An exact number; whole values are always `int`, never a `Fraction` with denominator 1."""

MAX_DIGITS = 40
"""Numbers with more digits (before or behind the point) are refused: no schedule needs them."""

DAY = 86_400
UNIT_SECONDS: dict[str, Fraction] = {
    name: Fraction(seconds)
    for names, seconds in (
        ("us µs microsecond microseconds", Fraction(1, 1_000_000)),
        ("ms msec millisecond milliseconds", Fraction(1, 1000)),
        ("s sec secs second seconds", 1),
        ("m min mins minute minutes", 60),
        ("h hr hrs hour hours", 3600),
        ("d day days", DAY),
        ("w wk wks week weeks", 7 * DAY),
        ("y yr yrs year years", 365 * DAY),
    )
    for name in names.split()
}
MONTH_NAMES = frozenset(["mo", "mon", "month", "months"])

UNIT_EXAMPLES = "ms, s, min, h, day, week, month, year"


class TimeError(IrcError, ValueError):
    """A time that cannot be read, or has no exact value here; the text says what was expected."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A time written with units, such as "1 h 30 min": exact seconds plus calendar months."""

    text: str
    seconds: Fraction
    months: Fraction = Fraction(0)


Span = int | Fraction | Quantity
"""A length of time: a number of the task's time unit, or a text with units of its own."""

Instant = int | Fraction | Quantity | datetime
"""A point in time: a span after t = 0, or a date-time, read against the task's `origin`."""


def exact(value: Fraction) -> Number:
    """`value` as an `int` where it is whole."""
    return value.numerator if value.denominator == 1 else value


def parse_number(text: str) -> Number:
    """The exact value of a decimal ("0.1", "2e3") or a ratio ("1/3"); `TimeError` otherwise."""
    from irc.model.time_text import parse_number

    return parse_number(text)


def shown(text: str) -> str:
    """A text as messages quote it."""
    return repr(text if len(text) <= 40 else text[:37] + "...")


def from_decimal(value: Decimal) -> Number:
    """The exact value; `TimeError` if it is not finite or has more than `MAX_DIGITS` digits."""
    if not value.is_finite():
        raise TimeError("a time must be a finite number")
    if not value:
        return 0
    _, digits, exponent = value.as_tuple()
    if not isinstance(exponent, int) or exponent < -MAX_DIGITS or value.adjusted() >= MAX_DIGITS:
        raise TimeError(f"the number is out of range: at most {MAX_DIGITS} digits are read")
    if len(digits) > 2 * MAX_DIGITS:
        raise TimeError(f"the number has {len(digits)} digits; at most {2 * MAX_DIGITS} are read")
    return exact(Fraction(value))


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


def unit_seconds(unit: str, days_per_month: Number = 30) -> Fraction:
    """Seconds in one `unit` ("s", "min", "day", "month" …). Raises `TimeError` if unknown."""
    name = unit.strip().lower()
    if name in MONTH_NAMES:
        return Fraction(days_per_month) * DAY
    if name not in UNIT_SECONDS:
        raise TimeError(f"unknown time unit {shown(unit)}; known are {UNIT_EXAMPLES}")
    return UNIT_SECONDS[name]


@dataclass(frozen=True)
class Clock:
    """Turns times as written into exact numbers of one task's time unit."""

    unit: Fraction
    """Seconds in the task's time unit."""
    days_per_month: Number = 30
    origin: datetime | None = None

    def number(self, value: Instant) -> Number:
        """`value` in the task's time unit.

        Raises `TimeError` for a date-time when the task has no `origin`, or where only one of the
        two says its time zone.
        """
        if isinstance(value, (int, Fraction)):
            return value
        if isinstance(value, Quantity):
            seconds = value.seconds + value.months * Fraction(self.days_per_month) * DAY
            return exact(seconds / self.unit)
        if self.origin is None:
            raise TimeError("a date-time needs the task's 'origin' (the date-time of t = 0)")
        if (value.tzinfo is None) != (self.origin.tzinfo is None):
            raise TimeError("the date-time and the task's 'origin' must both have a time zone")
        delta = value - self.origin
        micros = (delta.days * DAY + delta.seconds) * 1_000_000 + delta.microseconds
        return exact(Fraction(micros, 1_000_000) / self.unit)


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
