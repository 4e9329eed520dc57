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

from irc.list_schedule import Choice
from irc.problem import Activity, Arc, Problem
from irc.retime import Decision
from irc.schedule import Schedule

Places = Mapping[int, tuple[Decision, Choice]]
"""The places of activities (by index) in a schedule: times, and the resource of each claim."""

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
        decision = Decision(
            int(entry.start / problem.tick), int(entry.end / problem.tick), mode=None
        )
        places[i] = decision, _choice(problem, activity, entry.resources)
    return places


def _choice(problem: Problem, activity: Activity, held: Mapping[str, int]) -> Choice:
    """The first of each claim's alternatives of which the schedule holds a member."""
    return tuple(
        next(
            (
                r
                for r in claim.alternatives
                if any(problem.resources[m].id in held for m in problem.shared[r].members)
            ),
            claim.alternatives[0],
        )
        for claim in activity.claims
    )


def near(problem: Problem, known: Places, free: frozenset[int]) -> Problem:
    """The problem in which all known activities but the free ones keep resources and order."""
    fixed = {i: place for i, place in known.items() if i not in free}
    arcs = {(a, b) for users in _users(problem, fixed).values() for a, b in _orders(users, fixed)}
    held = {(a.before, a.after) for a in problem.arcs if a.from_end and not a.to_end}
    return replace(
        problem,
        activities=tuple(
            _with_choice(a, fixed[i][1]) if i in fixed and not a.details.modes else a
            for i, a in enumerate(problem.activities)
        ),
        arcs=(*problem.arcs, *(Arc(a, b, origin=-1) for a, b in sorted(arcs - held))),
    )


def _users(problem: Problem, fixed: Places) -> dict[int, list[int]]:
    """The activities that hold each shared resource for a while, in order of start."""
    users: dict[int, list[int]] = {}
    for i in sorted(fixed, key=lambda i: (fixed[i][0].start, fixed[i][0].end, i)):
        decision, choice = fixed[i]
        if decision.end > decision.start:
            for r in dict.fromkeys(choice):
                users.setdefault(r, []).append(i)
    return users


def _orders(users: list[int], fixed: Places) -> Iterator[tuple[int, int]]:
    """Pairs of which the first ends before the second starts, without those that follow."""
    for k, j in enumerate(users):
        start = fixed[j][0].start
        ended = [i for i in users[:k] if fixed[i][0].end <= start]
        if ended:
            latest = max(fixed[i][0].start for i in ended)
            yield from ((i, j) for i in ended if fixed[i][0].end > latest)


def _with_choice(activity: Activity, choice: Choice) -> Activity:
    return replace(
        activity,
        claims=tuple(
            claim._replace(alternatives=(r,))
            for claim, r in zip(activity.claims, choice, strict=True)
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
