"""Stock in re-timing: the changes of a reservoir keep an order in which its level stays in bounds.

All happenings of the decisions have one order: by time, by rank, and within a rank one in which no
level leaves its bounds after any of them (what one happening gives and takes counts together). For
each reservoir that order is cut into batches that follow each other, weakly (`t_next >= t_before`):
at each new instant, and wherever one batch would leave a level that only this order keeps. Within a
batch any order, and any times, keep the level within bounds.

So where the happenings of several batches fall into one instant, their previous order, which is the
same for all reservoirs, still keeps all bounds.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby, pairwise
from typing import NamedTuple

from irc.problem import Problem, Reservoir
from irc.problem.decisions import AnswerError, Decision, Moment
from irc.problem.temporal_network import Network
from irc.problem.time_points import PointMap
from irc.retiming.state import Happening, is_one_happening

Amounts = dict[int, int]
"""The change of each reservoir; no change is 0."""

Batches = list[list[Happening]]
"""Happenings, each batch no earlier than the one before, in time and rank."""

_ORDERS = 20_000
"""Within one rank, at most this many sets of happenings that could have come first are examined."""


class _Change(NamedTuple):
    time: Moment
    rank: int
    happening: Happening
    amounts: Amounts


def keep_stock(
    problem: Problem,
    decisions: Sequence[Decision],
    points: PointMap,
    network: Network,
    floors: list[int],
) -> list[Batches]:
    """Adds the order of each reservoir's changes to a network, linear in their number.

    Between two batches stands a point of its own, so `network` and `floors` grow. Returns the
    batches of each reservoir, whose order binds ranks too.
    """
    if not problem.reservoirs:
        return []
    ordered = _in_order(problem, list(_changes(problem, decisions)))
    found: list[Batches] = []
    for r, reservoir in enumerate(problem.reservoirs):
        own = [c for c in ordered if r in c.amounts]
        batches = list(_batches(r, reservoir, own))
        for before, after in pairwise(batches):
            _add_boundary(network, floors, points, before, after)
        found.append(batches)
    return found


def _changes(problem: Problem, decisions: Sequence[Decision]) -> Iterator[_Change]:
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        if not activity.details.stock:
            continue
        one = is_one_happening(activity, decision)
        found: dict[bool, Amounts] = {False: {}, True: {}}
        for stock, amount, at_end in activity.details.stock:
            amounts = found[at_end and not one]
            amounts[stock] = amounts.get(stock, 0) + amount
        for at_end, amounts in found.items():
            changed = {r: amount for r, amount in amounts.items() if amount}
            time, rank = (decision.start, decision.rank)
            if at_end:
                time, rank = (decision.end, decision.end_rank)
            if changed:
                yield _Change(time, rank, Happening(i, at_end), changed)


def _in_order(problem: Problem, changes: list[_Change]) -> list[_Change]:
    """The changes in an order that keeps every level within bounds, where there is one."""
    levels = [reservoir.initial for reservoir in problem.reservoirs]
    ordered: list[_Change] = []
    changes.sort(key=lambda c: (c.time, c.rank, c.happening))
    for _, same in groupby(changes, key=lambda c: (c.time, c.rank)):
        members = _within_rank(problem, levels, list(same))
        ordered += members
        for change in members:
            for r, amount in change.amounts.items():
                levels[r] += amount
    return ordered


def _within_rank(problem: Problem, levels: Sequence[int], members: list[_Change]) -> list[_Change]:
    """The changes in an order within bounds: producers first, or producers last, else by search.

    Raises `AnswerError` where none is found.
    """
    if len(members) < 2:
        return members
    reservoirs = problem.reservoirs
    by_gain = sorted(members, key=lambda c: (_kind(c), c.happening))
    for simple in (by_gain, sorted(members, key=lambda c: (-_kind(c), c.happening))):
        if _stays_within(reservoirs, levels, simple):
            return simple
    order = _StockOrder(reservoirs, levels, members).find()
    if order is None:
        names = ", ".join(repr(problem.activities[c.happening.activity].id) for c in members)
        raise AnswerError(f"no order of {names} at one instant keeps all stock within bounds")
    return order


def _kind(change: _Change) -> int:
    """The kind of a change: 0 if it only gives, 2 if it only takes, 1 if it does both."""
    return (min(change.amounts.values()) < 0) + (max(change.amounts.values()) < 0)


def _stays_within(
    reservoirs: Sequence[Reservoir], levels: Sequence[int], order: Sequence[_Change]
) -> bool:
    now = list(levels)
    for change in order:
        for r, amount in change.amounts.items():
            now[r] += amount
            if not _is_within(reservoirs[r], now[r]):
                return False
    return True


def _is_within(reservoir: Reservoir, level: int) -> bool:
    return reservoir.least <= level and (reservoir.greatest is None or level <= reservoir.greatest)


@dataclass
class _StockOrder:
    """A depth-first search for an order; a state is the set of done changes, in any order."""

    reservoirs: Sequence[Reservoir]
    levels: Sequence[int]
    members: Sequence[_Change]
    failed: set[frozenset[int]] = field(default_factory=set)

    def find(self) -> list[_Change] | None:
        """An order that keeps every level within bounds; None where none is found."""
        order: list[int] = []
        tried: list[Iterator[int]] = [self._next(order)]
        while tried:
            k = next(tried[-1], None)
            if k is None:
                self.failed.add(frozenset(order))
                tried.pop()
                if order:
                    order.pop()
                if len(self.failed) > _ORDERS:
                    return None
                continue
            order.append(k)
            if len(order) == len(self.members):
                return [self.members[k] for k in order]
            tried.append(self._next(order))
        return None

    def _next(self, order: Sequence[int]) -> Iterator[int]:
        placed = frozenset(order)
        now = Counter(dict(enumerate(self.levels)))
        for k in order:
            now.update(self.members[k].amounts)
        possible = [
            k
            for k, change in enumerate(self.members)
            if k not in placed
            and all(_is_within(self.reservoirs[r], now[r] + a) for r, a in change.amounts.items())
        ]
        for k in possible:
            if placed | {k} not in self.failed:
                yield k


def _batches(r: int, reservoir: Reservoir, changes: Sequence[_Change]) -> Iterator[list[Happening]]:
    """The longest stretches of the order, within one instant, in which all orders suit."""
    batch: list[Happening] = []
    level, given, taken = reservoir.initial, 0, 0
    time: Moment | None = None
    for change in changes:
        amount = change.amounts[r]
        more_given, more_taken = given + max(amount, 0), taken + max(-amount, 0)
        fits = _is_within(reservoir, level - more_taken) and _is_within(
            reservoir, level + more_given
        )
        if batch and (change.time != time or not fits):
            yield batch
            batch, level = [], level + given - taken
            more_given, more_taken = max(amount, 0), max(-amount, 0)
        batch.append(change.happening)
        time = change.time
        given, taken = more_given, more_taken
    if batch:
        yield batch


def _add_boundary(
    network: Network,
    floors: list[int],
    points: PointMap,
    before: Sequence[Happening],
    after: Sequence[Happening],
) -> None:
    boundary = network.size
    network.size += 1
    floors.append(0)
    for happening in before:
        point, offset = _point(points, happening)
        network.add(point, boundary, offset)
    for happening in after:
        point, offset = _point(points, happening)
        network.add(boundary, point, -offset)


def _point(points: PointMap, happening: Happening) -> tuple[int, int]:
    i = happening.activity
    return (points.end[i], points.end_offset[i]) if happening.at_end else (points.start[i], 0)
