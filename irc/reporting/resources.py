"""The rows of resources and of days: how their time is spent."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from irc.model import Resource, Task
from irc.model.dates import Dates
from irc.model.quantities import Number
from irc.reporting.closed import Levels, union, within
from irc.reporting.reasons import exact_of, level_at
from irc.reporting.rows import DayRow, Load, OrderRow, ResourceRow, SetupRow
from irc.schedule import Entry

MOST_DAYS = 4000
"""A schedule of more days has no rows of days."""


@dataclass(frozen=True, slots=True)
class _Piece:
    """A time in which a resource has one load and one capacity."""

    start: Number
    end: Number
    load: int
    capacity: int


def resource_rows(
    task: Task,
    entries: Sequence[Entry],
    loads: Iterable[Load],
    setups: Sequence[SetupRow],
    span: Number,
) -> Iterator[ResourceRow]:
    """A row for each renewable resource, from t = 0 to `span`."""
    resources = {resource.id: resource for resource in task.resources}
    held = Counter(name for e in entries if e.start < e.end for name in e.resources)
    own: dict[str, list[SetupRow]] = {}
    for setup in setups:
        own.setdefault(setup.resource, []).append(setup)
    for load in loads:
        name = load.resource
        yield _row(resources[name], held[name], load, own.get(name, ()), span)


def _row(
    resource: Resource, actions: int, load: Load, setups: Sequence[SetupRow], span: Number
) -> ResourceRow:
    drawn = union((max(0, s.start), s.end) for s in setups)
    closed: Number = 0
    busy: Number = 0
    setup: Number = 0
    used: Number = 0
    available: Number = 0
    for piece in _pieces(load.load, load.capacity, 0, span):
        length = piece.end - piece.start
        if not piece.capacity:
            closed += length
            continue
        available += piece.capacity * length
        used += piece.load * length
        if piece.load:
            busy += length
        else:
            setup += sum(end - start for start, end in within(drawn, piece.start, piece.end))
    return ResourceRow(
        resource=resource.id,
        label=resource.label or resource.id,
        capacity=resource.capacity,
        actions=actions,
        busy=exact_of(busy),
        setup=exact_of(setup),
        idle=exact_of(span - closed - busy - setup),
        closed=exact_of(closed),
        used=exact_of(used),
        utilisation=Fraction(used) / Fraction(available) if available else None,
        setups=len(setups),
        setup_cost=sum(s.cost for s in setups),
    )


def _pieces(load: Levels, capacity: Levels, start: Number, end: Number) -> Iterator[_Piece]:
    """The times in [start, end) between changes of the load and of the capacity."""
    edges = {start, end}
    for levels in (load, capacity):
        k = bisect_left(levels, start, key=lambda step: step[0])
        while k < len(levels) and levels[k][0] < end:
            edges.add(levels[k][0])
            k += 1
    for since, until in pairwise(sorted(edges)):
        yield _Piece(since, until, level_at(load, since), level_at(capacity, since))


def day_rows(
    dates: Dates | None,
    entries: Sequence[Entry],
    loads: Sequence[Load],
    orders: Sequence[OrderRow],
    span: Number,
) -> Iterator[DayRow]:
    """A row for each day from t = 0 to the makespan; none without dates."""
    if dates is None or not dates.reach(span) or dates.unit * Fraction(span) > MOST_DAYS * 86_400:
        return
    starts, ends = sorted(e.start for e in entries), sorted(e.end for e in entries)
    dues = sorted(o.due for o in orders if o.due is not None)
    lates = sorted(o.due for o in orders if o.due is not None and o.tardiness)
    since: Number = 0
    day = dates.at(0).replace(hour=0, minute=0, second=0, microsecond=0, fold=0)
    while since < span or not since:
        following, midnight = dates.midnight_after(since)
        until = min(following, span)
        last = until == span
        yield DayRow(
            day=day,
            start=since,
            end=until,
            begun=_number(starts, since, following, last=False),
            ended=_number(ends, since, following, last=last),
            due=_number(dues, since, following, last=False),
            late=_number(lates, since, following, last=False),
            used={load.resource: _used(load, since, until) for load in loads},
        )
        if following >= span:
            return
        since, day = following, midnight


def _number(times: Sequence[Number], start: Number, end: Number, *, last: bool) -> int:
    """How many of some times, in order, are in [start, end); the last day has its end, too."""
    upper = end + 1 if last else end
    return bisect_left(times, upper) - bisect_left(times, start)


def _used(load: Load, start: Number, end: Number) -> Number:
    pieces = _pieces(load.load, load.capacity, start, end)
    used = sum(p.load * (p.end - p.start) for p in pieces if p.capacity)
    return exact_of(used)
