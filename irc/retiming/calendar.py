"""Calendars in re-timing: no holder of a resource moves out of its segment of the calendar.

**Why a floor at the start is enough.** The boundaries (starts and ends of windows) cut time into
segments of one capacity each. Let X be the activities that hold a resource at an instant x of the
new schedule. They overlap in pairs, so they did in the old one, for whatever did not overlap there
keeps its order; intervals that overlap in pairs have an instant in common (Helly), here the latest
old start s among X, of activity j, say. So the old schedule had room for all of X at s. Now j
starts at or before x, and no earlier than the segment of s begins. If x lies in the segment of s,
it has the same capacity. If x lies in a later one, then s < x, so all of X had started in the old
schedule by x; and as nothing ends later in the new one than in the old, none had ended: the old
schedule had room for X at x itself. An earlier segment is impossible.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from fractions import Fraction

from irc.problem import Problem, Renewable
from irc.problem.decisions import Decision

FOREVER = 1 << 62
"""Later than any time that 64 bits hold."""


def calendar_load(resource: Renewable) -> tuple[int, list[tuple[int, int, int]]]:
    """The greatest capacity, and the units that windows take away (from, until, units)."""
    greatest = resource.greatest_capacity()
    load: list[tuple[int, int, int]] = []
    last = -FOREVER
    for start, end, capacity in resource.windows:
        load += [(last, start, greatest - resource.capacity), (start, end, greatest - capacity)]
        last = end
    load.append((last, FOREVER, greatest - resource.capacity))
    return greatest, [part for part in load if part[2] and part[0] < part[1]]


def raise_floors(
    problem: Problem,
    decisions: Sequence[Decision],
    chosen: Sequence[tuple[int, ...]],
    starts: Sequence[int],
    floors: list[int],
    tolerance: Fraction | int,
) -> None:
    """Keeps each holder of a resource with windows at or after its segment's beginning.

    `starts[i]` is the point of activity i's start. An activity of no duration holds nothing.
    """
    boundaries = {
        r: sorted({time for w in resource.windows for time in (w.start, w.end)})
        for r, resource in enumerate(problem.resources)
        if resource.windows
    }
    if not boundaries:
        return
    for i, resources in enumerate(chosen):
        start, end = decisions[i].start, decisions[i].end
        for r in resources if end - start > tolerance else ():
            if r in boundaries:
                place = bisect_right(boundaries[r], start + tolerance)
                if place:
                    floors[starts[i]] = max(floors[starts[i]], boundaries[r][place - 1])
