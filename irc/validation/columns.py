"""Judges the schedule of a task that is kept as columns, in a few passes that run in C.

It decides only that a schedule is valid. Where it is not sure, the rules are checked one by one, on
the actions themselves, and say what is wrong.
"""

from __future__ import annotations

from collections.abc import Mapping
from operator import attrgetter, le, sub

from irc.model.columns import Columns
from irc.model.quantities import Number
from irc.schedule import Entry, Schedule

_UNUSED: Mapping[str, object] = {
    "mode": None,
    "occurrence": 1,
    "rank": 0,
    "end_rank": None,
    "status": None,
    "paused": 0,
}
"""The other fields of an entry that only says when its action starts and ends."""


def values_if_valid(columns: Columns, schedule: Schedule) -> dict[str, Number] | None:
    """The objective values of a schedule that breaks no rule; None where it may break one."""
    entries = schedule.entries
    ids, starts, ends = (list(map(attrgetter(name), entries)) for name in ("id", "start", "end"))
    if {*map(type, starts), *map(type, ends)} != {int} or not _only_times(entries):
        return None
    place = dict(zip(ids, range(len(ids)), strict=True))
    order = list(map(place.get, columns.ids))
    if len(entries) != len(columns.ids) or len(place) < len(ids) or None in order:
        return None
    first, last = ([times[k] for k in order if k is not None] for times in (starts, ends))
    if min(first) < 0 or list(map(sub, last, first)) != columns.durations:
        return None
    ended, started = map(last.__getitem__, columns.before), map(first.__getitem__, columns.after)
    if not all(map(le, ended, started)):
        return None
    values: dict[str, Number] = {"makespan": max(last), "tardiness": 0, "reward": 0, "cost": 0}
    return values if _true(schedule, values) else None


def _only_times(entries: tuple[Entry, ...]) -> bool:
    unused = set(map(attrgetter(*_UNUSED), entries))
    return unused == {tuple(_UNUSED.values())} and not any(map(attrgetter("resources"), entries))


def _true(schedule: Schedule, values: Mapping[str, Number]) -> bool:
    """Whether the stated values are true, and their bounds are these values."""
    return all(
        stated.name == "makespan" and stated.value == values["makespan"] == stated.bound
        for stated in schedule.objective
    )
