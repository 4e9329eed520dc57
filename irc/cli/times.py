"""Times as text for people: dates and clock times where the task has an origin, else numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime, timedelta
from enum import StrEnum
from typing import TYPE_CHECKING

from irc.errors import OptionError
from irc.model.dates import Dates, clock_time, fineness, full
from irc.model.quantities import Number

if TYPE_CHECKING:
    from irc.model.task import Task


class TimesStyle(StrEnum):
    """How times are shown: as dates and clock times, or as numbers of the task's unit."""

    clock = "clock"
    unit = "unit"


DAYS_BY_NAME = 7
"""Within this many days, a day of the week says which day is meant."""


def dates_shown(
    dates: Dates | None, style: TimesStyle | None, times: Iterable[Number]
) -> Dates | None:
    """The dates in which times are shown; None where they are shown as numbers.

    Without a style, dates are shown where there are any. Raises `OptionError` where they are asked
    for and the task has no origin.
    """
    if style is TimesStyle.unit:
        return None
    reached = dates is not None and all(dates.reach(time) for time in times)
    if style is TimesStyle.clock and not reached:
        why = "the task has no 'origin'" if dates is None else "they are beyond the year 9999"
        raise OptionError(f"times cannot be shown as dates: {why}; leave --times out")
    return dates if reached else None


def require_times(task: Task, style: TimesStyle | None) -> None:
    """Raises `OptionError` where dates are asked for and the task has none."""
    dates_shown(Dates.of(task), style, ())


def dates_of(task: Task, style: TimesStyle | None, times: Iterable[Number]) -> Dates | None:
    """The dates in which times of a task are shown; see `dates_shown`."""
    return dates_shown(Dates.of(task), style, times)


class ClockText:
    """Writes the times of one output alike: the day only where there are several.

    One day: "06:00". A week: "Thu 06:00". Longer: "22 Oct 06:00", or "2026-10-22 06:00" where the
    year changes. An hour that the clock shows twice has its offset the second time.
    """

    def __init__(self, dates: Dates, times: Sequence[Number]) -> None:
        self.dates = dates
        shown = [dates.at(time) for time in times] or [dates.at(0)]
        self.first, self.last = min(shown, key=_naive), max(shown, key=_naive)
        self.days = (self.last.date() - self.first.date()).days + 1
        self.finest = max(map(fineness, shown))

    def text(self, time: Number) -> str:
        """A time by the clock."""
        at = self.dates.at(time)
        offset = f" {at:%z}" if at.fold else ""
        return f"{self._day(at)}{clock_time(at, self.finest)}{offset}"

    def _day(self, at: datetime) -> str:
        if self.days == 1:
            return ""
        if self.days <= DAYS_BY_NAME:
            return f"{at:%a} "
        if self.first.year == self.last.year:
            return f"{at.day:>2} {at:%b} "
        return f"{at:%Y-%m-%d} "

    def day_number(self, time: Number) -> int:
        """The number of a day, 1 for that of the first time."""
        return (self.dates.at(time).date() - self.first.date()).days + 1

    @property
    def span(self) -> str:
        """The first and the last time in full, with the zone."""
        zone = getattr(self.dates.zone, "key", None)
        where = f" ({zone})" if zone else ""
        return f"{full(self.first)} to {full(self.last)}{where}"


def _naive(at: datetime) -> tuple[datetime, timedelta | None]:
    return at.replace(tzinfo=None), at.utcoffset()
