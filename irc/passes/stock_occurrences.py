"""The number of occurrences that stock allows: an action that uses flour up ends with the flour.

Each occurrence takes at least an amount out of a reservoir on balance, in every mode. So no more of
them fit than the initial stock, and all that others can bring, allow; and as many less for a
reservoir that is full. Others that repeat bring as much as stock allows them in turn.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

from irc.problem import Activity, Problem

_Nets = tuple[Counter[int], ...]
"""The net change of each reservoir by one occurrence, in each mode."""


def bounded_by_stock(problem: Problem) -> Problem:
    """The problem in which repeated activities occur no more often than stock allows."""
    limits = most_by_stock(problem)
    if not limits:
        return problem
    activities = list(problem.activities)
    for i, most in limits.items():
        activities[i] = _at_most(activities[i], most)
    return replace(problem, activities=tuple(activities))


def _at_most(activity: Activity, most: int) -> Activity:
    repeats = activity.details.repeats
    assert repeats is not None
    least, greatest = repeats
    allowed = max(1, least, most)
    if greatest is not None and greatest <= allowed:
        return activity
    return replace(activity, details=replace(activity.details, repeats=(least, allowed)))


def most_by_stock(problem: Problem) -> Mapping[int, int]:
    """The greatest number of occurrences that stock allows each repeated activity, if it limits it.

    A limit that the activity states itself counts where it is less.
    """
    repeated = [i for i, a in enumerate(problem.activities) if a.details.repeats is not None]
    if not problem.reservoirs or not repeated:
        return {}
    nets = [_nets(activity) for activity in problem.activities]
    counts = [_count(activity) for activity in problem.activities]
    limits: dict[int, int] = {}
    changed = True
    while changed:
        changed = False
        for i in repeated:
            if i not in limits and (most := _allowed(problem, nets, counts, i)) is not None:
                stated = counts[i]
                limits[i] = counts[i] = most if stated is None else min(stated, most)
                changed = True
    return limits


def _nets(activity: Activity) -> _Nets:
    nets = []
    for way in activity.details.ways:
        net = Counter[int]()
        for change in way.stock:
            net[change.reservoir] += change.amount
        nets.append(net)
    return tuple(nets)


def _count(activity: Activity) -> int | None:
    """The greatest number of occurrences of an activity; None: no limit."""
    repeats = activity.details.repeats
    return 1 if repeats is None else repeats[1]


def _allowed(problem: Problem, nets: list[_Nets], counts: list[int | None], i: int) -> int | None:
    """The number of occurrences of activity i that the scarcest reservoir allows."""
    found: list[int] = []
    for k, reservoir in enumerate(problem.reservoirs):
        room = {-1: reservoir.initial - reservoir.least}
        if reservoir.greatest is not None:
            room[1] = reservoir.greatest - reservoir.initial
        for sign, free in room.items():
            each = min(sign * net[k] for net in nets[i])
            given_back = _most(nets, counts, k, -sign, without=i) if each > 0 else None
            if given_back is not None:
                found.append(max(0, free + given_back) // each)
    return min(found, default=None)


def _most(
    nets: list[_Nets], counts: list[int | None], k: int, sign: int, without: int
) -> int | None:
    """The most that all other activities can put into a reservoir, or take out of it (sign -1)."""
    total = 0
    for j, (its, count) in enumerate(zip(nets, counts, strict=True)):
        most = max(sign * net[k] for net in its)
        if j == without or most <= 0:
            continue
        if count is None:
            return None
        total += most * count
    return total
