"""Redundant constraints on the capacities of resources and of sets of them.

All demands that can only be met inside a set of resources together take at most the sum of their
capacities: one cumulative constraint, without the choices among them (Baptiste, Le Pape, Nuijten,
"Constraint-Based Scheduling", 2001). And their work fits beneath the makespan: one linear
constraint, which says how many optional activities there is time for. Solvers prove at once what
follows from these, and by trying all choices what does not.
"""

from __future__ import annotations

from collections.abc import Iterator

from ortools.sat.python import cp_model

from irc.problem import OpenDemand
from irc_cpsat.encoding.builder import Builder, Literal, ResourceUses
from irc_cpsat.encoding.resources import interval_of

SETS_LIMIT = 16
"""The greatest number of sets of several resources."""

LARGEST_WORK = 2**53
"""Work above this (ticks × units) is left out: its sums might not fit 64 bits."""


def add_pools(builder: Builder) -> None:
    """Adds the joint capacity of each set of alternatives, and of unions that overlap."""
    demands = list(_demands(builder))
    for members in _sets(demands):
        uses = ResourceUses()
        for i, demand in demands:
            if members.issuperset(demand.alternatives):
                interval = interval_of(builder, i, _needed(builder, i, demand))
                uses.add(interval, demand.amount)
        capacity = _capacity(builder, members)
        if sum(uses.amounts) > capacity:
            builder.model.add_cumulative(uses.intervals, uses.amounts, capacity)


def add_energy(builder: Builder, makespan: cp_model.IntVar) -> None:
    """Adds that the work on each resource, and on each such set, fits beneath the makespan.

    (Where nothing is optional the work is a number, and the lower bound counts it already.)
    """
    demands = list(_demands(builder))
    singles = sorted({d.alternatives[0] for _, d in demands if len(d.alternatives) == 1})
    for members in (*(frozenset([r]) for r in singles), *_sets(demands)):
        certain, work = 0, list[tuple[Literal, int]]()
        for i, demand in demands:
            if members.issuperset(demand.alternatives):
                needed = _needed(builder, i, demand)
                amount = _least_duration(builder, i, demand) * demand.amount
                if needed is None:
                    certain += amount
                else:
                    work.append((needed, amount))
        capacity = _capacity(builder, members)
        total = certain + sum(amount for _, amount in work)
        if work and max(total, capacity * builder.horizon) < LARGEST_WORK:
            needed_work = certain + sum(literal * amount for literal, amount in work)
            builder.model.add(needed_work <= capacity * makespan)


def _capacity(builder: Builder, members: frozenset[int]) -> int:
    return sum(builder.problem.contention.pools[r].capacity for r in members)


def _least_duration(builder: Builder, i: int, demand: OpenDemand) -> int:
    """The least duration of an activity that has this demand, in ticks."""
    activity = builder.problem.activities[i]
    mode = activity.details.use_mode(demand.use)
    return activity.duration_min if mode is None else activity.details.modes[mode].duration_min


def _needed(builder: Builder, i: int, demand: OpenDemand) -> Literal | None:
    """The literal under which a demand is to be met, by any alternative; None: always."""
    mode = builder.problem.activities[i].details.use_mode(demand.use)
    return builder.present[i] if mode is None else builder.modes[i][mode]


def _demands(builder: Builder) -> Iterator[tuple[int, OpenDemand]]:
    """The demands of activities that always take time."""
    for i, activity in enumerate(builder.problem.activities):
        if activity.duration_min > 0:
            for demand in activity.open_demands:
                yield i, demand


def _sets(demands: list[tuple[int, OpenDemand]]) -> list[frozenset[int]]:
    """The sets of alternatives, and unions of those that overlap, while there are few."""
    keys = sorted({d.alternatives for _, d in demands if len(d.alternatives) > 1})
    found = [frozenset(key) for key in keys][:SETS_LIMIT]
    for k, one in enumerate(found):
        for other in found[:k]:
            union = one | other
            if len(found) < SETS_LIMIT and one & other and union not in found:
                found.append(union)
    return found
