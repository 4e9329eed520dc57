"""Set-ups in a CP-SAT model: the uses of a resource as a circuit.

A node is a use, or the beginning and the end of the resource's work; an arc says that one use is
the next after another, and that the set-up passes between them. Besides these (Fischetti, Laporte,
Martello 1993; as `AddCircuit` is used for machines in ortools' and PyJobShop's models) come
redundant constraints, which say at once what arcs say only together:

- the order of two uses, whatever lies between them: at least the shortest chain of set-ups and
  durations passes (`orders`; the closure keeps this right where no triangle inequality holds);
- uses with the least set-up before them do not overlap either (`_add_longer_uses`);
- a family that is used is entered from outside, and all work with its set-ups fits beneath the
  makespan.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, permutations
from typing import Any

from irc.passes.setup_totals import ordered_pairs, setup_value
from irc.problem import Problem, Setup, Setups
from irc.problem.setups import setups_from_now
from irc_cpsat.encoding.builder import Builder, Literal, Taker, name_of

MOST_ORDERED = 80
"""The greatest number of uses of a resource whose order is also a literal for each pair."""

NEVER = 1 << 62

_Arcs = dict[tuple[int, int], Any]
"""Literals, or their negations, by pairs."""


@dataclass
class SetupSequence:
    """The circuit of one resource: node 0 is both ends, node k + 1 is `takers[k]`.

    `orders[k, l]` says that taker k comes before taker l. `total` is the set-ups ahead.
    """

    resource: int
    takers: Sequence[Taker]
    arcs: _Arcs
    orders: _Arcs
    empty: Literal | None
    past: Setup


def add_setups(builder: Builder) -> None:
    """Adds the set-ups of all resources, once all demands have been added."""
    before = certain_order(builder, (t.activity for of in builder.takers.values() for t in of))
    for r, takers in sorted(builder.takers.items()):
        resource = builder.problem.contention.pools[r].members[0]
        setups, past = setups_from_now(builder.problem, resource)
        circuit = _Circuit(builder, resource, setups, takers, before)
        needed = _needs_circuit(builder.problem, resource)
        builder.sequences.append(circuit.add(past) if needed else circuit.add_orders(past))


def _needs_circuit(problem: Problem, resource: int) -> bool:
    """Whether it counts which use is next; else only the order of each two does."""
    setups = problem.resources[resource].setups
    assert setups is not None
    return (
        bool(setups.table)
        or setups.tight
        or any(
            order.kind == "consecutive" and resource in order.resources
            for order in problem.sequences
        )
    )


def setup_values(builder: Builder, name: str) -> Any:
    """The total time (ticks), or cost, of all set-ups: an expression."""
    terms: list[Any] = []
    certain = 0
    for sequence in builder.sequences:
        certain += setup_value(sequence.past, name)
        setups, _ = setups_from_now(builder.problem, sequence.resource)
        for (a, b), literal in sequence.arcs.items():
            if b:
                setup = _setup(setups, sequence.takers, a - 1, b - 1)
                amount = setup_value(setup, name)
                if amount:
                    terms.append(amount * literal)
    done = {sequence.resource for sequence in builder.sequences}
    for r, resource in enumerate(builder.problem.resources):
        if resource.setups is not None and r not in done:
            _, past = setups_from_now(builder.problem, r)
            certain += setup_value(past, name)
    return sum(terms) + certain if terms else certain


def _setup(setups: Setups, takers: Sequence[Taker], before: int, after: int) -> Setup:
    """The set-up between two takers; before the first (-1) that of the beginning."""
    if before < 0:
        return setups.first(takers[after].family)
    return setups.between(takers[before].family, takers[after].family)


def certain_order(builder: Builder, among: Iterable[int]) -> frozenset[tuple[int, int]]:
    """The pairs of activities of which the second starts after the end of the first, by arcs."""
    following: list[list[int]] = [[] for _ in builder.problem.activities]
    for arc in builder.problem.arcs:
        if arc.from_end and not arc.to_end and arc.min_lag >= 0:
            following[arc.before].append(arc.after)
    return ordered_pairs(following, {*among})


class _Circuit:
    """Adds the circuit of one resource and what follows from it."""

    def __init__(
        self,
        builder: Builder,
        resource: int,
        setups: Setups,
        takers: Sequence[Taker],
        before: frozenset[tuple[int, int]],
    ) -> None:
        self.builder, self.model = builder, builder.model
        self.resource, self.setups, self.takers = resource, setups, takers
        self.before = before
        activities = builder.problem.activities
        self.least = [max(1, activities[t.activity].duration_min) for t in takers]
        self.apart = _least_gaps(setups, takers, self.least)
        self.has_waived = any(self._is_waived(k) for k in range(len(takers)))

    def add(self, past: Setup) -> SetupSequence:
        """Adds the constraints; `past` is what has been set up before."""
        takers, model = self.takers, self.model
        arcs: _Arcs = {}
        orders = self._orders() if len(takers) <= MOST_ORDERED and not self.has_waived else {}
        for k in range(len(takers)):
            arcs[0, k + 1] = model.new_bool_var("")
            arcs[k + 1, 0] = model.new_bool_var("")
            self._link(arcs[0, k + 1], -1, k)
        for k, after in permutations(range(len(takers)), 2):
            if self._may_follow(k, after):
                arc = arcs[k + 1, after + 1] = model.new_bool_var("")
                self._link(arc, k, after)
                if (k, after) in orders:
                    model.add_implication(arc, orders[k, after])
        loops: list[Any] = []
        empty: Literal | None = None
        if all(taker.literal is not None for taker in takers):
            empty = model.new_bool_var("")
            loops.append((0, 0, empty))
        for k, taker in enumerate(takers):
            if taker.literal is not None:
                loops.append((k + 1, k + 1, ~taker.literal))
                if empty is not None:
                    model.add_implication(empty, ~taker.literal)
        model.add_circuit([(a, b, literal) for (a, b), literal in arcs.items()] + loops)
        self._add_entries(arcs)
        self._add_longer_uses()
        return SetupSequence(self.resource, takers, arcs, orders, empty, past)

    def add_orders(self, past: Setup) -> SetupSequence:
        """Adds only a literal for each two uses."""
        return SetupSequence(self.resource, self.takers, {}, self._orders(), None, past)

    def _link(self, arc: Literal, k: int, after: int) -> None:
        """Where an arc is taken, the set-up passes between its uses."""
        builder, i = self.builder, self.takers[after].activity
        if self._is_waived(after):
            return
        time = _setup(self.setups, self.takers, k, after).time
        if k < 0:
            ready = self.setups.since + time
            if time:
                builder.model.add(builder.starts[i] >= ready).only_enforce_if(arc)
            if self.setups.tight and self.setups.since:
                latest = max(ready, self.setups.now)
                builder.model.add(builder.starts[i] <= latest).only_enforce_if(arc)
            return
        ready = builder.end(self.takers[k].activity) + time
        builder.model.add(builder.starts[i] >= ready).only_enforce_if(arc)
        if self.setups.tight:
            builder.model.add(builder.starts[i] <= ready).only_enforce_if(arc)

    def _is_waived(self, k: int) -> bool:
        start = self.builder.problem.activities[self.takers[k].activity].start
        return start is not None and start < self.setups.waived_before

    def _may_follow(self, k: int, after: int) -> bool:
        """Whether one use can be the next after another."""
        i, j = self.takers[k].activity, self.takers[after].activity
        if i == j or (j, i) in self.before:
            return False
        if (i, j) not in self.before:
            return True
        return not any(
            t.literal is None and (i, t.activity) in self.before and (t.activity, j) in self.before
            for t in self.takers
        )

    def _orders(self) -> _Arcs:
        """A literal for each pair of uses that says which comes first."""
        found: _Arcs = {}
        for k, after in combinations(range(len(self.takers)), 2):
            i, j = self.takers[k].activity, self.takers[after].activity
            if i == j:
                continue
            first = self.model.new_bool_var("")
            found[k, after], found[after, k] = first, ~first
            self._apart(k, after, first)
            self._apart(after, k, ~first)
        return found

    def _apart(self, k: int, after: int, first: Any) -> None:
        builder = self.builder
        taken = [t.literal for t in (self.takers[k], self.takers[after]) if t.literal is not None]
        i, j = self.takers[k].activity, self.takers[after].activity
        gap = builder.model.add(builder.starts[j] >= builder.end(i) + self.apart[k][after])
        gap.only_enforce_if([first, *taken])

    def _add_entries(self, arcs: Mapping[tuple[int, int], Literal]) -> None:
        """A family that is certainly used is entered from another one, or at the beginning."""
        families: dict[int, list[int]] = {}
        for k, taker in enumerate(self.takers):
            families.setdefault(taker.family, []).append(k)
        for members in families.values():
            if len(members) < 2 or all(self.takers[k].literal is not None for k in members):
                continue
            inside = {k + 1 for k in members}
            self.model.add_bool_or(
                [arc for (a, b), arc in arcs.items() if b in inside and a not in inside]
            )

    def _add_longer_uses(self) -> None:
        """Uses, each with the least set-up before it, do not overlap."""
        builder, intervals = self.builder, []
        ahead = _least_before(self.setups, self.takers)
        if self.has_waived or not any(ahead):
            return
        for k, taker in enumerate(self.takers):
            start, end = builder.starts[taker.activity], builder.end(taker.activity)
            activity = builder.problem.activities[taker.activity]
            name = name_of(activity)
            size: Any = (
                activity.duration_min if activity.is_fixed else builder.sizes[taker.activity]
            )
            size = size + ahead[k]
            if taker.literal is None:
                interval = builder.model.new_interval_var(start - ahead[k], size, end, name)
            else:
                interval = builder.model.new_optional_interval_var(
                    start - ahead[k], size, end, taker.literal, name
                )
            intervals.append(interval)
        builder.model.add_no_overlap(intervals)


def _least_before(setups: Setups, takers: Sequence[Taker]) -> list[int]:
    """The least set-up before each use; of the first use it may take place before t = 0."""
    return [
        min(
            (
                setups.between(t.family, taker.family).time
                for t in takers
                if t.activity != taker.activity
            ),
            default=0,
        )
        for taker in takers
    ]


def _least_gaps(setups: Setups, takers: Sequence[Taker], least: Sequence[int]) -> list[list[int]]:
    """The least time from the end of one use to the start of a later one, whatever lies between.

    The shortest paths over set-ups and durations (Floyd–Warshall).
    """
    size = range(len(takers))
    gaps = [[setups.between(a.family, b.family).time for b in takers] for a in takers]
    if len(takers) > MOST_ORDERED:
        return gaps
    for via in size:
        onward = gaps[via]
        for k in size:
            through, row = gaps[k][via] + least[via], gaps[k]
            if k != via:
                gaps[k] = [
                    old if after == via else min(old, through + rest)
                    for after, (old, rest) in enumerate(zip(row, onward, strict=True))
                ]
    return gaps


def add_setup_work(builder: Builder, makespan: Any) -> None:
    """The work on each resource, with its set-ups, fits beneath the makespan."""
    for sequence in builder.sequences:
        setups, _ = setups_from_now(builder.problem, sequence.resource)
        if setups.waived_before:
            continue
        work: list[Any] = []
        for taker in sequence.takers:
            least = builder.problem.activities[taker.activity].duration_min
            work.append(least if taker.literal is None else least * taker.literal)
        for (a, b), arc in sequence.arcs.items():
            if a and b:
                time = _setup(setups, sequence.takers, a - 1, b - 1).time
                if time:
                    work.append(time * arc)
        builder.model.add(sum(work) + _least_ends(builder, sequence) <= makespan)


def _least_ends(builder: Builder, sequence: SetupSequence) -> int:
    """The least time before all uses of a resource, and after them."""
    if not builder.bounds or not sequence.takers:
        return 0
    bounds = builder.problem.bounds
    if any(t.literal is not None for t in sequence.takers):
        return 0
    heads = min(bounds.heads[t.activity] for t in sequence.takers)
    return heads + min(bounds.tails[t.activity] for t in sequence.takers)
