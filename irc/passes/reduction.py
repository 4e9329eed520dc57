"""Transitive reduction: plain precedences that follow from others.

Only finish-start arcs without lags can go: such an arc a → c follows when another path of
finish-start arcs with lags of at least 0 leads from a to c, through activities that are present
in every schedule.
"""

from __future__ import annotations

from dataclasses import replace

from irc.problem import Arc, Problem

FULL_REDUCTION_LIMIT = 4_000
"""Up to this many activities all paths are looked at (bit sets, size²/8 bytes); beyond it only
paths over one other activity, with a bounded number of steps, so the cost stays linear."""

_STEPS_PER_ARC = 20


def _plain(arc: Arc) -> bool:
    return arc.from_end and not arc.to_end and arc.min_lag == 0 and arc.max_lag is None


def redundant_arcs(problem: Problem) -> list[int]:
    """The indexes of arcs that follow from others, in order; none where arcs form a cycle."""
    successors: list[list[tuple[int, int]]] = [[] for _ in problem.activities]
    for k, arc in enumerate(problem.arcs):
        if arc.from_end and not arc.to_end and arc.min_lag >= 0:
            successors[arc.before].append((arc.after, k))
    order = _topological_order(successors)
    if order is None:
        return []
    if len(order) <= FULL_REDUCTION_LIMIT:
        return _by_reachability(problem, successors, order)
    return _by_one_step(problem, successors)


Successors = list[list[tuple[int, int]]]
"""For each activity the (activity, arc index) pairs that come directly after it."""


def _topological_order(successors: Successors) -> list[int] | None:
    waiting = [0] * len(successors)
    for following in successors:
        for v, _ in following:
            waiting[v] += 1
    order = [i for i, count in enumerate(waiting) if not count]
    for u in order:
        for v, _ in successors[u]:
            waiting[v] -= 1
            if not waiting[v]:
                order.append(v)
    return order if len(order) == len(successors) else None


def _by_reachability(problem: Problem, successors: Successors, order: list[int]) -> list[int]:
    position = [0] * len(order)
    for place, u in enumerate(order):
        position[u] = place
    reach = [0] * len(order)
    redundant = []
    for u in reversed(order):
        reached = 0
        for v, k in sorted(successors[u], key=lambda s: position[s[0]]):
            bit = 1 << v
            if reached & bit and _plain(problem.arcs[k]):
                redundant.append(k)
            # A path through an activity that may be absent orders nothing.
            reached |= bit if problem.activities[v].details.optional else bit | reach[v]
        reach[u] = reached
    return sorted(redundant)


def _by_one_step(problem: Problem, successors: Successors) -> list[int]:
    following = [frozenset(v for v, _ in s) for s in successors]
    budget = _STEPS_PER_ARC * len(problem.arcs)
    redundant = []
    for u, direct in enumerate(following):
        budget -= len(direct) * len(direct)
        if budget < 0:
            break
        behind = frozenset().union(
            *(
                following[v]
                for v in direct
                if following[v] & direct and not problem.activities[v].details.optional
            )
        )
        redundant += [k for v, k in successors[u] if v in behind and _plain(problem.arcs[k])]
    return sorted(redundant)


def reduce_transitively(problem: Problem) -> Problem:
    """The problem without the arcs that follow from others."""
    redundant = set(redundant_arcs(problem))
    if not redundant:
        return problem
    return replace(problem, arcs=tuple(a for k, a in enumerate(problem.arcs) if k not in redundant))
