"""Precedence as arrays, and orders and urgencies that follow from it."""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heapify, heappop, heappush

from irc.local_search.arrays import Ints, columns, places
from irc.local_search.ways import Ways
from irc.problem import Problem


def arcs_of(problem: Problem, *, after: bool) -> tuple[Ints, ...]:
    """For each activity those before (or after) it, with the lags: where they begin, who, lag."""
    found = adjacent(problem, after=after)
    return (places(found), *columns(found, 2))


def order_by(problem: Problem, keys: Sequence[float]) -> list[int]:
    """The activities in an order that precedence allows; among several the least key first."""
    after = adjacent(problem, after=True)
    waiting = [len(own) for own in adjacent(problem, after=False)]
    ready = [(keys[i], i) for i, count in enumerate(waiting) if not count]
    heapify(ready)
    order = []
    while ready:
        _, i = heappop(ready)
        order.append(i)
        for j, _ in after[i]:
            waiting[j] -= 1
            if not waiting[j]:
                heappush(ready, (keys[j], j))
    return order


def urgencies(ways: Ways) -> list[int]:
    """The least time from the start of each activity to the end of the schedule."""
    problem = ways.problem
    after = adjacent(problem, after=True)
    found = [min(way.duration for way in own) for own in ways.of]
    for i in reversed(order_by(problem, [0] * len(found))):
        found[i] += max((found[j] + lag for j, lag in after[i]), default=0)
    return found


def adjacent(problem: Problem, *, after: bool) -> list[list[tuple[int, int]]]:
    """For each activity those before (or after) it, with the lags."""
    found: list[list[tuple[int, int]]] = [[] for _ in problem.activities]
    for arc in problem.arcs:
        one, other = (arc.before, arc.after) if after else (arc.after, arc.before)
        found[one].append((other, arc.min_lag))
    return found
