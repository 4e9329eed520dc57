"""Raises releases behind fixed activities: others cannot start before there is room for them.

A running action, a maintenance with a fixed start, a calendar: activities that need the same
resource cannot start before these free it. Heads, bounds and the grid of times all profit.
"""

from __future__ import annotations

from dataclasses import replace

from irc.passes.resource_profile import UNREACHABLE_TIME, Profile
from irc.problem import Activity, OpenDemand, Problem


def release_behind_fixed(problem: Problem) -> Problem:
    """Raises each release to the first time with room beside all fixed activities."""
    fixed = [i for i, a in enumerate(problem.activities) if a.start is not None and _is_decided(a)]
    calendars = any(pool.windows for pool in problem.contention.pools)
    if not fixed and not calendars:
        return problem
    profiles = [Profile(pool) for pool in problem.contention.pools]
    for i in fixed:
        activity = problem.activities[i]
        start = activity.start or 0
        for demand in _certain(activity):
            if len(demand.alternatives) == 1:
                end = start + activity.duration_min
                profiles[demand.alternatives[0]].take(start, end, demand.amount)
    activities = tuple(
        activity if activity.start is not None else _released(activity, profiles)
        for activity in problem.activities
    )
    return replace(problem, activities=activities)


def _is_decided(activity: Activity) -> bool:
    details = activity.details
    return activity.duration_min > 0 and not details.optional and details.repeats is None


def _certain(activity: Activity) -> list[OpenDemand]:
    """The open demands that an activity has in every mode."""
    return [c for c in activity.open_demands if activity.details.use_mode(c.use) is None]


def _released(activity: Activity, profiles: list[Profile]) -> Activity:
    if not activity.open_demands or not activity.duration_min or activity.details.work:
        return activity  # (What pauses starts in an open time that is shorter than its work.)
    demands = _certain(activity)
    start, stable = activity.release, False
    while not stable:
        stable = True
        for demand in demands:
            soonest = _soonest(demand, start, start + activity.duration_min, profiles)
            if soonest >= UNREACHABLE_TIME:
                return activity  # There is no room at all; the checks and the solver report it.
            if soonest > start:
                start, stable = soonest, False
    return activity if start == activity.release else replace(activity, release=start)


def _soonest(demand: OpenDemand, start: int, end: int, profiles: list[Profile]) -> int:
    """A time, from `start` on, before which no alternative has room."""
    soonest = UNREACHABLE_TIME
    for r in demand.alternatives:
        if demand.amount > profiles[r].capacity:
            continue
        blocked = profiles[r].blocked_until(start, end, demand.amount)
        if blocked is None:
            return start
        soonest = min(soonest, blocked)
    return soonest
