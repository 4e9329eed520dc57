"""What resources and stock demand of the ranks at one instant: each order of its happenings.

A resource is held over [(start, rank), (end, rank of the end)), and stock changes one happening
after another, in the order of ranks and some order within a rank. So for each resource, and for all
reservoirs together, the happenings have an order in which every prefix keeps the levels within
bounds; neighbours in it are weakly in the order of their ranks.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import combinations, pairwise, permutations, product

from oracles.state_instant import Demand
from oracles.state_task import Stock

Party = tuple[int, Mapping[str, int]]
"""A node, and by how much its happening changes each level."""


def hand_over_orders(
    room: int, ending: Sequence[tuple[int, int]], starting: Sequence[tuple[int, int]]
) -> list[tuple[Demand, ...]]:
    """The orders of those who free a resource and those who take it, as (node, amount) each.

    `room` is what of the capacity others leave to them, those who end included.
    """
    freed, taken = sum(a for _, a in ending), sum(a for _, a in starting)
    if freed + taken <= room:
        return [()]
    parties: list[Party] = [(node, {"free": amount}) for node, amount in ending]
    parties += [(node, {"free": -amount}) for node, amount in starting]
    return level_orders({"free": Stock(room - freed, 0, None)}, {"free": room - freed}, parties)


def level_orders(
    stocks: Mapping[str, Stock],
    levels: Mapping[str, int],
    parties: Sequence[Party],
    first: Collection[int] = (),
    behind: Collection[int] = (),
) -> list[tuple[Demand, ...]]:
    """The chains of weak demands of all orders that keep every level; () alone if all do.

    The nodes of `first` come before those of `behind`.
    """
    orders = [o for o in permutations(parties) if _past_comes_first(o, first, behind)]
    found = [order for order in orders if _keeps(stocks, levels, order)]
    if not found:
        return []
    if len(found) == len(orders):
        return [()]
    return [_chain([node for node, _ in order]) for order in found]


def combined(choices: Sequence[list[tuple[Demand, ...]]]) -> list[frozenset[Demand]]:
    """One of each, in every way; those that ask for more than another are left out."""
    found = {frozenset(d for part in parts for d in part) for parts in product(*choices)}
    return [one for one in found if not any(other < one for other in found)]


def _past_comes_first(
    order: Sequence[Party], first: Collection[int], behind: Collection[int]
) -> bool:
    nodes = [node for node, _ in order]
    return not any(a in behind and b in first for a, b in combinations(nodes, 2))


def _keeps(stocks: Mapping[str, Stock], levels: Mapping[str, int], order: Sequence[Party]) -> bool:
    now = dict(levels)
    for _, changes in order:
        for name, amount in changes.items():
            now[name] += amount
            if not stocks[name].holds(now[name]):
                return False
    return True


def _chain(nodes: Sequence[int]) -> tuple[Demand, ...]:
    pairs = pairwise(nodes)
    return tuple((a, b, 0) for a, b in pairs if a != b)
