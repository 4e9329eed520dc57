"""A horizon by which some optimal schedule has ended, if there is any schedule."""

from __future__ import annotations

from irc.problem import Problem


def safe_horizon(problem: Problem) -> int:
    """In ticks; counts durations, lags (maximum ones too), releases, fixed starts and windows.

    Fix the choices and the order on every resource as some optimal schedule has them. The least
    solution of the resulting temporal network is optimal too, and in it every time is the floor
    of one activity plus the length of a simple path, which leaves each point at most once, over
    an edge no longer than the longest that leaves it. Summing those over all points is enough.
    What keeps to a window's side of a boundary has that boundary as its floor. Orders on state and
    stock are edges of length 0 (a tick is allowed for each, should ranks not tell them apart).
    """
    floor = max((w.end for r in problem.resources for w in r.windows), default=0)
    from_start = [0] * len(problem.activities)
    from_end = [0] * len(problem.activities)
    total = 0
    for activity in problem.activities:
        floor = max(floor, activity.release, activity.start or 0)
        if activity.details.stock or activity.details.conditions or activity.details.effects:
            total += 2
        # A range longer than the task's deadline can never be used up.
        longest = activity.duration_max
        if problem.deadline is not None:
            longest = max(activity.duration_min, min(longest, problem.deadline))
        total += longest
    for arc in problem.arcs:
        leaving = from_end if arc.from_end else from_start
        leaving[arc.before] = max(leaving[arc.before], arc.min_lag)
        if arc.max_lag is not None and arc.max_lag < 0:
            back = from_end if arc.to_end else from_start
            back[arc.after] = max(back[arc.after], -arc.max_lag)
    horizon = floor + total + sum(from_start) + sum(from_end)
    return horizon if problem.deadline is None else min(horizon, problem.deadline)
