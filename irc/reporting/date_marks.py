"""Round hours and midnights by the clock of dates, for the axes of charts."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import timedelta

from irc.model.dates import Dates
from irc.model.quantities import Number

_HOURS = (1, 2, 3, 6, 12)
_DAYS = (1, 2, 7, 14, 28, 91, 182, 364)


def date_marks(
    dates: Dates, first: Number, last: Number, most: int = 12
) -> Iterator[tuple[Number, str]]:
    """(time, text) of round hours, or of midnights, by the clock of the dates: `most` at most."""
    seconds = (last - first) * dates.unit
    if seconds < 3600 or not (dates.reach(first) and dates.reach(last)):
        return
    for hours in _HOURS:
        if seconds / (hours * 3600) <= most:
            yield from _hour_marks(dates, first, last, hours)
            return
    for days in _DAYS:
        if seconds / (days * 86_400) <= most:
            yield from _day_marks(dates, first, last, days)
            return


def _hour_marks(
    dates: Dates, first: Number, last: Number, step: int
) -> Iterator[tuple[Number, str]]:
    at = dates.at(first).replace(minute=0, second=0, microsecond=0, fold=0)
    at = at.replace(hour=at.hour - at.hour % step)
    named = None
    while (time := dates.number(at)) <= last:
        if time >= first:
            text = f"{at:%H:%M}" if at.date() == named else f"{at:%a} {at.day} {at:%b %H:%M}"
            named = at.date()
            yield time, text
        at += timedelta(hours=step)


def _day_marks(
    dates: Dates, first: Number, last: Number, step: int
) -> Iterator[tuple[Number, str]]:
    at = dates.at(first).replace(hour=0, minute=0, second=0, microsecond=0, fold=0)
    while (time := dates.number(at)) <= last:
        if time >= first:
            yield time, f"{at:%a} {at.day} {at:%b}"
        at += timedelta(days=step)
