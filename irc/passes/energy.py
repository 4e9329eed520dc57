"""The energy bound: the work on a resource takes at least work / capacity of time.

For every set of activities, `least head + ceil(work / capacity) + least tail` is a lower bound on
the makespan, where an activity's work is its amount times its least duration. Only the sets
"head at least r and tail at least q" matter, and the best of them is found in O(n log n).
"""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from irc.diagnostics.listing import and_more
from irc.model.times import format_number
from irc.problem import Problem

POOLS_LIMIT = 32
"""At most this many sets of alternatives are examined, with unions of overlapping ones."""

FILL_LIMIT = 4_096
"""Up to this capacity, the part of it that the amounts can fill is computed."""

TAILS_LIMIT = 1_024
"""At most this many tails q are tried, evenly chosen where a resource has more distinct ones."""

CROWDS_LIMIT = 4
"""Views of a resource on which at most 1, 2, … activities fit at once, up to this number."""

_NAMES_SHOWN = 4

_NOTHING = -(1 << 200)
"""Below every sum of times and work."""


class Load(NamedTuple):
    """Activities (by index) that hold `amounts` of a load with `capacity` units.

    `of` names the load for the user. Each activity has a least duration above 0; together they
    exceed the capacity.
    """

    of: str
    capacity: int
    activities: tuple[int, ...]
    amounts: tuple[int, ...]


class _Window(NamedTuple):
    """The activities with head and tail at least these, and the time of their work."""

    head: int
    work: int
    tail: int
    value: int


def energy_bound(problem: Problem) -> Problem:
    """Raises the bound to the best energy argument over all resources and pools.

    Needs `heads` and `tails`. Time O(n log n) for each resource, pool and view of one.

    Source: Carlier, "The one-machine sequencing problem", EJOR 11 (1982): for capacity 1 the best
    set gives the makespan of Jackson's preemptive schedule. Above 1 it is the same argument on
    the resource's units.
    """
    if not problem.has_contention:
        return problem
    best: tuple[_Window, Load] | None = None
    value = problem.bounds.makespan.value
    for load in loads(problem):
        window = _best_window(problem, load)
        if window.value > value:
            best, value = (window, load), window.value
    if best is None:
        return problem
    return problem.with_bound(value, _reason(problem, *best))


def _reason(problem: Problem, window: _Window, load: Load) -> str:
    head, work, tail = (
        format_number(problem.to_units(ticks)) for ticks in (window.head, window.work, window.tail)
    )
    return (
        f"energy of {load.of} (head {head} + work {work} / capacity {load.capacity} + tail {tail})"
    )


def _best_window(problem: Problem, load: Load) -> _Window:
    """The set with the greatest bound, by a sweep over heads with a tree over tails.

    Leaves are tails q in rising order. A node knows the work of its leaves and the greatest
    `capacity * q + work of the leaves from q on` over its leaves q. (Vilím's Θ-tree, "Global
    constraints in scheduling", 2007, turned round in time.)
    """
    heads, tails, capacity = problem.bounds.heads, problem.bounds.tails, load.capacity
    thresholds = thinned({tails[i] for i in load.activities}, TAILS_LIMIT)
    leaves = 1 << (len(thresholds) - 1).bit_length()
    work = [0] * (2 * leaves)
    envelope = [_NOTHING] * (2 * leaves)
    works = dict(zip(load.activities, _works(problem, load), strict=True))
    best, best_head = 0, 0
    for i in sorted(load.activities, key=heads.__getitem__, reverse=True):
        k = bisect_right(thresholds, tails[i]) - 1
        node = leaves + k
        work[node] += works[i]
        envelope[node] = capacity * thresholds[k] + work[node]
        while node > 1:
            right = node | 1
            node >>= 1
            work[node] = work[right - 1] + work[right]
            from_left = envelope[right - 1] + work[right]
            from_right = envelope[right]
            envelope[node] = from_left if from_left > from_right else from_right
        reached = heads[i] - (-envelope[1] // capacity)
        if reached > best:
            best, best_head = reached, heads[i]
    return _window_from(problem, load, works, best_head)


def _window_from(problem: Problem, load: Load, works: dict[int, int], head: int) -> _Window:
    """The best set among those with heads of at least `head`."""
    best = _Window(head, 0, 0, -1)
    late = [i for i in load.activities if problem.bounds.heads[i] >= head]
    work = 0
    for i in sorted(late, key=problem.bounds.tails.__getitem__, reverse=True):
        work += works[i]
        value = head - (-work // load.capacity) + problem.bounds.tails[i]
        if value > best.value:
            best = _Window(head, work, problem.bounds.tails[i], value)
    return best


def thinned(times: Iterable[int], limit: int) -> list[int]:
    """The times in rising order, at most `limit` of them, the first among them."""
    ordered = sorted(times)
    if len(ordered) <= limit:
        return ordered
    return [ordered[k * len(ordered) // limit] for k in range(limit)]


def _works(problem: Problem, load: Load) -> Iterator[int]:
    for i, amount in zip(load.activities, load.amounts, strict=True):
        yield amount * problem.activities[i].duration_min


def loads(problem: Problem) -> Iterator[Load]:
    """The loads: each contended resource, each pool of alternatives, and views of them.

    An open demand that can only be met inside a set of resources loads the sum of their capacities.
    """
    demands = _demands(problem)
    room = _room(problem, demands)
    singles = [frozenset(key) for key in sorted(demands) if len(key) == 1]
    for members in (*singles, *_pools(demands)):
        total: Counter[int] = Counter()
        for key, entries in demands.items():
            if members.issuperset(key):
                for i, amount in entries:
                    total[i] += amount
        load = Load(
            _named(problem, sorted(members)),
            _fill(sum(room[r] for r in members), total.values()),
            tuple(sorted(total)),
            tuple(total[i] for i in sorted(total)),
        )
        if load.capacity and sum(load.amounts) > load.capacity:
            yield load
            yield from _crowds(load)


Demands = dict[tuple[int, ...], list[tuple[int, int]]]
"""For each set of alternatives the (activity, amount) pairs of the open demands on it."""


def _demands(problem: Problem) -> Demands:
    """Open demands with work, on those of their alternatives that can meet them."""
    demands: Demands = {}
    for i, activity in enumerate(problem.activities):
        if not activity.duration_min:
            continue
        for _, alternatives, amount in activity.open_demands:
            key = alternatives
            if len(key) > 1:
                key = tuple(r for r in key if amount <= problem.contention.pools[r].capacity) or key
            demands.setdefault(key, []).append((i, amount))
    return demands


def _room(problem: Problem, demands: Demands) -> dict[int, int]:
    """For each resource, the greatest amount that can be in use at once."""
    amounts: dict[int, Counter[int]] = {}
    for key, entries in demands.items():
        counted = Counter(amount for _, amount in entries)
        for r in key:
            amounts.setdefault(r, Counter()).update(counted)
    return {
        r: _fill(problem.contention.pools[r].capacity, a.elements()) for r, a in amounts.items()
    }


def _fill(capacity: int, amounts: Iterable[int]) -> int:
    """The greatest sum of some of `amounts` that is at most `capacity`, or `capacity` itself."""
    if capacity > FILL_LIMIT:
        return capacity
    reachable, within = 1, (1 << (capacity + 1)) - 1
    for amount in amounts:
        if amount <= capacity:
            reachable |= (reachable << amount) & within
        if reachable >> capacity:
            return capacity
    return reachable.bit_length() - 1


def _pools(demands: Demands) -> list[frozenset[int]]:
    """The sets of alternatives, and unions of those that overlap, while there is room."""
    pools = [frozenset(key) for key in sorted(demands) if len(key) > 1][:POOLS_LIMIT]
    known = set(pools)
    for k, one in enumerate(pools):
        for other in pools[:k]:
            if len(pools) >= POOLS_LIMIT:
                return pools
            both = one | other
            if one & other and both not in known:
                known.add(both)
                pools.append(both)
    return pools


def _crowds(load: Load) -> Iterator[Load]:
    """Views with sharper counts: amounts above 1/2 of the capacity fit one at a time, and so on.

    Of amounts whose sum is at most the capacity c, `ceil((m + 1) * amount / c) - 1` sums up to
    at most m: each is below (m + 1) * amount / c, so their sum is below m + 1. (Dual feasible
    functions: Fekete, Schepers, "New classes of fast lower bounds for bin packing", 2001.)
    """
    capacity = load.capacity
    for m in range(1, min(CROWDS_LIMIT, capacity - 1) + 1):
        counts = [-(-(m + 1) * amount // capacity) - 1 for amount in load.amounts]
        sharper = any(
            n * capacity > amount * m for n, amount in zip(counts, load.amounts, strict=True)
        )
        if sharper and sum(counts) > m:
            kept = [k for k, n in enumerate(counts) if n]
            yield Load(
                f"{load.of}, amounts above 1/{m + 1} of it",
                m,
                tuple(load.activities[k] for k in kept),
                tuple(counts[k] for k in kept),
            )


def _named(problem: Problem, members: list[int]) -> str:
    """The names of the resources of some pools, for messages."""
    names = [
        repr(problem.resources[k].id) for r in members for k in problem.contention.pools[r].members
    ]
    return and_more(names[:_NAMES_SHOWN], len(names), " or ", " or ")
