"""Orders of uses, and loads, that the history of a running task has broken: they bind no more."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from irc.execution.executed import ExecutedActivity
from irc.problem import NOBODY, Activity, Problem, UseOrder


def without_broken_orders(problem: Problem, executed: Mapping[int, ExecutedActivity]) -> Problem:
    """The problem without the orders of uses that no continuation can keep any more."""
    held = {r: _uses(problem, r, executed) for o in problem.sequences for r in o.resources}
    return replace(problem, sequences=tuple(_left(problem, held)))


def _uses(problem: Problem, r: int, executed: Mapping[int, ExecutedActivity]) -> list[int]:
    """The executed activities that hold or have held a resource, in order."""
    begun = (
        (past.start, i)
        for i, past in executed.items()
        if past.end > past.start and _holds(problem.activities[i], past, r)
    )
    return [i for _, i in sorted(begun)]


def _holds(activity: Activity, past: ExecutedActivity, r: int) -> bool:
    """Whether an executed activity holds a resource; where it is not known, whether it must."""
    if past.resources is not None:
        return r in past.resources
    uses = (activity.uses[u] for u in activity.uses_in(past.mode))
    return any(use.alternatives == (r,) for use in uses)


def _left(problem: Problem, held: Mapping[int, Sequence[int]]) -> Iterator[UseOrder]:
    for order in problem.sequences:
        if order.kind == "consecutive":
            first, second = order.rows[0]
            kept = tuple(r for r in order.resources if _can_be_next(held[r], first, second))
            if kept:
                yield order._replace(resources=kept)
            continue
        broken = {
            (j, k)
            for (j, one), (k, other) in combinations(enumerate(order.rows), 2)
            if len({*_known(order.resources, one, other, held)}) > 1
        }
        yield order._replace(waived=tuple(sorted({*order.waived, *broken})))


def _can_be_next(uses: Sequence[int], first: int, second: int) -> bool:
    if second in uses:
        return first in uses and uses.index(second) == uses.index(first) + 1
    return first not in uses or uses[-1] == first


def _known(
    resources: Sequence[int],
    one: Sequence[int],
    other: Sequence[int],
    held: Mapping[int, Sequence[int]],
) -> Iterator[bool]:
    """For each resource on which the order of two jobs is history, whether the first is first."""
    for r, i, j in zip(resources, one, other, strict=True):
        uses = held[r]
        if NOBODY in (i, j) or i == j or not (i in uses or j in uses):
            continue
        yield i in uses and (j not in uses or uses.index(i) < uses.index(j))


# --- loads ---


def without_broken_loads(problem: Problem, executed: Mapping[int, ExecutedActivity]) -> Problem:
    """The problem in which running activities that are no load any more count as one use.

    It lasts until the last of them ends. Ends that could still be chosen are as planned.
    """
    changed: dict[int, Activity] = {}
    for k, pool in enumerate(problem.contention.pools):
        if not problem.resources[pool.members[0]].batch:
            continue
        running = [
            i
            for i in executed
            if any(d.alternatives == (k,) for d in problem.activities[i].open_demands)
        ]
        pairs = combinations(running, 2)
        if not any(_are_apart(problem, pool.members[0], i, j) for i, j in pairs):
            continue
        last = max(running, key=lambda i: (executed[i].end, i))
        for i in running:
            activity = changed.get(i, problem.activities[i])
            length = max(activity.duration_min, executed[i].end - executed[i].start)
            kept = tuple(d for d in activity.open_demands if i == last or d.alternatives != (k,))
            changed[i] = replace(
                activity, duration_min=length, duration_max=length, open_demands=kept
            )
    if not changed:
        return problem
    activities = tuple(changed.get(i, a) for i, a in enumerate(problem.activities))
    return replace(problem, activities=activities)


def _are_apart(problem: Problem, r: int, i: int, j: int) -> bool:
    """Whether two activities that run at once in a batch resource are no load."""
    one, other = problem.activities[i], problem.activities[j]
    families = [
        {use.family for use in activity.uses if r in use.alternatives} for activity in (one, other)
    ]
    return (
        one.start != other.start
        or families[0] != families[1]
        or one.duration_max < other.duration_min
        or other.duration_max < one.duration_min
    )
