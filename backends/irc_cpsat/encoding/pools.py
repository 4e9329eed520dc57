"""Redundant constraints on the capacities of sets of resources.

All that can only be done inside a set of resources takes at most the sum of their capacities: one
cumulative constraint, without the choices among them (Baptiste, Le Pape, Nuijten, "Constraint-Based
Scheduling", 2001). What an activity takes there is the least that any of its modes does, whichever
alternatives they choose. And its work fits beneath the makespan: one linear constraint. Solvers
prove at once what follows from these, and by trying all choices what does not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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

FEW = 64
"""Of fewer activities that choose among modes, CP-SAT proves more quickly without these constraints
on what their modes take; with more it has no good bound without them (docs/benchmarks.md).
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
    modes = range(len(activity.details.modes)) or (None,)
    return min(_amount_in_mode(activity, members, mode) for mode in modes)


def _amount_in_mode(activity: Activity, members: Members, mode: int | None) -> int:
    """The amount that an activity takes inside a set in a mode (index; None: it has none)."""
    return sum(
        demand.amount
        for demand in activity.open_demands
        if members.issuperset(demand.alternatives)
        and activity.details.use_mode(demand.use) in (None, mode)
    )


def _sets(activities: Sequence[Activity]) -> list[Members]:
    """For each activity all pools that it may take, where these are several; and all of those that
    overlap, one after another, while there are few.
    """
    by_mode = len(activities) >= FEW
    keys = {
        members
        for activity in activities
        for members in _choices(activity, by_mode)
        if len(members) > 1
    }
    found = sorted(keys, key=lambda members: (len(members), sorted(members)))[:SETS_LIMIT]
    for k, one in enumerate(found):
        for other in found[:k]:
            union = one | other
            if len(found) < SETS_LIMIT and one & other and union not in keys:
                keys.add(union)
                found.append(union)
    return found


def _choices(activity: Activity, by_mode: bool) -> Iterator[Members]:
    """The alternatives of each demand, and `by_mode` the pools of which some mode takes one."""
    of_modes: set[int] = set()
    for demand in activity.open_demands:
        if activity.details.use_mode(demand.use) is None:
            yield frozenset(demand.alternatives)
        else:
            of_modes.update(demand.alternatives)
            if not by_mode:
                yield frozenset(demand.alternatives)
    if of_modes and by_mode:
        yield frozenset(of_modes)


def add_energy(builder: Builder, makespan: cp_model.IntVar) -> None:
    """Adds that the work on each resource, and on each such set, fits beneath the makespan, where
    it depends on what is present and on the modes.

    (Where nothing is optional and nothing has modes the lower bound counts the work already.)
    """
    activities = builder.problem.activities
    if not any(a.details.optional or a.details.modes for a in activities):
        return
    singles = {r for a in activities for d in a.open_demands for r in d.alternatives}
    several = [pool.members for pool in pool_loads(builder)]
    for members in (*(frozenset([r]) for r in sorted(singles)), *several):
        certain, chosen = 0, list[tuple[Literal, int]]()
        for i in range(len(activities)):
            always, depending = _work(builder, i, members)
            certain += always
            chosen += depending
        capacity = _capacity(builder, members)
        total = certain + sum(amount for _, amount in chosen)
        if chosen and max(total, capacity * builder.horizon) < LARGEST_WORK:
            needed_work = certain + sum(literal * amount for literal, amount in chosen)
            builder.model.add(needed_work <= capacity * makespan)


def _work(builder: Builder, i: int, members: Members) -> tuple[int, list[tuple[Literal, int]]]:
    """(the least work of an activity inside a set, literals with the work that they add)."""
    activity, present = builder.problem.activities[i], builder.present[i]
    modes = activity.details.modes
    if not modes or len(builder.problem.activities) < FEW:
        least = activity.duration_min * _least_amount(activity, members)
        if present is None or not least:
            return least, []
        return 0, [(present, least)]
    by_mode = [
        mode.duration_min * _amount_in_mode(activity, members, k) for k, mode in enumerate(modes)
    ]
    return 0, [(builder.modes[i][k], work) for k, work in enumerate(by_mode) if work]


def _capacity(builder: Builder, members: Members) -> int:
    return sum(builder.problem.contention.pools[r].capacity for r in members)
