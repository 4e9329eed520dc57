"""The load bound: the loads of a batch resource that its uses need at least, one after another.

What every schedule has in a batch resource falls into parts that never share a load: by family, and
by duration where durations are fixed. A part needs as many loads as a packing of its amounts into
the capacity needs at least (the bound L2 of Martello and Toth, "Lower bounds and reduction
procedures for the bin packing problem", 1990). Where durations are ranges, the longest least
durations fill the loads first.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from irc.problem import Problem
from irc.problem.setups import has_ended_in


def load_bound(problem: Problem) -> Problem:
    """Raises the bound by the loads of each batch resource. Needs heads and tails."""
    for r, resource in enumerate(problem.resources):
        if not resource.batch:
            continue
        uses = list(_certain(problem, r))
        if not uses:
            continue
        work = sum(_least_work(part, resource.greatest_capacity()) for part in _parts(uses))
        bounds = problem.bounds
        begin = min(bounds.heads[use[0]] for use in uses)
        tail = min(bounds.tails[use[0]] for use in uses)
        if begin + work + tail > problem.bounds.makespan.value:
            reason = f"loads of {problem.time_text(work)} at least in {resource.id!r}"
            problem = problem.with_bound(begin + work + tail, reason)
    return problem


_Use = tuple[int, int, int, int, int]
"""(activity, family, least duration, greatest duration, amount)."""


def _certain(problem: Problem, resource: int) -> Iterator[_Use]:
    """The uses of a resource that every schedule has, and that go on."""
    for i, activity in enumerate(problem.activities):
        details = activity.details
        if activity.duration_min == 0 or details.optional or details.repeats is not None:
            continue
        for u, use in enumerate(activity.uses):
            if (
                use.alternatives == (resource,)
                and details.use_mode(u) is None
                and not has_ended_in(activity, u)
            ):
                yield i, use.family, activity.duration_min, activity.duration_max, use.amount


def _parts(uses: Sequence[_Use]) -> list[list[_Use]]:
    """The uses by family, and by duration where all of a family have fixed ones."""
    families: dict[int, list[_Use]] = {}
    for use in uses:
        families.setdefault(use[1], []).append(use)
    parts: list[list[_Use]] = []
    for own in families.values():
        if any(least != most for _, _, least, most, _ in own):
            parts.append(own)
            continue
        lengths: dict[int, list[_Use]] = {}
        for use in own:
            lengths.setdefault(use[2], []).append(use)
        parts += lengths.values()
    return parts


def _least_work(part: Sequence[_Use], capacity: int) -> int:
    """The least time that the loads of one part take together."""
    if len({least for _, _, least, _, _ in part}) == 1:
        return part[0][2] * least_loads([use[4] for use in part], capacity)
    work = room = 0
    for _, _, least, _, amount in sorted(part, key=lambda use: -use[2]):
        more = -(-max(0, amount - room) // capacity)
        work += more * least
        room += more * capacity - amount
    return work


def least_loads(amounts: Sequence[int], capacity: int) -> int:
    """The number of loads that some amounts need at least (L2)."""
    best = -(-sum(amounts) // capacity)
    for small in {a for a in amounts if 2 * a <= capacity} | {0}:
        alone = sum(a > capacity - small for a in amounts)
        large = [a for a in amounts if capacity - small >= a and 2 * a > capacity]
        others = sum(a for a in amounts if small <= a and 2 * a <= capacity)
        over = others - (len(large) * capacity - sum(large))
        best = max(best, alone + len(large) + max(0, -(-over // capacity)))
    return best
