"""How many occurrences of a repeated action a model needs.

A model holds a number of occurrences, so it is deepened until a schedule is found. Since
occurrences of one action do not overlap, at most makespan / duration of them fit into a schedule:
where the model holds as many, nothing better was left out.
"""

from __future__ import annotations

from collections.abc import Iterator

from irc.passes.unroll import slots
from irc.problem import Activity, Problem

FIRST = 2
GREATEST = 64
"""Depths that are tried without being asked for by a proof."""

FILE_DEPTH = 4
"""So many occurrences of an action that may repeat are in a model that is written out."""

SLOTS_LIMIT = 4_000
"""A model has so many occurrences of repeated actions at most."""


def depths(problem: Problem) -> Iterator[int]:
    """Depths to try, each twice the one before; one alone where nothing repeats."""
    repeated = [a for a in problem.activities if a.details.repeats is not None]
    if not repeated:
        yield 1
        return
    depth = FIRST if _total(repeated, FIRST) <= SLOTS_LIMIT else 1
    while depth <= GREATEST and _total(repeated, depth) <= SLOTS_LIMIT:
        yield depth
        if all(slots(a, depth) == slots(a, depth + 1) for a in repeated):
            return
        depth *= 2


def _total(repeated: list[Activity], depth: int) -> int:
    return sum(slots(a, depth) for a in repeated)


def enough(problem: Problem, limit: int | None) -> int | None:
    """The depth that holds every schedule that ends by `limit` (ticks); None where none does."""
    needed = 1
    for activity in problem.activities:
        repeats = activity.details.repeats
        if repeats is None:
            continue
        fitting: int | None = None
        if limit is not None and activity.duration_min > 0:
            fitting = max(0, limit - activity.release) // activity.duration_min
        if repeats[1] is not None:
            fitting = repeats[1] if fitting is None else min(fitting, repeats[1])
        if fitting is None:
            return None
        needed = max(needed, fitting)
    return needed


def fits_a_model(problem: Problem, depth: int) -> bool:
    """Whether a model of that depth is small enough to be tried."""
    repeated = [a for a in problem.activities if a.details.repeats is not None]
    return _total(repeated, depth) <= SLOTS_LIMIT
