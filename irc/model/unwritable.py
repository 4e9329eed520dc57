"""Finds what JSON cannot hold in data that a program made: NaN, half a character, other objects."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal
from math import isfinite
from typing import Any

MOST_LEVELS = 64
"""Limit on the depth of nesting, as for JSON texts."""


def unwritable(data: Any) -> str | None:
    """The first fault of some data in words; None if JSON can hold them."""
    level = [data]
    for _ in range(MOST_LEVELS):
        fault = next(filter(None, map(_fault, level)), None)
        if fault is not None or not level:
            return fault
        level = [inner for outer in level for inner in _inside(outer)]
    return f"nested more than {MOST_LEVELS} levels deep"


def _inside(value: Any) -> Iterator[Any]:
    if isinstance(value, dict):
        yield from value
        yield from value.values()
    elif isinstance(value, (list, tuple)):
        yield from value


def _fault(value: Any) -> str | None:
    if isinstance(value, str):
        halves = not value.isascii() and any("\ud800" <= c <= "\udfff" for c in value)
        return "a text with half a character (a lone surrogate)" if halves else None
    if isinstance(value, (float, Decimal)):
        finite = value.is_finite() if isinstance(value, Decimal) else isfinite(value)
        return None if finite else f"{value} is not a number in JSON"
    if value is None or isinstance(value, (int, dict, list, tuple)):
        return None
    return f"JSON cannot hold a value of type {type(value).__name__}"
