"""A list schedule of a shop: the most urgent operation on the machine that ends it first."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from irc.local_search.tabu import (
    AFTER,
    AFTER_AT,
    AFTER_LAG,
    BEFORE_AT,
    LASTS,
    MACHINE,
    RELEASE,
    WAY_AT,
    Shop,
)


def dispatched(
    shop: Shop, machines: int, urgencies: Sequence[float]
) -> tuple[list[int], list[int]]:
    """An order and ways: of those that could start before any could end, the most urgent starts.

    Source: Giffler and Thompson, "Algorithms for solving production-scheduling problems",
    Operations Research 8 (1960).
    """
    arrays = [array.tolist() for array in shop]
    before_at, after_at, after, lags = (arrays[k] for k in (BEFORE_AT, AFTER_AT, AFTER, AFTER_LAG))
    machine, lasts, way_at = arrays[MACHINE], arrays[LASTS], arrays[WAY_AT]
    ready = arrays[RELEASE][: len(urgencies)]
    waiting = [last - first for first, last in pairwise(before_at[: len(urgencies) + 1])]
    free = [0] * (machines + 1)  # (The last one, which is machine -1, is always free.)
    able = [i for i, count in enumerate(waiting) if not count]
    order, ways = list[int](), [0] * len(ready)
    while able:
        first = {
            i: min(
                (max(ready[i], free[machine[w]]) + lasts[w], w)
                for w in range(way_at[i], way_at[i + 1])
            )
            for i in able
        }
        soonest = min(first.values())[0]
        rivals = [i for i in able if first[i][0] - lasts[first[i][1]] < soonest]
        i = max(rivals or [min(able, key=first.__getitem__)], key=urgencies.__getitem__)
        end, ways[i] = first[i]
        able.remove(i)
        order.append(i)
        if machine[ways[i]] >= 0:
            free[machine[ways[i]]] = end
        for k in range(after_at[i], after_at[i + 1]):
            j = after[k]
            ready[j] = max(ready[j], end + lags[k])
            waiting[j] -= 1
            if not waiting[j]:
                able.append(j)
    return order, ways
