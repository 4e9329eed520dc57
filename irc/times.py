"""Exact time: what a user may write, and how it becomes a rational number of the task's time unit.

Nothing here passes through a binary float: a JSON decimal is read as a decimal, a Python `float`
through its shortest decimal text.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from math import gcd, lcm

Number = int | Fraction
"""An exact number; whole values are always `int`, never a `Fraction` with denominator 1."""

MAX_DIGITS = 40
"""Numbers with more digits (before or behind the point) are refused: no schedule needs them."""

_DAY = 86_400
_UNIT_SECONDS: dict[str, Fraction] = {
    name: Fraction(seconds)
    for names, seconds in (
        ("us µs microsecond microseconds", Fraction(1, 1_000_000)),
        ("ms msec millisecond milliseconds", Fraction(1, 1000)),
        ("s sec secs second seconds", 1),
        ("m min mins minute minutes", 60),
        ("h hr hrs hour hours", 3600),
        ("d day days", _DAY),
        ("w wk wks week weeks", 7 * _DAY),
        ("y yr yrs year years", 365 * _DAY),
    )
    for name in names.split()
}
_MONTH_NAMES = frozenset(["mo", "mon", "month", "months"])

UNIT_EXAMPLES = "ms, s, min, h, day, week, month, year"

_DECIMAL = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")
_RATIO = re.compile(r"([+-]?\d+)\s*/\s*(\d+)")
_PART = re.compile(r"(\d+(?:\.\d*)?|\.\d+)\s*([^\W\d_]+)\.?\s*(?:,\s*|and\s+)?", re.UNICODE)
_ISO = re.compile(
    r"P(?=.)(?:(?P<Y>[\d.,]+)Y)?(?:(?P<Mo>[\d.,]+)M)?(?:(?P<W>[\d.,]+)W)?(?:(?P<D>[\d.,]+)D)?"
    r"(?:T(?=.)(?:(?P<h>[\d.,]+)H)?(?:(?P<m>[\d.,]+)M)?(?:(?P<s>[\d.,]+)S)?)?"
)
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}([T ].*)?")
_ISO_SECONDS = {"Y": 365 * _DAY, "W": 7 * _DAY, "D": _DAY, "h": 3600, "m": 60, "s": 1}


class TimeError(ValueError):
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
    """The exact value of a decimal ("0.1", "2e3") or a ratio ("1/3").

    Raises `TimeError` for anything else and for more than `MAX_DIGITS` digits.
    """
    ratio = _RATIO.fullmatch(text)
    if ratio and len(text) <= 2 * MAX_DIGITS:
        if int(ratio[2]) == 0:
            raise TimeError(f"{text!r} divides by zero")
        return exact(Fraction(int(ratio[1]), int(ratio[2])))
    if not _DECIMAL.fullmatch(text):
        raise TimeError(f"{_shown(text)} is not a number")
    try:
        return _from_decimal(Decimal(text))
    except InvalidOperation:
        raise TimeError(f"{_shown(text)} is out of range") from None


def _shown(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")


def _from_decimal(value: Decimal) -> Number:
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
        return _parse_text(raw.strip())
    if isinstance(raw, Fraction):
        return exact(raw)
    if isinstance(raw, Decimal):
        return _from_decimal(raw)
    if isinstance(raw, float):
        return _from_decimal(Decimal(repr(raw)))
    if isinstance(raw, Quantity):
        return raw
    raise TimeError("expected a time: a number, or a text with units such as '1 h 30 min'")


def parse_instant(raw: object) -> Instant:
    """A point in time: all that `parse_span` takes, and ISO 8601 date-times."""
    if isinstance(raw, datetime):
        return raw
    if isinstance(raw, str) and _DATE.fullmatch(raw.strip()):
        try:
            return datetime.fromisoformat(raw.strip())
        except ValueError:
            raise TimeError(f"{_shown(raw)} is not a date-time that exists") from None
    return parse_span(raw)


def _parse_text(text: str) -> Span:
    if not text:
        raise TimeError("an empty text is not a time")
    if _DECIMAL.fullmatch(text) or _RATIO.fullmatch(text):
        return parse_number(text)
    iso = _ISO.fullmatch(text.upper()) if text[0] in "Pp" else None
    if iso:
        return _from_iso(text, iso)
    return _from_parts(text)


def _from_iso(text: str, iso: re.Match[str]) -> Quantity:
    seconds, months = Fraction(0), Fraction(0)
    for name, digits in iso.groupdict().items():
        if digits is None:
            continue
        amount = Fraction(parse_number(digits.replace(",", ".")))
        if name == "Mo":
            months += amount
        else:
            seconds += amount * _ISO_SECONDS[name]
    return Quantity(text, seconds, months)


def _from_parts(text: str) -> Quantity:
    sign, body = (-1, text[1:].lstrip()) if text[0] == "-" else (1, text)
    seconds, months, at = Fraction(0), Fraction(0), 0
    while at < len(body):
        part = _PART.match(body, at)
        if part is None:
            raise TimeError(
                f"cannot read {_shown(body[at:])} as a time; "
                f"write a number and a unit ({UNIT_EXAMPLES}), as in '1 h 30 min'"
            )
        amount, unit = Fraction(parse_number(part[1])), part[2].lower()
        if unit in _MONTH_NAMES:
            months += amount
        elif unit in _UNIT_SECONDS:
            seconds += amount * _UNIT_SECONDS[unit]
        else:
            raise TimeError(f"unknown unit {_shown(part[2])}; known are {UNIT_EXAMPLES}")
        at = part.end()
    return Quantity(text, sign * seconds, sign * months)


def unit_seconds(unit: str, days_per_month: Number = 30) -> Fraction:
    """Seconds in one `unit` ("s", "min", "day", "month" …). Raises `TimeError` if unknown."""
    name = unit.strip().lower()
    if name in _MONTH_NAMES:
        return Fraction(days_per_month) * _DAY
    if name not in _UNIT_SECONDS:
        raise TimeError(f"unknown time unit {_shown(unit)}; known are {UNIT_EXAMPLES}")
    return _UNIT_SECONDS[name]


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
            seconds = value.seconds + value.months * Fraction(self.days_per_month) * _DAY
            return exact(seconds / self.unit)
        if self.origin is None:
            raise TimeError("a date-time needs the task's 'origin' (the date-time of t = 0)")
        if (value.tzinfo is None) != (self.origin.tzinfo is None):
            raise TimeError("the date-time and the task's 'origin' must both have a time zone")
        delta = value - self.origin
        micros = (delta.days * _DAY + delta.seconds) * 1_000_000 + delta.microseconds
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
    """Shortest exact text: "12", "0.5"; "1/3" where no decimal ends."""
    if isinstance(value, int):
        return str(value)
    rest, twos, fives = value.denominator, 0, 0
    while rest % 2 == 0:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    if rest != 1:
        return f"{value.numerator}/{value.denominator}"
    places = max(twos, fives)
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
