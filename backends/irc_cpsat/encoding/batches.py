"""Loads of batch resources in a CP-SAT model.

A load is known by its first member, in the order of the uses: its leader. Each use either leads a
load or belongs to that of an earlier one, so that equal loads are written in one way only (the
asymmetric representatives of Campêlo, Campos, Corrêa, "On the asymmetric representatives
formulation for the vertex coloring problem", 2008; for loads compare Trindade, de Araújo, Fampa,
"Modelling and symmetry breaking in scheduling problems on batch processing machines", 2018). Loads
do not overlap: one `NoOverlap` of the intervals of leaders. Members start and end with their
leader, and fit into the capacity together. Redundant: of each two uses one ends before the other
starts, or they are together; a literal for each says at once what leaders only say in turn.

Where there are ranks, a load lasts from the first moment at which a member has begun to the last
one at which a member has ended.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

from irc.passes.load_bound import least_loads
from irc.problem import Activity
from irc_cpsat.encoding.builder import Builder, LoadTaker
from irc_cpsat.encoding.resources import interval_of
from irc_cpsat.encoding.setups import certain_order

MOST_ORDERED = 60
"""The greatest number of uses of a resource whose order is also a literal for each pair."""

Truth = Any
"""A literal; True where it always holds."""


@dataclass
class Loads:
    """The loads of one resource: who may lead (`leads`), and who may belong to which leader.

    `joins[k, j]` says that use k belongs to the load that use j leads, j < k. `parts` are the sets
    of uses that can be in loads with each other, directly or through others. `orders[j, k]` says
    that use j ends before use k starts, `together[j, k]` (j < k) that they are in one load.
    """

    pool: int
    takers: Sequence[LoadTaker]
    leads: list[Truth] = field(default_factory=list)
    joins: dict[tuple[int, int], Any] = field(default_factory=dict)
    parts: list[list[int]] = field(default_factory=list)
    orders: dict[tuple[int, int], Any] = field(default_factory=dict)
    together: dict[tuple[int, int], Any] = field(default_factory=dict)


def add_batches(builder: Builder) -> None:
    """Adds the loads of all batch resources, once all demands have been added."""
    before = certain_order(builder, (t.activity for of in builder.loads.values() for t in of))
    for pool, takers in sorted(builder.loads.items()):
        builder.batches.append(_LoadEncoder(builder, pool, takers, before).add())


class _LoadEncoder:
    def __init__(
        self,
        builder: Builder,
        pool: int,
        takers: Sequence[LoadTaker],
        before: frozenset[tuple[int, int]],
    ) -> None:
        self.builder, self.model = builder, builder.model
        self.takers, self.before = takers, before
        self.capacity = builder.problem.contention.pools[pool].capacity
        self.loads = Loads(pool, takers)

    def add(self) -> Loads:
        """Adds the constraints of one resource."""
        loads, model = self.loads, self.model
        members: dict[int, list[int]] = {k: [] for k in range(len(self.takers))}
        leaders: dict[int, list[int]] = {k: [] for k in range(len(self.takers))}
        for j, k in combinations(range(len(self.takers)), 2):
            if self._fit(self.takers[j], self.takers[k]):
                loads.joins[k, j] = model.new_bool_var("")
                members[j].append(k)
                leaders[k].append(j)
        for k, taker in enumerate(self.takers):
            joined = [loads.joins[k, j] for j in leaders[k]]
            loads.leads.append(self._lead(taker, joined))
        for j, own in members.items():
            self._add_load(j, own)
        self._keep_apart(members)
        self._order_pairs()
        loads.parts = _parts(members)
        self._count_loads()
        return loads

    def _lead(self, taker: LoadTaker, joined: list[Any]) -> Truth:
        """Whether a use leads a load: where it is taken and belongs to no other one."""
        if not joined:
            return True if taker.literal is None else taker.literal
        lead = self.model.new_bool_var("")
        if taker.literal is None:
            self.model.add_exactly_one([lead, *joined])
        else:
            self.model.add_exactly_one([lead, *joined, ~taker.literal])
        return lead

    def _add_load(self, j: int, members: Sequence[int]) -> None:
        """Members join a leader only, have its times, and fit in together."""
        model = self.model
        lead, leader = self.loads.leads[j], self.takers[j]
        if not members:
            return
        room = self.capacity - leader.amount
        inside = sum(self.takers[k].amount * self.loads.joins[k, j] for k in members)
        model.add(inside <= (room if lead is True else room * lead))
        for k in members:
            join = self.loads.joins[k, j]
            if lead is not True:
                model.add_implication(join, lead)
            for a, b in self._both_ends(self.takers[k], leader):
                model.add(a == b).only_enforce_if(join)

    def _order_pairs(self) -> None:
        """Of each two uses one ends before the other starts, or they are in one load."""
        if len(self.takers) > MOST_ORDERED:
            return
        for j, k in combinations(range(len(self.takers)), 2):
            one, other = self.takers[j], self.takers[k]
            if one.activity == other.activity:
                continue
            taken = [t.literal for t in (one, other) if t.literal is not None]
            choices: list[Any] = []
            for a, b in ((j, k), (k, j)):
                first, second = self.takers[a], self.takers[b]
                if (second.activity, first.activity) not in self.before:
                    self.loads.orders[a, b] = self._after(first, second, taken)
                    choices.append(self.loads.orders[a, b])
            if (k, j) in self.loads.joins:
                together = self.loads.together[j, k] = self.model.new_bool_var("")
                self.model.add_implication(self.loads.joins[k, j], together)
                for a, b in self._both_ends(one, other):
                    self.model.add(a == b).only_enforce_if(together, *taken)
                choices.append(together)
            self.model.add_bool_or([*choices, *(~literal for literal in taken)])
            for a, b in combinations(choices, 2):
                self.model.add_bool_or([~a, ~b])

    def _after(self, one: LoadTaker, other: LoadTaker, taken: Sequence[Any]) -> Any:
        """A literal under which one use ends before another one starts."""
        builder, literal = self.builder, self.model.new_bool_var("")
        gap = self.model.add(builder.starts[other.activity] >= builder.end(one.activity))
        gap.only_enforce_if(literal, *taken)
        return literal

    def _both_ends(self, one: LoadTaker, other: LoadTaker) -> Iterator[tuple[Any, Any]]:
        builder, i, j = self.builder, one.activity, other.activity
        yield builder.starts[i], builder.starts[j]
        yield builder.end(i), builder.end(j)

    def _keep_apart(self, members: Mapping[int, Sequence[int]]) -> None:
        """Loads do not overlap, in time and, where there are ranks, in moments."""
        intervals = [
            interval_of(self.builder, t.activity, None if lead is True else lead)
            for t, lead in zip(self.takers, self.loads.leads, strict=True)
        ]
        self.model.add_no_overlap(intervals)
        if not self.builder.ranked:
            return
        spans = []
        for j, lead in enumerate(self.loads.leads):
            i = self.takers[j].activity
            first = self.builder.point(i, at_end=False)
            last = self.builder.point(i, at_end=True)
            if members[j]:
                first, last = self._around(j, members[j])
            size = self.model.new_int_var(0, cp_max(self.builder), "")
            if lead is True:
                spans.append(self.model.new_interval_var(first, size, last, ""))
            else:
                spans.append(self.model.new_optional_interval_var(first, size, last, lead, ""))
        self.model.add_no_overlap(spans)

    def _around(self, j: int, members: Sequence[int]) -> tuple[Any, Any]:
        """The first moment at which a load has begun, and the last one before it has ended."""
        builder, most = self.builder, cp_max(self.builder)
        first, last = self.model.new_int_var(0, most, ""), self.model.new_int_var(0, most, "")
        for k in (j, *members):
            i = self.takers[k].activity
            when = [] if k == j else [self.loads.joins[k, j]]
            for bound in (
                self.model.add(first <= builder.point(i, at_end=False)),
                self.model.add(last >= builder.point(i, at_end=True)),
            ):
                if when:
                    bound.only_enforce_if(when)
        return first, last

    def _count_loads(self) -> None:
        """The least number of loads for what can be in loads with each other."""
        for part in self.loads.parts:
            if any(self.takers[k].literal is not None for k in part):
                continue
            least = least_loads([self.takers[k].amount for k in part], self.capacity)
            leads = [self.loads.leads[k] for k in part]
            certain = sum(lead is True for lead in leads)
            if least > certain:
                free = [lead for lead in leads if lead is not True]
                self.model.add(sum(free) >= least - certain)

    def _fit(self, one: LoadTaker, other: LoadTaker) -> bool:
        """Whether two uses can be in one load."""
        i, j = one.activity, other.activity
        if i == j or one.family != other.family or one.amount + other.amount > self.capacity:
            return False
        if (i, j) in self.before or (j, i) in self.before:
            return False
        a, b = (self.builder.problem.activities[x] for x in (i, j))
        return _longest(a) >= b.duration_min and _longest(b) >= a.duration_min


def _longest(activity: Activity) -> int:
    return max(activity.duration_min, activity.duration_max)


def cp_max(builder: Builder) -> int:
    """A moment later than any."""
    longest = max((a.duration_min + (a.start or 0) for a in builder.problem.activities), default=0)
    return (2 * (builder.horizon + 1) + longest) * builder.rank_count


def _parts(members: Mapping[int, Sequence[int]]) -> list[list[int]]:
    """The connected sets of uses that can be together."""
    root = {k: k for k in members}

    def find(k: int) -> int:
        while root[k] != k:
            root[k] = root[root[k]]
            k = root[k]
        return k

    for j, own in members.items():
        for k in own:
            root[find(k)] = find(j)
    found: dict[int, list[int]] = {}
    for k in members:
        found.setdefault(find(k), []).append(k)
    return [*found.values()]


def add_load_work(builder: Builder, makespan: Any) -> None:
    """The loads of each resource, one after another, fit beneath the makespan."""
    for loads in builder.batches:
        terms = [*_work(builder, loads)]
        builder.model.add(sum(terms) + _least_ends(builder, loads.takers) <= makespan)


def _work(builder: Builder, loads: Loads) -> Iterator[Any]:
    for taker, lead in zip(loads.takers, loads.leads, strict=True):
        least = builder.problem.activities[taker.activity].duration_min
        yield least if lead is True else least * lead


def _least_ends(builder: Builder, takers: Sequence[LoadTaker]) -> int:
    """The least time before all uses of a resource, and after them."""
    if any(t.literal is not None for t in takers):
        return 0
    bounds = builder.problem.bounds
    heads = min(bounds.heads[t.activity] for t in takers)
    return heads + min(bounds.tails[t.activity] for t in takers)
