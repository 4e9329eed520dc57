"""Which resources a solver must look at: the others are settled here, without loss."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import replace

from irc.problem import Activity, Claim, Earlier, Problem, Shared


def merge_pools(problem: Problem, apart: Collection[int] = ()) -> Problem:
    """Makes one resource of each pool whose members are only ever asked for as "one of these".

    Resources `apart` are in no pool: more of them is in use than there is, which the others have no
    part in.

    Where every claim on any member is for one unit of the same set, the members are
    interchangeable units: any schedule that keeps the summed capacity can be told apart again
    (interval graphs are perfect: greedy colouring by start time needs no more units than overlap).
    """
    pools: dict[tuple[int, ...], bool] = {}
    owner: dict[int, tuple[int, ...]] = {}
    for activity in problem.activities:
        for claim in activity.claims:
            key = claim.alternatives
            alike = claim.amount == 1 and not any(
                problem.shared[r].windows or r in apart for r in key
            )
            pools[key] = pools.get(key, True) and alike
            for r in key:
                if owner.setdefault(r, key) != key:
                    pools[key] = pools[owner[r]] = False
                    pools[claim.alternatives] = False
    # A set that shares a member with a set seen earlier spoils both; spread that to all its users.
    merged = [key for key, free in pools.items() if free and len(key) > 1]
    if not merged:
        return problem
    return _with_pools(problem, sorted(merged))


def _with_pools(problem: Problem, merged: list[tuple[int, ...]]) -> Problem:
    gone = {r for key in merged for r in key}
    kept = [r for r in range(len(problem.shared)) if r not in gone]
    place = {r: k for k, r in enumerate(kept)}
    pool_place = {key: len(kept) + k for k, key in enumerate(merged)}
    shared = [problem.shared[r] for r in kept]
    for key in merged:
        members = [problem.shared[r] for r in key]
        shared.append(
            Shared(
                "|".join(m.id for m in members),
                sum(m.capacity for m in members),
                tuple(i for m in members for i in m.members),
            )
        )

    def move(claim: Claim) -> Claim:
        if claim.alternatives in pool_place:
            return claim._replace(alternatives=(pool_place[claim.alternatives],))
        return claim._replace(alternatives=tuple(place[r] for r in claim.alternatives))

    return replace(
        problem,
        shared=tuple(shared),
        activities=tuple(
            replace(a, claims=tuple(map(move, a.claims))) if a.claims else a
            for a in problem.activities
        ),
    )


def drop_uncontended(problem: Problem) -> Problem:
    """Drops claims on resources that have enough, always, even if everything ran at once.

    (Occurrences of one action never overlap: they count once, as do its modes together. But where
    ranks order what happens at one instant, the next may start before the last one ends.)

    A choice that includes such a resource takes it. Repeated until nothing changes, since a
    settled choice relieves the other alternatives.
    """
    activities = list(problem.activities)
    settled = dict(problem.settled)
    while True:
        load: Counter[int] = Counter()
        for activity in activities:
            at_once = 2 if problem.variables and activity.details.repeats is not None else 1
            for claim in activity.claims:
                for r in claim.alternatives:
                    load[r] += claim.amount * at_once
        enough = {r for r, amount in load.items() if amount <= problem.shared[r].least_capacity}
        if not enough:
            break
        before = list(activities)
        for i, activity in enumerate(activities):
            if activity.claims:
                activities[i] = _settle(problem, i, activity, enough, settled)
        if activities == before:
            break
    return replace(problem, activities=tuple(activities), settled=settled)


def _settle(
    problem: Problem,
    index: int,
    activity: Activity,
    enough: set[int],
    settled: dict[tuple[int, int], int],
) -> Activity:
    open_claims = []
    old = problem.earlier[index] if problem.earlier else None
    for claim in activity.claims:
        chosen = next((r for r in claim.alternatives if r in enough), None)
        if chosen is not None and old is not None:
            chosen = _as_before(problem, claim, old, enough)
        if chosen is None:
            open_claims.append(claim)
            continue
        members = problem.shared[chosen].members
        if len(members) == 1:
            settled[index, claim.use] = members[0]
    if len(open_claims) == len(activity.claims):
        return activity
    return replace(activity, claims=tuple(open_claims))


def _as_before(problem: Problem, claim: Claim, old: Earlier, enough: set[int]) -> int | None:
    """What an earlier schedule took, if there is always enough of it."""
    taken = old.resources[claim.use]
    for r in claim.alternatives:
        if r in enough and (taken is None or taken in problem.shared[r].members):
            return r
    return None
