"""Schedules: what an answer is, as objects and as documents."""

from irc.schedule.entry import ABANDONED, BEGUN, CANCELLED, Entry, LeftOut
from irc.schedule.schedule import COLUMNS, ObjectiveValue, Schedule, Status
from irc.schedule.writing import SCHEDULE_VERSION, dump_json

__all__ = [
    "ABANDONED",
    "BEGUN",
    "CANCELLED",
    "COLUMNS",
    "SCHEDULE_VERSION",
    "Entry",
    "LeftOut",
    "ObjectiveValue",
    "Schedule",
    "Status",
    "dump_json",
]
