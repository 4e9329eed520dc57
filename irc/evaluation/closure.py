"""The transitive closure of edges: all pairs of which the first must come before the second."""

from __future__ import annotations

from collections.abc import Iterable


def closure(edges: Iterable[tuple[int, int]]) -> frozenset[tuple[int, int]]:
    """All pairs (a, b) such that the edges lead from a to b."""
    bits: dict[int, int] = {}
    after: dict[int, list[int]] = {}
    for a, b in edges:
        after.setdefault(a, []).append(b)
    for start in after:
        reached, waiting = 0, list(after[start])
        while waiting:
            node = waiting.pop()
            if reached >> node & 1:
                continue
            reached |= 1 << node
            known = bits.get(node)
            if known is None:
                waiting.extend(after.get(node, ()))
            else:
                reached |= known
        bits[start] = reached
    return frozenset((a, b) for a, reached in bits.items() for b in _set_bits(reached))


def _set_bits(number: int) -> Iterable[int]:
    while number:
        low = number & -number
        yield low.bit_length() - 1
        number ^= low
