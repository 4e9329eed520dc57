"""The units of time in English texts, as units of the IR."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from irc.model.quantities import MONTH_NAMES, UNIT_SECONDS

UNITS: Mapping[str, tuple[int, str]] = {
    **{name: (1, name) for name in (*UNIT_SECONDS, *MONTH_NAMES)},
    "fortnight": (2, "weeks"),
    "fortnights": (2, "weeks"),
    "decade": (10, "years"),
    "decades": (10, "years"),
    "mos": (1, "months"),
}
"""A unit as written → how many of which unit of the IR it is."""


def unit_size(unit: str) -> tuple[Fraction, Fraction]:
    """Seconds and months in one unit of the IR."""
    if unit in MONTH_NAMES:
        return Fraction(0), Fraction(1)
    return UNIT_SECONDS[unit], Fraction(0)
