"""Times written as text: numbers, units, ISO 8601. Loaded only where a task has such texts."""

from __future__ import annotations

import re
from datetime import datetime
from decimal import Decimal, InvalidOperation
from fractions import Fraction

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

_DECIMAL = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")
_RATIO = re.compile(r"([+-]?\d+)\s*/\s*(\d+)")
_PART = re.compile(
    r"(\d+\s*/\s*\d+|\d+(?:\.\d*)?|\.\d+)\s*([^\W\d_]+)(?:\.(?!\d))?\s*(?:,\s*|and\s+)?"
)
_ISO = re.compile(
    r"P(?=.)(?:(?P<Y>[\d.,]+)Y)?(?:(?P<Mo>[\d.,]+)M)?(?:(?P<W>[\d.,]+)W)?(?:(?P<D>[\d.,]+)D)?"
    r"(?:T(?=.)(?:(?P<h>[\d.,]+)H)?(?:(?P<m>[\d.,]+)M)?(?:(?P<s>[\d.,]+)S)?)?"
)
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}([T ].*)?")
_TOO_FINE = re.compile(r"[.,]\d{6}\d*[1-9]")
_ISO_SECONDS = {"Y": 365 * DAY, "W": 7 * DAY, "D": DAY, "h": 3600, "m": 60, "s": 1}


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
        raise TimeError(f"{shown(text)} is not a number")
    try:
        return from_decimal(Decimal(text))
    except InvalidOperation:
        raise TimeError(f"{shown(text)} is out of range") from None


def parse_text(text: str) -> Span:
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
    if not body:
        raise TimeError(f"{shown(text)} is not a time")
    seconds, months, at = Fraction(0), Fraction(0), 0
    while at < len(body):
        part = _PART.match(body, at)
        if part is None:
            raise TimeError(
                f"cannot read {shown(body[at:])} as a time; "
                f"write a number and a unit ({UNIT_EXAMPLES}), as in '1 h 30 min'"
            )
        amount, unit = Fraction(parse_number(part[1])), part[2].lower()
        if unit in MONTH_NAMES:
            months += amount
        elif unit in UNIT_SECONDS:
            seconds += amount * UNIT_SECONDS[unit]
        else:
            raise TimeError(_unknown_unit(part[2]))
        at = part.end()
    return Quantity(text, sign * seconds, sign * months)


def _unknown_unit(unit: str) -> str:
    from difflib import get_close_matches

    close = get_close_matches(unit.lower(), [*UNIT_SECONDS, *MONTH_NAMES], n=1)
    meant = f"did you mean {close[0]!r}? Known" if close else "known"
    return f"unknown unit {shown(unit)}; {meant} are {UNIT_EXAMPLES}"


_CLOCK = re.compile(r"([0-9]{1,2}):([0-9]{2})(?::([0-9]{2}))?")


def day_time(text: str) -> str:
    """A time of day in its usual form: "6:00" is "06:00". Raises `TimeError`."""
    found = _CLOCK.fullmatch(text)
    if found is not None:
        hours, minutes, seconds = (int(part or 0) for part in found.groups())
        whole = hours * 3600 + minutes * 60 + seconds
        if minutes < 60 and seconds < 60 and whole <= 24 * 3600:
            return f"{hours:02}:{minutes:02}" + (f":{seconds:02}" if seconds else "")
    raise TimeError(f"{shown(text)} is not a time of day; write it as '06:00' or '22:30'")


def day_seconds(text: str) -> int:
    """The seconds from midnight to a time of day in its usual form."""
    return sum(int(part) * size for part, size in zip(text.split(":"), (3600, 60, 1), strict=False))


def parse_date(text: str) -> datetime | None:
    """The date-time that an ISO 8601 text names; None where the text is something else.

    Raises `TimeError` for a date-time that does not exist.
    """
    if not _DATE.fullmatch(text):
        return None
    if _TOO_FINE.search(text):
        raise TimeError(f"{shown(text)} is finer than a microsecond")
    try:
        return datetime.fromisoformat(text)
    except ValueError:
        raise TimeError(f"{shown(text)} is not a date-time that exists") from None
