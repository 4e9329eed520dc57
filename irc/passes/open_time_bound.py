"""A bound on the makespan from open times: earliest ends over calendars, and work that must fit.

Both hold for every schedule: an end is no earlier than its work allows from the earliest start on,
and the work on a resource that cannot start before a time takes at least as much of its open time
from then on, and then the least tail follows.
"""

from __future__ import annotations

from collections.abc import Sequence

from irc.problem import Activity, Problem
from irc.problem.work_times import WorkTimes, WorkTimesOf, work_range

ROUNDS = 50
"""At most this many rounds over all arcs; fewer rounds give a weaker bound."""


def open_time_bound(problem: Problem) -> Problem:
    """Raises the bound by open times; the problem itself where it has none."""
    if not problem.has_calendars or not problem.bounds.heads:
        return problem
    times = WorkTimesOf(problem)
    heads, ends = _earliest(problem, times)
    latest, who = max(
        ((end, i) for i, end in enumerate(ends) if _is_certain(problem.activities[i])),
        default=(0, 0),
    )
    if latest > problem.bounds.makespan.value:
        name = problem.activities[who].id
        problem = problem.with_bound(latest, f"{name!r} ends no earlier, by its open times")
    for r, pool in enumerate(problem.contention.pools):
        if len(pool.members) == 1:
            problem = _by_work(problem, r, heads, times)
    return problem


def _is_certain(activity: Activity) -> bool:
    return not activity.details.optional and activity.details.repeats is None


def _earliest(problem: Problem, times: WorkTimesOf) -> tuple[list[int], list[int]]:
    """The earliest start and end of each activity by precedence and open times."""
    heads = list(problem.bounds.heads)
    ends = [_end(problem, times, i, heads) for i in range(len(heads))]
    certain = [_is_certain(activity) for activity in problem.activities]
    arcs = [a for a in problem.arcs if not a.to_end and certain[a.before] and certain[a.after]]
    for _ in range(ROUNDS):
        changed = False
        for arc in sorted(arcs, key=lambda a: heads[a.before]):
            since = (ends if arc.from_end else heads)[arc.before] + arc.min_lag
            if since > heads[arc.after]:
                heads[arc.after] = since
                ends[arc.after] = _end(problem, times, arc.after, heads)
                changed = True
        if not changed:
            break
    return heads, ends


def _end(problem: Problem, times: WorkTimesOf, i: int, heads: list[int]) -> int:
    """The earliest end from the head on, which it moves to the first open start."""
    activity = problem.activities[i]
    if activity.details.modes or activity.start is not None:
        return heads[i] + activity.duration_min
    taken = [d.alternatives[0] for d in activity.open_demands if len(d.alternatives) == 1]
    members = [problem.contention.pools[r].members for r in taken]
    single = [own[0] for own in members if len(own) == 1]
    own = times.of(activity, single)
    work = work_range(activity, None)[0]
    if own.always or (not work and single):
        return heads[i] + activity.duration_min
    start = own.start_from(heads[i])
    while start is not None:
        end = own.end(start, work)
        place = own.place(start)
        if end is None or place is None:
            break
        if activity.details.work or end <= own.ends[place]:
            heads[i] = start
            return end
        start = own.start_from(own.ends[place])
    return heads[i] + activity.duration_min


def _by_work(problem: Problem, r: int, heads: Sequence[int], times: WorkTimesOf) -> Problem:
    """Raises the bound by the work on one resource."""
    pool = problem.contention.pools[r]
    if not pool.windows or not pool.capacity:
        return problem
    users = sorted(
        (
            (heads[i], problem.bounds.tails[i], work_range(a, None)[0] * d.amount)
            for i, a in enumerate(problem.activities)
            if _is_certain(a) and not a.details.modes and a.start is None
            for d in a.open_demands
            if d.alternatives == (r,)
        ),
        reverse=True,
    )
    opened = WorkTimes(
        (start, (1 << 62) if end is None else end)
        for start, end in problem.resources[pool.members[0]].open_times(1)
    )
    best, work, tail = problem.bounds.makespan.value, 0, None
    for head, own_tail, amount in users:
        work += amount
        tail = own_tail if tail is None else min(tail, own_tail)
        end = opened.end_after(opened.work_before(head) + -(-work // pool.capacity)) if work else 0
        if end is not None and end + tail > best:
            best = end + tail
    if best == problem.bounds.makespan.value:
        return problem
    return problem.with_bound(best, f"the work on {pool.id!r} and its open times")
