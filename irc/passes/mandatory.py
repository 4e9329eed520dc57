"""The mandatory part of a problem: the activities that every schedule contains."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from irc.problem import PLAIN, Activity, Arc, Bounds, Contention, PreviousPlan, Problem
from irc.problem.projection import Projected, Projection, restricted


def mandatory_part(problem: Problem) -> Projected:
    """A relaxation with plain activities only: its bounds hold for every valid schedule.

    Optional activities, state, stock, modes (their shortest and longest duration remain), windows
    (their greatest capacity remains), calendars, pauses, loads and orders of uses are left out. The
    problem itself where it has none of them. Activities keep their order. The least number of
    occurrences of repeated activities stays, one after the other. The way back leads to the first
    occurrence of each.
    """
    if problem.is_plain and not problem.has_calendars:
        return problem, Projection.identity(problem)
    bare = replace(
        problem,
        contention=Contention(problem.contention.pools),
        bounds=Bounds(makespan=problem.bounds.makespan),
        required=(),
        couplings=(),
        selections=(),
        sequences=(),
        state_precedences=(),
        previous=PreviousPlan(stability=problem.previous.stability),
    )
    occurrences = [i for i, a in enumerate(problem.activities) for _ in range(least_occurrences(a))]
    uses = {i: a.uses_in(None) for i, a in enumerate(problem.activities) if a.details.use_modes}
    core, way = restricted(
        bare, activities=occurrences, uses=uses, groups=(), reservoirs=(), variables=(), numbers=()
    )
    chains = (Arc(k, k + 1, origin=-1) for k, (i, j) in enumerate(pairwise(occurrences)) if i == j)
    core = replace(
        core,
        activities=tuple(
            a if a.details is PLAIN else replace(a, details=PLAIN) for a in core.activities
        ),
        resources=tuple(
            replace(r, capacity=r.greatest_capacity(), windows=(), batch=False)
            for r in core.resources
        ),
        contention=Contention(
            tuple(replace(p, base=None, windows=()) for p in core.contention.pools)
        ),
        arcs=(*core.arcs, *chains),
        calendars=(),
    )
    return core, way


MOST_REPEATED = 1_000
"""At most this many occurrences of one action are counted, to limit the cost."""


def least_occurrences(activity: Activity) -> int:
    """The number of occurrences of an activity that every schedule has, up to `MOST_REPEATED`."""
    if activity.details.repeats is not None:
        return min(activity.details.repeats[0], MOST_REPEATED)
    return 0 if activity.details.optional else 1
