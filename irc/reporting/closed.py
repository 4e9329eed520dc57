"""The capacity of each resource over time, and the times at which it is closed."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence

from irc.model import Resource, Task
from irc.model.quantities import Number

Interval = tuple[Number, Number]
"""A half-open interval [start, end), in the task's unit."""

Levels = tuple[tuple[Number, int], ...]
"""(From when on, level), in order of time; the last level stays."""


class ClosedTimes:
    """The closed times of a task's calendars and resources in [0, until), each found once."""

    def __init__(self, task: Task, until: Number) -> None:
        self.until = until
        self._clock = task.clock
        self._task = task
        self._known: dict[str, tuple[Interval, ...]] = {}
        self._capacity: dict[str, Levels] = {}

    def of_calendar(self, name: str | None) -> tuple[Interval, ...]:
        """The closed times of a calendar, in order; none without a calendar."""
        if name is None:
            return ()
        if name not in self._known:
            self._known[name] = tuple(self._closed(name))
        return self._known[name]

    def _closed(self, name: str) -> Iterator[Interval]:
        from irc.lowering.calendars import calendars_by_id, open_intervals

        calendar = calendars_by_id(self._task).get(name)
        if calendar is not None:
            yield from gaps(open_intervals(calendar, self._clock, self.until), self.until)

    def capacity(self, resource: Resource) -> Levels:
        """The capacity of a resource from t = 0 on: by its windows, its calendar, or its own."""
        if resource.id not in self._capacity:
            self._capacity[resource.id] = tuple(self._levels(resource))
        return self._capacity[resource.id]

    def of_resource(self, resource: Resource) -> tuple[Interval, ...]:
        """The times at which a resource has no capacity, in order."""
        levels = self.capacity(resource)
        return tuple(while_true([(time, level == 0) for time, level in levels], self.until))

    def _levels(self, resource: Resource) -> Iterator[tuple[Number, int]]:
        number = self._clock.number
        windows = sorted((number(w.from_), number(w.to), w.capacity) for w in resource.availability)
        windows = [w for w in windows if w[0] < w[1]]
        closed = self.of_calendar(resource.calendar)
        edges = {0, *(t for w in windows for t in w[:2]), *(t for span in closed for t in span)}
        begins, shut = [w[0] for w in windows], [start for start, _ in closed]
        last: int | None = None
        for time in sorted(t for t in edges if t >= 0):
            k = bisect_right(begins, time) - 1
            c = bisect_right(shut, time) - 1
            if k >= 0 and time < windows[k][1]:
                level = windows[k][2]
            else:
                level = 0 if c >= 0 and time < closed[c][1] else resource.capacity
            if level != last:
                yield time, level
            last = level


def gaps(intervals: Iterable[Interval], until: Number) -> Iterator[Interval]:
    """The times in [0, until) that are in none of some intervals, which are in order."""
    reached: Number = 0
    for start, end in intervals:
        if start >= until:
            break
        if reached < start:
            yield reached, start
        reached = max(reached, end)
    if reached < until:
        yield reached, until


def while_true(levels: Sequence[tuple[Number, bool]], until: Number) -> Iterator[Interval]:
    """The times in [0, until) at which a step function is true."""
    since: Number | None = None
    for time, value in levels:
        if time >= until:
            break
        if value and since is None:
            since = time
        elif not value and since is not None:
            yield since, time
            since = None
    if since is not None and since < until:
        yield since, until


def union(spans: Iterable[Interval]) -> list[Interval]:
    """The union of intervals, in order; those that touch are one."""
    merged: list[Interval] = []
    for start, end in sorted(spans):
        if merged and start <= merged[-1][1]:
            merged[-1] = merged[-1][0], max(merged[-1][1], end)
        elif start < end:
            merged.append((start, end))
    return merged


def within(spans: Sequence[Interval], start: Number, end: Number) -> Iterator[Interval]:
    """The parts in [start, end) of intervals that are in order and do not overlap."""
    first = max(bisect_right(spans, (start, start)) - 1, 0)
    for k in range(first, len(spans)):
        opened, closed = spans[k]
        if opened >= end:
            return
        if closed > start:
            yield max(opened, start), min(closed, end)
