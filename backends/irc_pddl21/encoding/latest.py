"""The time by which each activity has ended in every schedule."""

from __future__ import annotations

from irc.problem import Problem
from irc.problem.work_times import FOREVER


def latest_ends(problem: Problem) -> list[int]:
    """An upper bound on each activity's end, by deadlines and minimum lags; `FOREVER`: none."""
    deadlines = [problem.effective_deadline(i) for i in range(len(problem.activities))]
    latest = [FOREVER if deadline is None else deadline for deadline in deadlines]
    for _ in problem.activities:
        changed = False
        for arc in problem.arcs:
            after = problem.activities[arc.after]
            if after.details.optional or not arc.from_end or latest[arc.after] == FOREVER:
                continue
            point = latest[arc.after] - (0 if arc.to_end else after.duration_min) - arc.min_lag
            if point < latest[arc.before]:
                latest[arc.before] = point
                changed = True
        if not changed:
            break
    return latest
