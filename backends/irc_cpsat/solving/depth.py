"""The number of occurrences of a repeated action that a model needs: its depth.

A model holds a number of occurrences, so it is deepened until a schedule is found. Since
occurrences of one action do not overlap, at most makespan / duration of them fit into a schedule:
a model that holds as many leaves no better schedule out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from irc.passes.unroll import MOST_OCCURRENCES, slots
from irc.problem import Activity, Problem

FIRST_DEPTH = 1
GREATEST_DEPTH = 64
"""The depths that are tried without being asked for by a proof."""

SLOTS_LIMIT = MOST_OCCURRENCES
"""The greatest number of occurrences of repeated actions in a model."""


def depths(problem: Problem) -> Iterator[int]:
    """The depths to try, each twice the previous one; a single one where nothing repeats."""
    repeated = [a for a in problem.activities if a.details.repeats is not None]
    if not repeated:
        yield 1
        return
    depth = FIRST_DEPTH
    while depth <= GREATEST_DEPTH and _total(repeated, depth) <= SLOTS_LIMIT:
        yield depth
        if all(slots(a, depth) == slots(a, depth + 1) for a in repeated):
            return
        depth *= 2


def _total(repeated: list[Activity], depth: int) -> int:
    return sum(slots(a, depth) for a in repeated)


def enough(problem: Problem, limit: int | None) -> int | None:
    """The depth that holds every schedule that ends by `limit` (ticks), or None."""
    fitting = [_fitting(a, limit) for a in problem.activities if a.details.repeats is not None]
    known = [count for count in fitting if count is not None]
    return max([1, *known]) if len(known) == len(fitting) else None


def within(problem: Problem, limit: int) -> Problem:
    """The problem with a deadline at `limit` (ticks), and so with fewer occurrences.

    If a schedule that long is known, no shorter one is lost.
    """
    deadline = limit if problem.deadline is None else min(limit, problem.deadline)
    activities = tuple(_capped(a, deadline) for a in problem.activities)
    return replace(problem, deadline=deadline, activities=activities)


def _capped(activity: Activity, limit: int) -> Activity:
    repeats, fitting = activity.details.repeats, _fitting(activity, limit)
    if repeats is None or fitting is None:
        return activity
    greatest = max(1, repeats[0], fitting)
    return replace(activity, details=replace(activity.details, repeats=(repeats[0], greatest)))


def _fitting(activity: Activity, limit: int | None) -> int | None:
    """The number of occurrences that fit one after another before `limit`, if that is known."""
    fitting: int | None = None
    if limit is not None and activity.duration_min > 0:
        fitting = max(0, limit - activity.release) // activity.duration_min
    if activity.latest_start is not None and activity.duration_min > 0:
        starts = 1 + max(0, activity.latest_start - activity.release) // activity.duration_min
        fitting = starts if fitting is None else min(fitting, starts)
    greatest = activity.details.repeats[1] if activity.details.repeats else 1
    if greatest is None:
        return fitting
    return greatest if fitting is None else min(fitting, greatest)


def fits_a_model(problem: Problem, depth: int) -> bool:
    """Whether a model of this depth is small enough to be tried."""
    repeated = [a for a in problem.activities if a.details.repeats is not None]
    return _total(repeated, depth) <= SLOTS_LIMIT
