"""An upper bound on the end of some optimal schedule: the horizon."""

from __future__ import annotations

from dataclasses import replace

from irc.problem.activity import Activity
from irc.problem.contention import ContendedPool
from irc.problem.problem import Arc, Problem
from irc.problem.resources import Renewable, Window


def safe_horizon(problem: Problem) -> int:
    """The horizon in ticks, from durations, lags, releases, fixed starts and windows.

    Fix the choices and the order on every resource as some optimal schedule has them. The least
    solution of the resulting temporal network is optimal too, and in it every time is the floor
    of one activity plus the length of a simple path, which leaves each point at most once, over
    an edge no longer than the longest that leaves it. Summing those over all points is enough.
    A set-up leaves the end of the use before it, or is a floor.
    An activity that keeps to one side of a window's boundary has that boundary as its floor. Orders
    on state and stock are edges of length 0 (or of a tick, where ranks cannot separate them). An
    activity that stays where the previous plan has it has its start as its floor.
    """
    floor = max((w.end for r in problem.resources for w in r.windows), default=0)
    setups = [0 if r.setups is None else r.setups.longest for r in problem.resources]
    for resource, longest_setup in zip(problem.resources, setups, strict=True):
        if resource.setups is not None and resource.setups.initial is not None:
            floor = max(floor, resource.setups.since + longest_setup)
    floor = max((floor, *(c.times[-1][1] for c in problem.calendars if c.times)))
    # A start waits for a timed change, and an end may have to come a tick after one.
    floor = max((floor, *(c.at + 1 for c in problem.timed_changes)))
    for places in (problem.previous.places, *problem.previous.recurring.values()):
        floor = max((floor, *(place.start for place in places if place is not None)))
    from_start = [0] * len(problem.activities)
    from_end = [0] * len(problem.activities)
    total = 0
    for activity in problem.activities:
        floor = max(floor, activity.release, activity.start or 0, activity.earliest_end or 0)
        if activity.details.touches_world:
            total += 2
        # A range longer than the task's deadline can never be used up.
        longest = activity.duration_max
        if problem.deadline is not None:
            longest = max(activity.duration_min, min(longest, problem.deadline))
        total += longest
        total += max((setups[r] for use in activity.uses for r in use.alternatives), default=0)
    for arc in problem.arcs:
        leaving = from_end if arc.from_end else from_start
        leaving[arc.before] = max(leaving[arc.before], arc.min_lag)
        if arc.max_lag is not None and arc.max_lag < 0:
            back = from_end if arc.to_end else from_start
            back[arc.after] = max(back[arc.after], -arc.max_lag)
    if not problem.is_regular:
        # An end may wait for its due date, and others for it, forward and back along the lags.
        dues = [a.details.due for a in problem.activities] + [g.due for g in problem.groups]
        floor = max([floor, *(due for due in dues if due is not None)])
        total += sum(abs(arc.min_lag) + abs(arc.max_lag or 0) for arc in problem.arcs)
    horizon = floor + total + sum(from_start) + sum(from_end)
    known = (t for t in (problem.deadline, problem.horizon) if t is not None)
    return min((horizon, *known))


def within(problem: Problem, horizon: int) -> Problem:
    """The same problem for all schedules that end by `horizon`, with no time far beyond it.

    A later time means the same as the first tick after the horizon: an activity that must wait for
    it, or last as long, cannot be present, and a limit at it never binds. So numbers stay small,
    however large the numbers of the task are, if a deadline limits the schedule.
    """
    never = horizon + 1
    last_due = never if problem.is_regular else None
    return replace(
        problem,
        activities=tuple(_activity_within(a, never, last_due) for a in problem.activities),
        resources=tuple(_resource_within(r, never) for r in problem.resources),
        contention=replace(
            problem.contention,
            pools=tuple(
                _pool_within(p, never) if p.windows else p for p in problem.contention.pools
            ),
        ),
        arcs=tuple(_arc_within(arc, never) for arc in problem.arcs),
        groups=tuple(
            g
            if g.due is None or last_due is None or g.due <= last_due
            else replace(g, due=last_due)
            for g in problem.groups
        ),
        bounds=replace(
            problem.bounds,
            heads=tuple(min(head, never) for head in problem.bounds.heads),
            tails=tuple(min(tail, never) for tail in problem.bounds.tails),
        ),
    )


def _activity_within(activity: Activity, never: int, last_due: int | None) -> Activity:
    details = activity.details
    times = activity.duration_max, activity.release, activity.start or 0, details.due or 0
    if max(*times, activity.earliest_end or 0) <= never:
        return activity
    return replace(
        activity,
        duration_min=min(activity.duration_min, never),
        duration_max=min(activity.duration_max, never),
        release=min(activity.release, never),
        start=None if activity.start is None else min(activity.start, never),
        earliest_end=None if activity.earliest_end is None else min(activity.earliest_end, never),
        details=replace(
            details,
            due=details.due
            if last_due is None or details.due is None
            else min(details.due, last_due),
            modes=tuple(
                m._replace(
                    duration_min=min(m.duration_min, never), duration_max=min(m.duration_max, never)
                )
                for m in details.modes
            ),
        ),
    )


def _resource_within(resource: Renewable, never: int) -> Renewable:
    setups = resource.setups
    if setups is None or setups.longest <= never:
        return resource
    table = {k: s._replace(time=min(s.time, never)) for k, s in setups.table.items()}
    return replace(resource, setups=replace(setups, table=table))


def _pool_within(pool: ContendedPool, never: int) -> ContendedPool:
    windows = (
        Window(w.start, min(w.end, never), w.capacity) for w in pool.windows if w.start < never
    )
    return replace(pool, windows=tuple(windows))


def _arc_within(arc: Arc, never: int) -> Arc:
    if -never <= arc.min_lag <= never and (arc.max_lag is None or -never <= arc.max_lag <= never):
        return arc
    return arc._replace(
        min_lag=max(-never, min(arc.min_lag, never)),
        max_lag=None if arc.max_lag is None or arc.max_lag > never else max(-never, arc.max_lag),
    )
