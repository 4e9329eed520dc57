"""Makes calendars of the sentences that say when a thing, or all work, is open or closed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from irc.frontends.english.statements import OpenTimes

Document = dict[str, Any]
Spans = list[tuple[int, int]]
"""The [start, end) of times of one day, in minutes since midnight, in order and apart."""

_DAYS = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")
_DAY = 24 * 60


def hours_of(thing: str | None) -> str:
    """The id of the calendar of a thing, or of all work."""
    return "working hours" if thing is None else f"{thing} hours"


def calendar(id: str, rules: Sequence[OpenTimes], *, dated: bool) -> Document:
    """A calendar by some sentences. Without a date its days begin at t = 0."""
    weekly = [rule for rule in rules if not rule.dates]
    if any(rule.closed for rule in weekly) or not weekly:
        weekly = list(_apart(weekly))
    off = [date for rule in rules for date in rule.dates]
    closed = {"closed": off} if off else {}
    if dated:
        times = [
            {**({"days": list(o.days)} if o.days else {}), "from": o.begin, "to": o.end}
            for o in weekly
        ]
        return {"id": id, "open": times, **closed}
    cycle = [{"from": _since_midnight(o.begin), "to": _since_midnight(o.end)} for o in weekly]
    return {"id": id, "every": "1 day", "open": cycle}


def _apart(rules: Sequence[OpenTimes]) -> Iterator[OpenTimes]:
    """The times that are open by all rules together, as rules of what is open."""
    opened = [rule for rule in rules if not rule.closed]
    table = _table(opened) if opened else {day: [(0, _DAY)] for day in _DAYS}
    closed = _table([rule for rule in rules if rule.closed])
    left = {day: list(_without(table[day], closed[day])) for day in _DAYS}
    for spans in {tuple(spans): None for spans in left.values()}:
        days = tuple(day for day in _DAYS if tuple(left[day]) == spans)
        for begin, end in spans:
            yield OpenTimes(None, _clock(begin), _clock(end), () if days == _DAYS else days)


def _table(rules: Sequence[OpenTimes]) -> dict[str, Spans]:
    """The times of each day; what runs over midnight belongs to two days."""
    table: dict[str, Spans] = {day: [] for day in _DAYS}
    for rule in rules:
        begin, end = _minutes(rule.begin), _minutes(rule.end)
        for k, day in enumerate(_DAYS):
            if rule.days and day not in rule.days:
                continue
            table[day].append((begin, end if end > begin else _DAY))
            if end <= begin and end > 0:
                table[_DAYS[(k + 1) % len(_DAYS)]].append((0, end))
    return {day: _merged(spans) for day, spans in table.items()}


def _merged(spans: Spans) -> Spans:
    found: Spans = []
    for begin, end in sorted(spans):
        if found and begin <= found[-1][1]:
            found[-1] = found[-1][0], max(end, found[-1][1])
        else:
            found.append((begin, end))
    return found


def _without(opened: Spans, closed: Spans) -> Iterator[tuple[int, int]]:
    for begin, end in opened:
        at = begin
        for shut, again in closed:
            if at < shut < end:
                yield at, shut
            if shut < end and again > at:
                at = again
        if at < end:
            yield at, end


def _minutes(clock: str) -> int:
    hours, minutes = (int(part) for part in clock.split(":"))
    return 60 * hours + minutes


def _clock(minutes: int) -> str:
    return f"{minutes // 60:02}:{minutes % 60:02}"


def _since_midnight(clock: str) -> str:
    hours, minutes = divmod(_minutes(clock), 60)
    return f"{hours} h {minutes} min" if minutes else f"{hours} h"
