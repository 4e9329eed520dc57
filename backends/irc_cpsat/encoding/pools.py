"""Redundant constraints on the capacities of sets of resources.

All that can only be done inside a set of resources takes at most the sum of their capacities: one
cumulative constraint, without the choices among them (Baptiste, Le Pape, Nuijten, "Constraint-Based
Scheduling", 2001). What an activity takes there is the least that any of its modes does, whichever
alternatives they choose. And its work fits beneath the makespan: one linear constraint. Solvers
prove at once what follows from these, and by trying all choices what does not.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ortools.sat.python import cp_model

from irc.problem import Activity
from irc_cpsat.encoding.builder import Builder, Literal, ResourceUses
from irc_cpsat.encoding.resources import interval_of

SETS_LIMIT = 64
"""The greatest number of sets that are looked at."""

POOLS_LIMIT = 4
"""Of these, the greatest number that get a constraint: those with the most work for their size.

A cumulative takes time at each step of a search, and one with less work seldom says more.
"""

LARGEST_WORK = 2**53
"""Work above this (ticks × units) is left out: its sums might not fit 64 bits."""

Members = frozenset[int]
"""A set of contended pools, by index."""


@dataclass(frozen=True)
class PoolLoad:
    """A set of pools, and the (activity, amount) pairs that it must take, whatever is chosen."""

    members: Members
    capacity: int
    loads: tuple[tuple[int, int], ...]

    def least_work(self, builder: Builder) -> int:
        """The work (ticks × units) of the activities that are always present."""
        activities = builder.problem.activities
        return sum(
            activities[i].duration_min * amount
            for i, amount in self.loads
            if builder.present[i] is None
        )


def add_pools(builder: Builder) -> None:
    """Adds the joint capacity of the sets of alternatives that are most in demand."""
    for pool in pool_loads(builder):
        uses = ResourceUses()
        for i, amount in pool.loads:
            uses.add(interval_of(builder, i, builder.present[i]), amount)
        builder.model.add_cumulative(uses.intervals, uses.amounts, pool.capacity)


def pool_loads(builder: Builder) -> list[PoolLoad]:
    """The sets of several pools with the most work for their capacity."""
    activities = builder.problem.activities
    found = []
    for members in _sets(activities):
        loads = [
            (i, amount)
            for i, activity in enumerate(activities)
            if activity.duration_min > 0 and (amount := _least_amount(activity, members))
        ]
        capacity = _capacity(builder, members)
        if sum(amount for _, amount in loads) > capacity:
            found.append(PoolLoad(members, capacity, tuple(loads)))
    found.sort(
        key=lambda pool: (-pool.least_work(builder) / max(1, pool.capacity), len(pool.loads))
    )
    return found[:POOLS_LIMIT]


def _least_amount(activity: Activity, members: Members) -> int:
    """The least amount that an activity takes inside a set, in any mode and by any choice."""
    inside = [d for d in activity.open_demands if members.issuperset(d.alternatives)]
    details = activity.details
    always = sum(d.amount for d in inside if details.use_mode(d.use) is None)
    if not details.modes:
        return always
    return always + min(
        sum(d.amount for d in inside if details.use_mode(d.use) == mode)
        for mode in range(len(details.modes))
    )


def _sets(activities: Iterable[Activity]) -> list[Members]:
    """For each activity all pools that it may take, where these are several; and all of those that
    overlap, one after another, while there are few.
    """
    keys = {
        members for activity in activities for members in _choices(activity) if len(members) > 1
    }
    found = sorted(keys, key=lambda members: (len(members), sorted(members)))[:SETS_LIMIT]
    for k, one in enumerate(found):
        for other in found[:k]:
            union = one | other
            if len(found) < SETS_LIMIT and one & other and union not in keys:
                keys.add(union)
                found.append(union)
    return found


def _choices(activity: Activity) -> Iterator[Members]:
    """The alternatives of each demand, and the pools of which some mode takes one."""
    by_mode: set[int] = set()
    for demand in activity.open_demands:
        if activity.details.use_mode(demand.use) is None:
            yield frozenset(demand.alternatives)
        else:
            by_mode.update(demand.alternatives)
    if by_mode:
        yield frozenset(by_mode)


def add_energy(builder: Builder, makespan: cp_model.IntVar) -> None:
    """Adds that the work on each resource, and on each such set, fits beneath the makespan, where
    some of it is that of optional activities.

    (Where nothing is optional the lower bound counts the work already. Which mode an activity takes
    is left to the solver: there such a sum slows it down more than it tells it.)
    """
    if all(present is None for present in builder.present):
        return
    singles = {
        r for a in builder.problem.activities for d in a.open_demands for r in d.alternatives
    }
    several = [pool.members for pool in pool_loads(builder)]
    for members in (*(frozenset([r]) for r in sorted(singles)), *several):
        certain, work = 0, list[tuple[Literal, int]]()
        for i, activity in enumerate(builder.problem.activities):
            amount = activity.duration_min * _least_amount(activity, members)
            present = builder.present[i]
            if amount and present is None:
                certain += amount
            elif amount and present is not None:
                work.append((present, amount))
        capacity = _capacity(builder, members)
        total = certain + sum(amount for _, amount in work)
        if work and max(total, capacity * builder.horizon) < LARGEST_WORK:
            needed_work = certain + sum(literal * amount for literal, amount in work)
            builder.model.add(needed_work <= capacity * makespan)


def _capacity(builder: Builder, members: Members) -> int:
    return sum(builder.problem.contention.pools[r].capacity for r in members)
