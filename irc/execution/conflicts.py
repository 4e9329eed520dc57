"""Relaxes conflicts that the history alone causes: they are carried, so they bind no more.

Each is relaxed only as far as the history needs. The validator finds the same conflicts when it
judges the history alone; it shares no code with this module.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from irc.execution.executed import ExecutedActivity
from irc.execution.numbers import with_bounds_carried, without_unmet_limits
from irc.execution.order_conflicts import without_broken_loads, without_broken_orders
from irc.execution.state_conflicts import without_broken_conditions
from irc.execution.stock_conflicts import with_stock_lent
from irc.lowering.elements import pool_of
from irc.problem import Activity, Arc, Problem, Renewable, Window
from irc.problem.decisions import Decision
from irc.problem.setups import setup_links
from irc.schedule import Entry


def relaxed(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int, *, hopes: bool = True
) -> tuple[Problem, bool]:
    """The problem without the demands that its executed activities break.

    With `hopes` it keeps a demand that open activities may still meet, by stock or by state, though
    the history alone will not. Returns also whether there is one.
    """
    if not executed:
        return problem, False
    problem = _without_late_deadline(problem, executed)
    problem = replace(
        problem, arcs=tuple(a for a in problem.arcs if not _is_broken(problem, a, executed))
    )
    problem = _with_room(problem, executed)
    stock = state = bounds = False
    if problem.has_setups:
        problem = _with_setups_done(problem, executed, now)
    if problem.sequences:
        problem = without_broken_orders(problem, executed)
    if problem.has_batches:
        problem = without_broken_loads(problem, executed)
    if problem.reservoirs:
        problem, stock = with_stock_lent(problem, executed, now, hopes=hopes)
    if problem.numbers:
        problem = without_unmet_limits(problem, executed, now)
        problem, bounds = with_bounds_carried(problem, executed, now, hopes=hopes)
    if problem.has_state:
        problem, state = without_broken_conditions(problem, executed, now, hopes=hopes)
    return problem, stock or state or bounds


def _without_late_deadline(problem: Problem, executed: Mapping[int, ExecutedActivity]) -> Problem:
    """Moves the task's deadline to the open activities, if a running one must end after it."""
    deadline = problem.deadline
    if deadline is None:
        return problem
    late = {i for i, past in executed.items() if _ends(problem, i, past)[0] > deadline}
    if not late:
        return problem

    def bound(i: int, activity: Activity) -> Activity:
        if i in late:
            return activity
        own = deadline if activity.deadline is None else min(deadline, activity.deadline)
        return replace(activity, deadline=own)

    activities = tuple(bound(i, a) for i, a in enumerate(problem.activities))
    return replace(problem, activities=activities, deadline=None)


def _ends(problem: Problem, i: int, past: ExecutedActivity) -> tuple[int, int]:
    """The least and the greatest time at which an executed activity can end."""
    if not past.running:
        return past.end, past.end
    activity = problem.activities[i]
    return past.start + activity.duration_min, past.start + activity.duration_max


def _is_broken(problem: Problem, arc: Arc, executed: Mapping[int, ExecutedActivity]) -> bool:
    """Whether two executed activities contradict a precedence, however long they take."""
    if arc.before not in executed or arc.after not in executed:
        return False
    before, after = executed[arc.before], executed[arc.after]
    if before.cancelled or after.cancelled:
        return True
    from_least, from_most = before.start, before.start
    to_least, to_most = after.start, after.start
    if arc.from_end:
        from_least, from_most = _ends(problem, arc.before, before)
    if arc.to_end:
        to_least, to_most = _ends(problem, arc.after, after)
    if to_most - from_least < arc.min_lag:
        return True
    return arc.max_lag is not None and to_least - from_most > arc.max_lag


def _with_setups_done(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int
) -> Problem:
    """The problem in which executed activities wait for no set-up that they did not wait for.

    Gaps that are history are none.
    """
    begun = [i for i, past in executed.items() if past.resources is not None]
    places = [Decision(executed[i].start, _ends(problem, i, executed[i])[0]) for i in begun]
    activities = [problem.activities[i] for i in begun]
    chosen = [[r for r in executed[i].resources or () if r is not None] for i in begun]
    waived: dict[int, int] = {}
    for link in setup_links(problem.resources, activities, places, chosen):
        setups = problem.resources[link.resource].setups
        start = int(places[link.after].start)
        ready = 0 if setups is None else setups.since
        ready = ready if link.before is None else int(places[link.before].end)
        ready += link.setup.time
        tight = setups is not None and setups.tight and link.before is not None
        if start < ready or (tight and start > ready):
            waived[link.resource] = max(waived.get(link.resource, 0), start + 1)
    resources = tuple(
        resource
        if resource.setups is None
        else replace(
            resource,
            setups=replace(resource.setups, waived_before=waived.get(r, 0), now=now),
        )
        for r, resource in enumerate(problem.resources)
    )
    return replace(problem, resources=resources)


# --- capacity ---


def overloaded(problem: Problem, running: Sequence[Entry]) -> set[int]:
    """The resources (indexes) of which running activities hold more than the greatest capacity."""
    held: Counter[str] = Counter()
    for entry in running:
        held.update(dict(entry.resources))
    return {
        r for r, resource in enumerate(problem.resources) if held[resource.id] > resource.capacity
    }


def _with_room(problem: Problem, executed: Mapping[int, ExecutedActivity]) -> Problem:
    """The problem in which capacities suffice, at every instant, for executed activities."""
    loads: dict[int, list[tuple[int, int]]] = {}
    for i, past in executed.items():
        activity = problem.activities[i]
        if past.resources is None or (past.mode is None and activity.details.modes):
            continue
        end = _ends(problem, i, past)[0]
        for use in activity.uses if end > past.start else ():
            load = loads.setdefault(use.alternatives[0], [])
            load += [(past.start, use.amount), (end, -use.amount)]
    changed = {
        r: windows
        for r, load in loads.items()
        if (windows := _windows(problem.resources[r], load)) is not None
    }
    if not changed:
        return problem
    resources = tuple(
        replace(r, windows=changed[k]) if k in changed else r
        for k, r in enumerate(problem.resources)
    )
    return replace(
        problem,
        resources=resources,
        # (A member of which too much is held is not pooled: `irc.passes.contention`.)
        contention=replace(
            problem.contention,
            pools=tuple(
                pool_of(resources[p.members[0]], p.members[0])
                if len(p.members) == 1 and p.members[0] in changed
                else p
                for p in problem.contention.pools
            ),
        ),
    )


def _windows(resource: Renewable, load: list[tuple[int, int]]) -> tuple[Window, ...] | None:
    """The windows of a resource with room for a load; None where the capacity suffices."""
    times = {t for t, _ in load} | {t for w in resource.windows for t in (w.start, w.end)}
    steps: dict[int, int] = {}
    for time, amount in load:
        steps[time] = steps.get(time, 0) + amount
    changes = {w.end: resource.capacity for w in resource.windows}
    changes.update((w.start, w.capacity) for w in resource.windows)
    level, there, short, pieces = 0, resource.capacity, False, []
    for start, end in pairwise(sorted(times)):
        level += steps.get(start, 0)
        there = changes.get(start, there)
        short = short or level > there
        pieces.append(Window(start, end, max(level, there)))
    if not short:
        return None
    return tuple(w for w in pieces if w.capacity != resource.capacity)
