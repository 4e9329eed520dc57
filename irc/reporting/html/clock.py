"""Clock times of a report: the texts of its cells, and what its time axis needs."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime, timedelta
from fractions import Fraction
from typing import Any

from irc.model.dates import Dates
from irc.model.quantities import Number, exact
from irc.model.times import format_number

_WEEKDAYS = ("Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun")
_DAY, MOST_DAYS = 86_400, 4_000
"""Clocks are asked once a day, at most this often: beyond, they are taken not to change."""


def clock_text(dates: Dates | None, time: Number | None) -> str:
    """ "Mon 2026-03-02 06:30", with seconds where there are some; empty without dates."""
    if dates is None or time is None or not dates.reach(time):
        return ""
    moment = dates.at(time)
    precision = "minutes"
    if moment.microsecond:
        precision = "microseconds"
    elif moment.second:
        precision = "seconds"
    shown = moment.replace(tzinfo=None).isoformat(" ", timespec=precision)
    return f"{_WEEKDAYS[moment.weekday()]} {shown}"


def axis_of(dates: Dates | None, until: Number) -> dict[str, Any] | None:
    """The local time of t = 0, the name of the zone, and by how much clocks change and when.

    `offsets` has [time in the task's unit, seconds by which clocks are then ahead of those at 0].
    None without dates.
    """
    if dates is None or not dates.reach(0):
        return None
    begin = dates.at(0)
    return {
        "local": begin.replace(tzinfo=None).isoformat(timespec="milliseconds"),
        "zone": _zone_name(begin),
        "offsets": [[format_number(at), ahead] for at, ahead in _changes(dates, until)],
    }


def _zone_name(moment: datetime) -> str:
    if moment.tzinfo is None:
        return ""
    return str(getattr(moment.tzinfo, "key", None) or moment.tzname() or "")


def _changes(dates: Dates, until: Number) -> Iterator[tuple[Number, int]]:
    """(from when on, the seconds by which clocks are ahead of those at 0)."""
    first = _offset(dates.at(0))
    yield 0, 0
    low, length = 0, int(Fraction(until) * dates.unit) + 1
    for k in range(1, min(length // _DAY + 2, MOST_DAYS)):
        high = min(k * _DAY, length)
        if not dates.reach(exact(Fraction(high) / dates.unit)):
            return
        now = _at(dates, high)
        if now != _at(dates, low):
            yield exact(Fraction(_when(dates, low, high)) / dates.unit), now - first
        low = high


def _when(dates: Dates, low: int, high: int) -> int:
    """The first second after `low`, up to `high`, at which clocks have the offset of `high`."""
    wanted = _at(dates, high)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if _at(dates, middle) == wanted else (middle, high)
    return high


def _at(dates: Dates, seconds: int) -> int:
    return _offset(dates.at(exact(Fraction(seconds) / dates.unit)))


def _offset(moment: datetime) -> int:
    offset = moment.utcoffset() or timedelta(0)
    return round(offset.total_seconds())
