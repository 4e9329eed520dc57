"""Demands on ranks, taken together: can they be kept, and what follows for some of them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from itertools import product

from oracles.state_instant import Demand

Order = Mapping[tuple[int, int], int]
"""For two nodes, how far the rank of the second is at least above the first: 0 or 1."""


def closure(demands: Iterable[Demand]) -> dict[tuple[int, int], int] | None:
    """All that follows from `demands`, None where they contradict each other.

    Ranks are dense for this purpose (only their order counts), so "above by 2" is "above".
    """
    known: dict[tuple[int, int], int] = {}
    for a, b, least in demands:
        known[a, b] = max(known.get((a, b), 0), least)
    nodes = sorted({node for pair in known for node in pair})
    for via, a, b in product(nodes, repeat=3):
        if (a, via) in known and (via, b) in known:
            known[a, b] = max(known.get((a, b), 0), known[a, via], known[via, b])
    return None if any(known.get((node, node), 0) for node in nodes) else known


def only(order: Order, nodes: Collection[int]) -> dict[tuple[int, int], int]:
    """What is known of some nodes."""
    return {(a, b): w for (a, b), w in order.items() if a in nodes and b in nodes and a != b}


def ranks(demands: Collection[Demand], nodes: Iterable[int]) -> dict[int, int]:
    """The least ranks that keep demands which do not contradict each other."""
    found = dict.fromkeys(nodes, 0)
    for _ in range(len(found) + 1):
        for a, b, least in demands:
            found[b] = max(found[b], found[a] + least)
    return found
