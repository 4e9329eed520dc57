"""The set-up bound: the work on a resource, and the least set-ups among the families of that work.

The uses of a resource that every schedule has belong to some families. Whatever their order, the
resource passes from family to family until it has been set up for all of them. So its set-ups take
at least as long as the shortest way through all of these families, where the way from one to
another may lead through any other family that the resource can be used for (the closure by
shortest paths; with it a way visits each family once). The way is found by dynamic programming
(Held, Karp, "A dynamic programming approach to sequencing problems", 1962) for few families, and
bounded by the least set-up into each one for many.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

from irc.problem import Problem, Setups
from irc.problem.setups import has_ended, setups_from_now

MOST_FAMILIES = 10
"""With more families than this, the least set-up into each one is counted."""


def setup_bound(problem: Problem) -> Problem:
    """Raises the bound by the work and set-ups of each resource. Needs heads and tails."""
    for r, resource in enumerate(problem.resources):
        if resource.setups is None or resource.setups.waived_before:
            continue
        value, work, setup = _bound_of(problem, r)
        if value > problem.bounds.makespan.value:
            reason = (
                f"work of {problem.time_text(work)} on {resource.id!r}, and set-ups of "
                f"{problem.time_text(setup)} at least"
            )
            problem = problem.with_bound(value, reason)
    return problem


def _bound_of(problem: Problem, resource: int) -> tuple[int, int, int]:
    """(bound, work, set-ups) of one resource."""
    setups, _ = setups_from_now(problem, resource)
    certain = list(certain_uses(problem, resource))
    if not certain:
        return 0, 0, 0
    possible = possible_families(problem, resource)
    needed = {family for _, family in certain}
    work = sum(problem.activities[i].duration_min for i, _ in certain)
    bounds = problem.bounds
    tail = min(bounds.tails[i] for i, _ in certain)
    best = (0, 0, 0)
    for from_start in (False, True):
        setup = _shortest_way(setups, needed, possible, from_start=from_start)
        begin = setups.since if from_start else min(bounds.heads[i] for i, _ in certain)
        best = max(best, (begin + work + setup + tail, work, setup))
    return best


def certain_uses(problem: Problem, resource: int) -> Iterator[tuple[int, int]]:
    """(activity, family) of the uses of a resource that every schedule has, and that go on."""
    for i, activity in enumerate(problem.activities):
        details = activity.details
        if activity.duration_min == 0 or details.optional or details.repeats is not None:
            continue
        for u, use in enumerate(activity.uses):
            if (
                use.alternatives == (resource,)
                and details.use_mode(u) is None
                and not has_ended(problem, activity, u)
            ):
                yield i, use.family


def possible_families(problem: Problem, resource: int) -> set[int]:
    """The families of all uses that a resource may have."""
    return {
        use.family
        for activity in problem.activities
        for use in activity.uses
        if resource in use.alternatives
    }


def _shortest_way(setups: Setups, needed: set[int], possible: set[int], *, from_start: bool) -> int:
    """The time of the shortest way through all needed families, from the beginning or from any."""
    families = sorted(possible)
    index = {family: k for k, family in enumerate(families)}
    times = [[setups.between(a, b).time for b in families] for a in families]
    first = [setups.first(b).time if from_start else 0 for b in families]
    for via, a, b in product(range(len(families)), repeat=3):
        times[a][b] = min(times[a][b], times[a][via] + times[via][b])
    first = [
        min(first[b], *(first[a] + times[a][b] for a in range(len(families))))
        for b in range(len(families))
    ]
    stops = [index[family] for family in sorted(needed)]
    if len(stops) > MOST_FAMILIES:
        return _least_entries(times, first, stops)
    return _held_karp(times, first, stops)


def _least_entries(
    times: Sequence[Sequence[int]], first: Sequence[int], stops: Sequence[int]
) -> int:
    """The least set-up into each stop, from any other or at the beginning; one is the first."""
    entries = [min(times[a][b] for a in range(len(times)) if a != b) for b in stops]
    begun = [min(entry, first[b]) for entry, b in zip(entries, stops, strict=True)]
    saved = max(entry - least for entry, least in zip(entries, begun, strict=True))
    return sum(entries) - saved


def _held_karp(times: Sequence[Sequence[int]], first: Sequence[int], stops: Sequence[int]) -> int:
    """The shortest way through all stops."""
    best: dict[tuple[int, int], int] = {(1 << k, k): first[b] for k, b in enumerate(stops)}
    whole = (1 << len(stops)) - 1
    for visited in range(1, whole):
        for last in range(len(stops)):
            so_far = best.get((visited, last))
            if so_far is None:
                continue
            for k, b in enumerate(stops):
                if not visited >> k & 1:
                    key = visited | 1 << k, k
                    length = so_far + times[stops[last]][b]
                    if length < best.get(key, length + 1):
                        best[key] = length
    return min(best[whole, k] for k in range(len(stops)))
