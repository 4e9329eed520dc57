"""Simultaneous happenings that change levels: free units of a resource, stock in a reservoir.

The happenings of one instant must have an order, weakly that of their ranks, in which no level
leaves its bounds after any of them. Where two happenings can come in one order only, their ranks
get an edge at once. The clusters that are left go to the search (`irc.validation.ranks`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter
from typing import NamedTuple

from irc.model.quantities import Number
from irc.validation.bound_schedule import BoundSchedule
from irc.validation.happenings import Edge, Happening, Timelines
from irc.validation.resources import ContendedInstant, hand_overs
from irc.validation.stock import (
    Changes,
    StockHappening,
    after,
    is_within,
    reservoirs,
    stock_happenings,
    tight_reservoirs,
)


class Party(NamedTuple):
    """A happening, and its change of each level; a lower `stage` comes first."""

    happening: Happening
    changes: Changes
    stage: int = 1


@dataclass(frozen=True)
class LevelCluster:
    """Happenings of one instant that need an order.

    `bounds` are the least and the greatest of each of the `levels`, by number.
    """

    names: tuple[str, ...]
    time: Number
    parties: tuple[Party, ...]
    levels: dict[int, int]
    bounds: dict[int, tuple[int, int | None]]

    def happenings(self) -> Iterator[Happening]:
        """All happenings of the cluster."""
        for party in self.parties:
            yield party.happening

    def allows(self, order: Sequence[int], following: int) -> bool:
        """Whether a party can come next, after those of `order`."""
        levels = dict(self.levels)
        for k in (*order, following):
            for r, amount in self.parties[k].changes:
                levels[r] += amount
        placed = {*order, following}
        if any(
            party.stage < self.parties[following].stage
            for k, party in enumerate(self.parties)
            if k not in placed
        ):
            return False
        return all(
            least <= levels[r] and (greatest is None or levels[r] <= greatest)
            for r, (least, greatest) in self.bounds.items()
        )


def level_clusters(
    bound: BoundSchedule, timelines: Timelines
) -> tuple[list[Edge], list[LevelCluster]]:
    """Edges that resources and stock demand of the ranks, and the clusters left to search."""
    edges: list[Edge] = []
    clusters: list[LevelCluster] = []
    for hand_over in hand_overs(bound):
        own, undecided = _needed_orders(hand_over, timelines)
        edges += own
        if undecided:
            clusters.append(_hand_over_cluster(hand_over, timelines))
    clusters += _stock_clusters(bound, timelines)
    return edges, clusters


def _needed_orders(hand_over: ContendedInstant, timelines: Timelines) -> tuple[list[Edge], bool]:
    """Edges of pairs that cannot both hold the resource; whether more of them may not fit together.

    Where the capacity is too small in every order, the sweep over time has reported it.
    """
    freed = sum(amount for _, amount in hand_over.ending)
    taken = sum(amount for _, amount in hand_over.starting)
    if freed > hand_over.room or taken > hand_over.room:
        return [], False
    edges: list[Edge] = []
    undecided = False
    for ending, amount in hand_over.ending:
        for starting, other in hand_over.starting:
            if amount + other > hand_over.room:
                end, start = timelines.nodes[ending.number][1], timelines.nodes[starting.number][0]
                edges.append((end, start, 0))
            else:
                undecided = True
    return edges, undecided


def _hand_over_cluster(hand_over: ContendedInstant, timelines: Timelines) -> LevelCluster:
    parties = [
        Party(Happening(o.end, timelines.nodes[o.number][1], o, True), ((0, amount),))
        for o, amount in hand_over.ending
    ]
    parties += [
        Party(Happening(o.start, timelines.nodes[o.number][0], o, False), ((0, -amount),))
        for o, amount in hand_over.starting
    ]
    free = hand_over.room - sum(amount for _, amount in hand_over.ending)
    return LevelCluster(
        (hand_over.resource,), hand_over.time, tuple(parties), {0: free}, {0: (0, None)}
    )


def _stock_clusters(bound: BoundSchedule, timelines: Timelines) -> Iterator[LevelCluster]:
    its = reservoirs(bound)
    levels = [resource.initial for resource in its]
    # (Each node is one happening, so nodes can stand for ranks here.)
    ordered = sorted(stock_happenings(bound, timelines.nodes), key=attrgetter("time"))
    for time, same in groupby(ordered, key=attrgetter("time")):
        members = list(same)
        tight = tight_reservoirs(its, levels, members) if len(members) > 1 else ()
        if tight and all(is_within(its[r], levels[r]) for r in tight):
            yield LevelCluster(
                tuple(its[r].id for r in sorted(tight)),
                time,
                tuple(
                    _party(member, tight, timelines)
                    for member in members
                    if _touches(member, tight)
                ),
                {r: levels[r] for r in tight},
                {r: (its[r].min, its[r].max) for r in tight},
            )
        levels = after(levels, members)


def _touches(member: StockHappening, tight: frozenset[int]) -> bool:
    return any(r in tight for r, _ in member.changes)


def _party(member: StockHappening, tight: frozenset[int], timelines: Timelines) -> Party:
    occurrence = member.occurrence
    node = timelines.nodes[occurrence.number][member.at_end]
    changes = tuple((r, amount) for r, amount in member.changes if r in tight)
    happening = Happening(member.time, node, occurrence, member.at_end)
    return Party(happening, changes, member.stage)
