"""The open times of an activity as it is carried out, and where its work goes on among them.

Closed are the times at which a resource that it holds has no capacity, or at which the calendar of
the activity is closed. The working time before an instant grows with it, so that the end of an
activity that pauses is a function of its start, constant in its pause between a few breakpoints.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator
from itertools import accumulate
from typing import NamedTuple

from irc.problem.activity import Activity
from irc.problem.intervals import intersection
from irc.problem.problem import Problem

FOREVER = 1 << 62
"""Later than any time that 64 bits hold."""

Interval = tuple[int, int]
"""A half-open interval [start, end) in ticks."""


class Piece(NamedTuple):
    """Starts `first` to `last` (both included) at which an activity pauses for the same time."""

    first: int
    last: int
    pause: int


class WorkTimes:
    """Open intervals in order, which do not touch, and the working time before each."""

    def __init__(self, intervals: Iterable[Interval]) -> None:
        self.intervals = tuple(intervals)
        self.starts = [start for start, _ in self.intervals]
        self.ends = [end for _, end in self.intervals]
        lengths = (end - start for start, end in self.intervals)
        self.before = list(accumulate(lengths, initial=0))

    @property
    def always(self) -> bool:
        """Whether there are no closed times."""
        return self.intervals == ((0, FOREVER),)

    def place(self, time: int) -> int | None:
        """The index of the interval that holds a time; None at a closed time."""
        k = bisect_right(self.starts, time) - 1
        return k if k >= 0 and time < self.ends[k] else None

    def work_before(self, time: int) -> int:
        """The working time before a time."""
        k = bisect_right(self.starts, time) - 1
        if k < 0:
            return 0
        return self.before[k] + min(time, self.ends[k]) - self.starts[k]

    def start_from(self, time: int) -> int | None:
        """The first open time at a time or after it; None where there is none."""
        k = bisect_right(self.ends, time)
        return None if k == len(self.ends) else max(time, self.starts[k])

    def end_after(self, work: int) -> int | None:
        """The first time before which there is this working time (at least 1)."""
        k = bisect_left(self.before, work) - 1
        return None if k >= len(self.starts) else self.starts[k] + work - self.before[k]

    def end(self, start: int, work: int) -> int | None:
        """The end of work that starts at an open time."""
        return self.end_after(self.work_before(start) + work) if work else start

    def last_start(self, work_before: int) -> int:
        """The last open time with this working time before it, the first one if none is."""
        work_before = max(0, work_before)
        k = min(bisect_right(self.before, work_before), len(self.starts)) - 1
        return self.starts[k] + work_before - self.before[k]

    def next_end(self, time: int) -> int | None:
        """The first time at or after a time at which work may end: open, or where a closed one
        begins.
        """
        k = bisect_left(self.ends, time)
        return None if k == len(self.ends) else max(time, self.starts[k] + 1)

    def pieces(self, work: int, until: int = FOREVER) -> Iterator[Piece]:
        """The starts of some work, in order, with the pause that follows from each.

        Ends behind `until` are left out.
        """
        for k, (opened, closed) in enumerate(self.intervals):
            start = opened
            while start < closed:
                end = self.end(start, work)
                if end is None or end > until:
                    return
                j = bisect_left(self.ends, end) if work else k
                # The pause stays while the end remains in its interval.
                last = min(closed - 1, start + min(self.ends[j], until) - end)
                yield Piece(start, last, end - start - work)
                start = last + 1


class WorkTimesOf:
    """The work times of the activities of a problem, each made once."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self._of: dict[tuple[int | None, frozenset[int]], WorkTimes] = {}

    def of(self, activity: Activity, resources: Iterable[int]) -> WorkTimes:
        """The work times of an activity that holds these resources (indexes)."""
        windowed = frozenset(r for r in resources if self.problem.resources[r].windows)
        key = activity.details.calendar, windowed
        if key not in self._of:
            self._of[key] = self._made(*key)
        return self._of[key]

    def of_calendar(self, activity: Activity) -> WorkTimes:
        """The work times by the calendar of an activity alone."""
        return self.of(activity, ())

    def _made(self, calendar: int | None, resources: frozenset[int]) -> WorkTimes:
        found: list[Interval] = [(0, FOREVER)]
        if calendar is not None:
            found = list(self.problem.calendars[calendar].times)
        for r in sorted(resources):
            times = self.problem.resources[r].open_times(1)
            opened = [(start, FOREVER if end is None else end) for start, end in times]
            found = list(intersection(found, opened))
        return WorkTimes(found)


def work_range(activity: Activity, mode: int | None) -> tuple[int, int]:
    """The least and greatest working time in a mode (index), in ticks."""
    if activity.details.work:
        return activity.details.work[mode or 0]
    if mode is not None:
        chosen = activity.details.modes[mode]
        return chosen.duration_min, chosen.duration_max
    return activity.duration_min, activity.duration_max
