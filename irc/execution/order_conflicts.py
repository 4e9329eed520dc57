"""Orders of uses that the history of a running task has broken, or that it leaves to nobody."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from irc.execution.executed import ExecutedActivity
from irc.problem import NOBODY, Problem, UseOrder


def without_broken_orders(problem: Problem, executed: Mapping[int, ExecutedActivity]) -> Problem:
    """The problem without the orders of uses that no continuation can keep any more."""
    held = {r: _uses(r, executed) for order in problem.sequences for r in order.resources}
    return replace(problem, sequences=tuple(_left(problem, held)))


def _uses(r: int, executed: Mapping[int, ExecutedActivity]) -> list[int]:
    """The executed activities that hold or have held a resource, in order."""
    begun = (
        (past.start, i)
        for i, past in executed.items()
        if r in (past.resources or ()) and past.end > past.start
    )
    return [i for _, i in sorted(begun)]


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
