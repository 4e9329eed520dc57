"""Problems near a known schedule: most activities keep their order, a few are free.

A planner that loses its way among all orders of a task finds a shorter plan among those that
differ from a good one in a few places (large neighbourhood search; Shaw, "Using constraint
programming and local search methods to solve vehicle routing problems", 1998). Its plans are plans
of the whole problem, because only restrictions are added.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from dataclasses import replace

from irc.passes.serial_sgs import Choice
from irc.problem import Activity, Arc, Problem
from irc.problem.choices import decision_of, pools_taken
from irc.problem.decisions import Decision
from irc.schedule import Schedule

Places = Mapping[int, tuple[Decision, Choice]]
"""The places of activities (by index) in a schedule: times, and the pool of each open demand."""

LEAST_FREE = 6
"""The least number of free activities."""


def makespan_of(places: Places) -> int:
    """The latest end of the places, in ticks."""
    return max((int(decision.end) for decision, _ in places.values()), default=0)


def places_in(problem: Problem, schedule: Schedule) -> Places:
    """The places of the activities that are in a schedule exactly once."""
    index = {activity.id: i for i, activity in enumerate(problem.activities)}
    places: dict[int, tuple[Decision, Choice]] = {}
    for entry in schedule.entries:
        i = index.get(entry.id)
        if i is None or problem.activities[i].details.repeats is not None:
            continue
        activity = problem.activities[i]
        decision = decision_of(problem, activity, entry)
        places[i] = decision, pools_taken(problem, activity, decision)
    return places


def near(problem: Problem, known: Places, free: frozenset[int]) -> Problem:
    """The problem in which all known activities but the free ones keep resources and order.

    A pool that only such activities use is never overfull then, so that none of it is asked for:
    activities that hold it at one time overlap in pairs, so they did before, and intervals that
    overlap in pairs have a time in common (Helly), at which there was room for all of them.
    """
    fixed = {i: place for i, place in known.items() if i not in free}
    fixed_pools = _fixed_pools(problem, fixed)
    arcs = {(a, b) for users in _users(problem, fixed).values() for a, b in _orders(users, fixed)}
    held = {(a.before, a.after) for a in problem.arcs if a.from_end and not a.to_end}
    return replace(
        problem,
        activities=tuple(
            _with_choice(a, fixed[i][1], fixed_pools) if i in fixed and not a.details.modes else a
            for i, a in enumerate(problem.activities)
        ),
        arcs=(*problem.arcs, *(Arc(a, b, origin=-1) for a, b in sorted(arcs - held))),
    )


def _users(problem: Problem, fixed: Places) -> dict[int, list[int]]:
    """The activities that hold each pool for a while, in order of start."""
    users: dict[int, list[int]] = {}
    for i in sorted(fixed, key=lambda i: (fixed[i][0].start, fixed[i][0].end, i)):
        decision, choice = fixed[i]
        if decision.end > decision.start:
            for r in dict.fromkeys(_pools_held(problem.activities[i], decision, choice)):
                users.setdefault(r, []).append(i)
    return users


def _pools_held(activity: Activity, decision: Decision, choice: Choice) -> Iterator[int]:
    """The pools of those demands that the activity has in the mode decided."""
    for demand, pool in zip(activity.open_demands, choice, strict=True):
        if activity.details.use_mode(demand.use) in (None, decision.mode):
            yield pool


def _orders(users: list[int], fixed: Places) -> Iterator[tuple[int, int]]:
    """Pairs of which the first ends before the second starts, without those that follow."""
    for k, j in enumerate(users):
        start = fixed[j][0].start
        ended = [i for i in users[:k] if fixed[i][0].end <= start]
        if ended:
            latest = max(fixed[i][0].start for i in ended)
            yield from ((i, j) for i in ended if fixed[i][0].end > latest)


def _fixed_pools(problem: Problem, fixed: Places) -> set[int]:
    """The pools of constant capacity, without set-ups, of which fixed activities are all users."""
    fixed_pools = {
        r
        for r, pool in enumerate(problem.contention.pools)
        if not (pool.windows or any(problem.resources[k].is_ordered for k in pool.members))
    }
    for i, activity in enumerate(problem.activities):
        kept = i in fixed and fixed[i][0].end > fixed[i][0].start and not activity.details.modes
        for demand in activity.open_demands:
            if not kept or len(demand.alternatives) > 1:
                fixed_pools -= set(demand.alternatives)
    return fixed_pools


def _with_choice(activity: Activity, choice: Choice, fixed_pools: set[int]) -> Activity:
    return replace(
        activity,
        open_demands=tuple(
            demand._replace(alternatives=(r,))
            for demand, r in zip(activity.open_demands, choice, strict=True)
            if r not in fixed_pools
        ),
    )


def neighbourhoods(known: Places, rng: random.Random) -> Iterator[frozenset[int]]:
    """Sets of activities to free: all that run in a stretch of time, or any.

    The sets grow from round to round, until nothing would be left that keeps its order.
    """
    order = sorted(known, key=lambda i: (known[i][0].start, i))
    size = min(len(order), LEAST_FREE)
    while size < len(order):
        firsts = list(range(0, max(1, len(order) - size + 1), max(1, size // 2)))
        rng.shuffle(firsts)
        for first in firsts:
            yield frozenset(order[first : first + size])
            yield frozenset(rng.sample(order, size))
        size += 2
