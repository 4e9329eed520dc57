"""Time zones of calendars, by their names in the IANA database."""

from __future__ import annotations

from datetime import tzinfo
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irc.model.task import Task


@cache
def zone(name: str) -> tzinfo | None:
    """The zone of a name such as "Europe/Berlin"; None where there is none."""
    from zoneinfo import ZoneInfo

    try:
        return ZoneInfo(name)
    except (LookupError, ValueError, OSError):  # Not there, or no name of a zone at all.
        return None


def zone_names() -> frozenset[str]:
    """The names of all zones."""
    from zoneinfo import available_timezones

    return frozenset(available_timezones())


def zone_of_naive_times(task: Task) -> tzinfo | None:
    """The zone of date-times without one, where the `origin` has none either: the calendars' own.

    None where the calendars name no zone, or different ones.
    """
    if task.origin is None or task.origin.tzinfo is not None:
        return None
    names = {calendar.time_zone for calendar in task.calendars} - {None}
    return zone(names.pop()) if len(names) == 1 else None
