"""Exact numbers, and quantities of time with units."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

from irc.errors import IrcError

Number = int | Fraction
"""An exact number; whole values are always `int`, never a `Fraction` with denominator 1."""


MAX_DIGITS = 40
"""Numbers with more digits (before or after the point) are refused: no schedule needs them."""


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
    """A time cannot be read, or has no exact value here; the text says what is expected."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A time written with units, such as "1 h 30 min": exact seconds plus calendar months."""

    text: str
    seconds: Fraction
    months: Fraction = Fraction(0)


Span = int | Fraction | Quantity
"""A length of time: a number of the task's time unit, or a text with units of its own."""


def exact(value: Fraction) -> Number:
    """`value` as an `int` where it is whole."""
    return value.numerator if value.denominator == 1 else value


def shown(text: str) -> str:
    """A text in quotes, for messages."""
    return repr(text if len(text) <= 40 else text[:37] + "...")


def level_of(raw: object) -> Number:
    """The exact level of a number variable, as it stands in JSON or Python; `ValueError` if none.

    Takes integers, decimals, `Fraction`s, and texts such as "0.25" and "1/3".
    """
    from irc.model.times import parse_span

    try:
        level = None if isinstance(raw, bool) else parse_span(raw)
    except TimeError:
        level = None
    if isinstance(level, (int, Fraction)):
        return level
    raise ValueError('expected a number without a unit, such as 40, 2.5 or "1/3"')


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
