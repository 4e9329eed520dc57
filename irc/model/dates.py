"""The dates of a task with an `origin`: times of its unit as date-times, and back."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, tzinfo
from fractions import Fraction
from typing import TYPE_CHECKING

from irc.model.quantities import MONTH_NAMES, Number, TimeError, exact
from irc.model.times import in_utc, parse_instant, unit_seconds

if TYPE_CHECKING:
    from irc.model.task import Task

_MICROSECOND = timedelta(microseconds=1)


@dataclass(frozen=True, slots=True)
class Dates:
    """Turns times of one task into date-times, to the microsecond.

    `unit` are the seconds in the task's time unit. Date-times are in `zone`; where it is None they
    have no zone, because neither the `origin` nor a calendar names one.
    """

    origin: datetime
    unit: Fraction
    zone: tzinfo | None = None

    @classmethod
    def of(cls, task: Task) -> Dates | None:
        """The dates of a task; None where it has no `origin`."""
        if task.origin is None:
            return None
        return cls(task.origin, task.clock.unit, shown_zone(task))

    def at(self, time: Number) -> datetime:
        """The date-time of a time. Raises `TimeError` beyond the years 1 to 9999."""
        passed = round(Fraction(time) * self.unit * 1_000_000)
        try:
            if self.zone is None:
                return self.origin + timedelta(microseconds=passed)
            moved = in_utc(self.origin, self.zone) + timedelta(microseconds=passed)
            return moved.astimezone(self.zone)
        except (OverflowError, ValueError):
            raise TimeError("the date is not within the years 1 to 9999") from None

    @classmethod
    def read(cls, origin: str, name: str | None, unit: str) -> Dates | None:
        """The dates that a schedule's document states; None for a unit of several lengths.

        Raises `TimeError` for what is no date-time or no zone.
        """
        from irc.model.zones import zone

        found = parse_instant(origin)
        if not isinstance(found, datetime):
            raise TimeError(f"{origin!r} is not a date-time")
        local = found.tzinfo if name is None else zone(name)
        if name is not None and local is None:
            raise TimeError(f"there is no time zone {name!r}")
        if unit.strip().lower() in MONTH_NAMES:
            return None
        return cls(found, unit_seconds(unit), local)

    def to_dict(self) -> dict[str, str]:
        """The fields of a schedule's document from which dates can be made again."""
        name = getattr(self.zone, "key", None)
        return {
            "origin": self.origin.isoformat(),
            **({} if name is None else {"time_zone": name}),
        }

    def text(self, time: Number) -> str:
        """A time as a date-time in ISO 8601."""
        return self.at(time).isoformat()

    def agree(self, stated: str, time: Number) -> bool:
        """Whether a text is the date-time of a time, to the microsecond."""
        try:
            moment = datetime.fromisoformat(stated)
            apart = abs(Fraction(self.number(moment)) - time)
        except (TimeError, ValueError, OverflowError):
            return False
        return apart * self.unit <= Fraction(1, 1_000_000)

    def number(self, moment: datetime) -> Number:
        """The time of a date-time in the task's unit.

        Raises `TimeError` where only one of the two has a zone.
        """
        origin = self.origin
        if self.zone is not None:
            moment, origin = in_utc(moment, self.zone), in_utc(origin, self.zone)
        if (moment.tzinfo is None) != (origin.tzinfo is None):
            raise TimeError("the date-time and the task's 'origin' must both have a time zone")
        return exact(Fraction((moment - origin) // _MICROSECOND, 1_000_000) / self.unit)

    def reach(self, time: Number) -> bool:
        """Whether a time has a date-time."""
        try:
            self.at(time)
        except TimeError:
            return False
        return True

    def midnight_after(self, time: Number) -> tuple[Number, datetime]:
        """The first midnight after a time: its time, and the date-time that clocks show."""
        shown = self.at(time)
        day = shown.replace(hour=0, minute=0, second=0, microsecond=0, fold=0) + timedelta(days=1)
        return self.number(day), day


_CLOCKS = ("%H:%M", "%H:%M:%S", "%H:%M:%S.%f")


def clock_time(at: datetime, fineness: int) -> str:
    """The time of day: in minutes (fineness 0), seconds (1) or microseconds (2)."""
    return at.strftime(_CLOCKS[fineness])


def fineness(at: datetime) -> int:
    """The fineness that a date-time needs; see `clock_time`."""
    return 2 if at.microsecond else (1 if at.second else 0)


def full(at: datetime) -> str:
    """A date-time in full, for people: "Thu 22 Oct 2026 06:00"."""
    return f"{at:%a} {at.day} {at:%b %Y} {clock_time(at, fineness(at))}"


def shown_zone(task: Task) -> tzinfo | None:
    """The zone in which the dates of a task are shown.

    It is that of its calendars, if they name one and its clock shows what the origin shows; else
    that of the origin. (An origin has an offset at most, which changes with the season.)
    """
    origin = task.origin
    if origin is None:
        return None
    if origin.tzinfo is None:
        return task.clock.zone
    from irc.model.zones import zone

    names = {calendar.time_zone for calendar in task.calendars} - {None}
    local = zone(names.pop()) if len(names) == 1 else None
    if local is not None and origin.astimezone(local).utcoffset() == origin.utcoffset():
        return local
    return UTC if origin.tzinfo is UTC else origin.tzinfo
