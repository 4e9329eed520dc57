"""Finds the resources that a solver must consider, and decides the others here, without loss."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import replace

from irc.problem import Activity, ContendedPool, OpenDemand, PreviousPlace, Problem
from irc.problem.projection import with_demands_on


def merge_pools(problem: Problem, apart: Collection[int] = ()) -> Problem:
    """Makes one resource of each pool whose members are only asked for as "one of these".

    Resources `apart` join no pool: more of them is in use than their capacity, which must not
    affect the others. Nor do those with set-ups or loads: each has its own.

    Where every open demand on any member is for one unit of the same set, the members are
    interchangeable units: any schedule that keeps the summed capacity can be split among them again
    (interval graphs are perfect: greedy colouring by start time needs no more units than overlap).
    """
    apart = {*apart, *(r for r, of in enumerate(problem.resources) if of.is_ordered)}
    apart |= {
        r for i in problem.coupled for u in problem.activities[i].uses for r in u.alternatives
    }
    pools: dict[tuple[int, ...], bool] = {}
    owner: dict[int, tuple[int, ...]] = {}
    for activity in problem.activities:
        for demand in activity.open_demands:
            key = demand.alternatives
            alike = demand.amount == 1 and not any(
                problem.contention.pools[r].windows or r in apart for r in key
            )
            pools[key] = pools.get(key, True) and alike
            for r in key:
                if owner.setdefault(r, key) != key:
                    pools[key] = pools[owner[r]] = False
                    pools[demand.alternatives] = False
    # A set that shares a member with a set seen earlier spoils both; spread that to all its users.
    merged = [key for key, free in pools.items() if free and len(key) > 1]
    if not merged:
        return problem
    return _with_pools(problem, sorted(merged))


def _with_pools(problem: Problem, merged: list[tuple[int, ...]]) -> Problem:
    """The problem in which each of these sets of pools is one pool, after all others."""
    old = problem.contention.pools
    gone = {r for key in merged for r in key}
    kept = [r for r in range(len(old)) if r not in gone]
    new = {r: k for k, r in enumerate(kept)}
    new |= {r: len(kept) + k for k, key in enumerate(merged) for r in key}
    pools = [old[r] for r in kept]
    for key in merged:
        members = [old[r] for r in key]
        pools.append(
            ContendedPool(
                "|".join(m.id for m in members),
                sum(m.capacity for m in members),
                tuple(i for m in members for i in m.members),
            )
        )
    return replace(
        problem,
        contention=replace(problem.contention, pools=tuple(pools)),
        activities=tuple(with_demands_on(a, new) for a in problem.activities),
    )


def drop_uncontended(problem: Problem) -> Problem:
    """Drops open demands on resources that always suffice, even if all activities ran at once.

    Where a resource has set-ups or loads, its uses stay open: their order matters, and
    one that could be elsewhere may save a set-up. Coupled choices stay open, too.
    (Occurrences of one action never overlap: they count once, as do its modes together. But where
    ranks order the happenings of an instant, the next one may start before the last one ends.)

    A choice that includes such a resource takes it. Repeated until nothing changes, since a
    choice that is fixed relieves the other alternatives.
    """
    ordered = {
        k
        for k, pool in enumerate(problem.contention.pools)
        if any(problem.resources[r].is_ordered for r in pool.members)
    }
    activities = list(problem.activities)
    fixed = dict(problem.contention.fixed_choices)
    while True:
        load: Counter[int] = Counter()
        for activity in activities:
            at_once = 2 if problem.has_state and activity.details.repeats is not None else 1
            for demand in activity.open_demands:
                for r in demand.alternatives:
                    load[r] += demand.amount * at_once
        enough = {
            r
            for r, amount in load.items()
            if amount <= problem.contention.pools[r].least_capacity and r not in ordered
        }
        if not enough:
            break
        before = list(activities)
        for i, activity in enumerate(activities):
            if activity.open_demands:
                activities[i] = _without_ample(problem, i, activity, enough, fixed, ordered)
        if activities == before:
            break
    return replace(
        problem,
        activities=tuple(activities),
        contention=replace(problem.contention, fixed_choices=fixed),
    )


def _without_ample(
    problem: Problem,
    index: int,
    activity: Activity,
    enough: set[int],
    fixed: dict[tuple[int, int], int],
    ordered: Collection[int],
) -> Activity:
    still_open = []
    old = problem.previous.places[index] if problem.previous.places else None
    for demand in activity.open_demands:
        free = not any(r in ordered for r in demand.alternatives)
        chosen = next((r for r in demand.alternatives if r in enough and free), None)
        if len(demand.alternatives) > 1 and index in problem.coupled:
            chosen = None  # What it takes matters to others.
        if chosen is not None and old is not None:
            chosen = _as_before(problem, demand, old, enough)
        if chosen is None:
            still_open.append(demand)
            continue
        members = problem.contention.pools[chosen].members
        if len(members) == 1:
            fixed[index, demand.use] = members[0]
    if len(still_open) == len(activity.open_demands):
        return activity
    return replace(activity, open_demands=tuple(still_open))


def _as_before(
    problem: Problem, demand: OpenDemand, old: PreviousPlace, enough: set[int]
) -> int | None:
    """The alternative that the previous plan took, if it always suffices."""
    taken = old.resources[demand.use]
    for r in demand.alternatives:
        if r in enough and (taken is None or taken in problem.contention.pools[r].members):
            return r
    return None
