"""Earliest and latest times where precedences alone bind activities: the critical path method.

The activities are numbered; one that follows another starts when this has ended, or later.
Everything is whole numbers in lists, so a million activities take a second or two. (Kelley and
Walker, "Critical-path planning and scheduling", 1959.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class PrecedenceTimes(NamedTuple):
    """The earliest start of each activity, and an order in which each is behind those before it."""

    starts: list[int]
    makespan: int
    order: list[int]


def earliest_times(
    durations: Sequence[int], following: Sequence[Sequence[int]]
) -> PrecedenceTimes | None:
    """The earliest times from 0 on; None where precedences form a cycle. Takes linear time.

    `following` has the activities that precedences put after each activity.
    """
    waiting = [0] * len(durations)
    for behind in following:
        for j in behind:
            waiting[j] += 1
    starts = [0] * len(durations)
    order = [i for i, count in enumerate(waiting) if not count]
    makespan = 0
    for i in order:
        end = starts[i] + durations[i]
        if end > makespan:
            makespan = end
        for j in following[i]:
            if starts[j] < end:
                starts[j] = end
            if waiting[j] == 1:
                order.append(j)
            else:
                waiting[j] -= 1
    if len(order) < len(durations):
        return None
    return PrecedenceTimes(starts, makespan, order)


def slacks_of(
    times: PrecedenceTimes, durations: Sequence[int], following: Sequence[Sequence[int]]
) -> list[int]:
    """How much later than at its earliest time each activity can start with the same makespan."""
    latest = [times.makespan] * len(durations)
    for i in reversed(times.order):
        end = times.makespan
        for j in following[i]:
            if latest[j] < end:
                end = latest[j]
        latest[i] = end - durations[i]
    return [late - start for late, start in zip(latest, times.starts, strict=True)]
