"""Orders of uses in a CP-SAT model: arcs of circuits, and literals of pairs.

That one use is the next after another is an arc of the resource's circuit. That jobs have one order
on several resources says of each two of them that the literals of their order agree: for each pair
there is then one decision, whatever the number of resources, as in models of permutation flow shops
(Pinedo, "Scheduling", 2016, chapter 6). Only uses that take some time count, so what holds where an
activity is absent, elsewhere or without a length is enforced by the literals of the uses.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

from irc.problem import NOBODY, Problem, UseOrder
from irc.problem.setups import has_ended
from irc_cpsat.encoding.builder import Builder, Literal, Taker
from irc_cpsat.encoding.setups import SetupSequence

Truth = Any
"""A literal, or True or False."""


def add_sequences(builder: Builder) -> None:
    """Adds all orders of uses, once the circuits have been added."""
    encoder = _OrderEncoder(builder)
    for order in builder.problem.sequences:
        if order.kind == "consecutive":
            first, second = order.rows[0]
            for r in order.resources:
                encoder.consecutive(r, first, second)
        else:
            encoder.same_order(order)


class _OrderEncoder:
    def __init__(self, builder: Builder) -> None:
        self.builder, self.model = builder, builder.model
        self.circuits: dict[int, SetupSequence] = {s.resource: s for s in builder.sequences}
        self._before: dict[tuple[int, int, int], Truth] = {}

    def consecutive(self, r: int, first: int, second: int) -> None:
        """Adds that the second activity holds r next after the first, if both hold it."""
        ended = ended_uses(self.builder.problem, r)
        if first in ended and second in ended:
            return
        if second in ended:  # What comes now comes behind it.
            for _, taker in self._takers(r, first):
                self._forbid(taker)
            return
        for k, taker in self._takers(r, second):
            if first not in ended:
                for n, before in self._takers(r, first):
                    self._next(r, n + 1, k + 1, before, taker)
            elif ended[-1] == first:
                self._next(r, 0, k + 1, taker)
            else:
                self._forbid(taker)

    def _next(self, r: int, node: int, following: int, *takers: Taker) -> None:
        arc = self.circuits[r].arcs.get((node, following))
        absent = [~t.literal for t in takers if t.literal is not None]
        self.model.add_bool_or([*absent, *([] if arc is None else [arc])])

    def _forbid(self, *takers: Taker) -> None:
        self.model.add_bool_or([~t.literal for t in takers if t.literal is not None])

    def same_order(self, order: UseOrder) -> None:
        """Adds that each two jobs have one order on each two resources that both hold."""
        waived = set(order.waived)
        for (j, one), (k, other) in combinations(enumerate(order.rows), 2):
            if (j, k) in waived:
                continue
            columns = [
                c
                for c in range(len(order.resources))
                if NOBODY not in (one[c], other[c]) and one[c] != other[c]
            ]
            for a, b in combinations(columns, 2):
                x = self._comes_first(order.resources[a], one[a], other[a])
                y = self._comes_first(order.resources[b], one[b], other[b])
                absent = [
                    ~literal
                    for c in (a, b)
                    for i in (one[c], other[c])
                    if (literal := self._uses(order.resources[c], i)) is not None
                ]
                if x is None or y is None:
                    continue
                self._clause(absent, _not(x), y)
                self._clause(absent, x, _not(y))

    def _clause(self, absent: Sequence[Truth], *truths: Truth) -> None:
        if not any(truth is True for truth in truths):
            self.model.add_bool_or([*absent, *(t for t in truths if t is not False)])

    def _takers(self, r: int, i: int) -> list[tuple[int, Taker]]:
        circuit = self.circuits.get(r)
        if circuit is None:
            return []
        return [(k, t) for k, t in enumerate(circuit.takers) if t.activity == i]

    def _uses(self, r: int, i: int) -> Literal | None:
        """A literal that says whether an activity holds r; None where it always does."""
        takers = [t for _, t in self._takers(r, i)]
        literals = [t.literal for t in takers if t.literal is not None]
        if not literals or len(literals) < len(takers):
            return None
        if len(literals) == 1:
            return literals[0]
        key = r, i, NOBODY
        if key not in self._before:
            self._before[key] = self.model.new_bool_var("")
            self.model.add_max_equality(self._before[key], literals)
        found: Literal = self._before[key]
        return found

    def _comes_first(self, r: int, i: int, j: int) -> Truth | None:
        """Whether i holds r before j, where both do; None: they never both do."""
        ended = ended_uses(self.builder.problem, r)
        if i in ended and j in ended:
            return ended.index(i) < ended.index(j)
        if i in ended or j in ended:
            late = j if i in ended else i
            return (i in ended) if self._takers(r, late) else None
        if (r, j, i) in self._before:
            return _not(self._before[r, j, i])
        if (r, i, j) not in self._before:
            self._before[r, i, j] = self._ordered(r, i, j)
        return self._before[r, i, j]

    def _ordered(self, r: int, i: int, j: int) -> Truth | None:
        """A literal that says whether i holds r before j."""
        firsts, others = self._takers(r, i), self._takers(r, j)
        if not firsts or not others:
            return None
        orders = self.circuits[r].orders
        if len(firsts) == len(others) == 1 and (firsts[0][0], others[0][0]) in orders:
            return orders[firsts[0][0], others[0][0]]
        first = self.model.new_bool_var("")
        for k, a in firsts:
            for n, b in others:
                absent = [~t.literal for t in (a, b) if t.literal is not None]
                if (k, n) in orders:
                    self.model.add_bool_or([*absent, ~first, orders[k, n]])
                    self.model.add_bool_or([*absent, first, ~orders[k, n]])
                    continue
                taken = [t.literal for t in (a, b) if t.literal is not None]
                for before, after, literal in ((i, j, first), (j, i, ~first)):
                    gap = self.model.add(self.builder.starts[after] >= self.builder.end(before))
                    gap.only_enforce_if([literal, *taken])
        return first


def ended_uses(problem: Problem, r: int) -> list[int]:
    """The activities whose use of a resource is history, in order."""
    ended = (
        (activity.start or 0, i)
        for i, activity in enumerate(problem.activities)
        for u, use in enumerate(activity.uses)
        if use.alternatives == (r,) and has_ended(problem, activity, u)
    )
    return [i for _, i in sorted(ended)]


def _not(truth: Truth | None) -> Truth | None:
    if truth is None or isinstance(truth, bool):
        return None if truth is None else not truth
    return ~truth
