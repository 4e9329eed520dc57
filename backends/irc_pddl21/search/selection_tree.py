"""Best-first search: selections by falling upper bound, decided item by item."""

from __future__ import annotations

from collections.abc import Iterator
from heapq import heappop, heappush
from itertools import count

from irc_pddl21.search.selection import Selection, SelectionSpace, is_refuted


class SelectionTree:
    """The open nodes of a search tree, each a selection of the items decided so far."""

    def __init__(self, space: SelectionSpace) -> None:
        self.space = space
        self._count = count()
        self._heap: list[tuple[int, int, int, Selection]] = []
        self._push(frozenset(), 0)

    def _push(self, chosen: Selection, decided: int) -> None:
        undecided = frozenset(range(decided, len(self.space.items)))
        upper = self.space.upper_bound(chosen, undecided)
        if upper is not None:
            heappush(self._heap, (-upper, -decided, next(self._count), chosen))

    def put_back(self, upper: int, leaf: Selection | None) -> None:
        """Makes the last selection come again."""
        if leaf is not None:
            decided = len(self.space.items)
            heappush(self._heap, (-upper, -decided, next(self._count), leaf))

    def falling(self) -> Iterator[tuple[int, Selection | None]]:
        """(Upper bound of all unseen selections, a selection or None while items are undecided)."""
        size = len(self.space.items)
        while self._heap:
            upper, decided, _, chosen = heappop(self._heap)
            if -decided == size:
                yield -upper, chosen
                continue
            k = -decided
            with_it = chosen | {k}
            if self._repeats_in_order(k, chosen) and not self._is_refuted(with_it, k + 1):
                self._push(with_it, k + 1)
            if not self.space.problem.selections or not self._is_refuted(chosen, k + 1):
                self._push(chosen, k + 1)
            yield -upper, None

    def _is_refuted(self, chosen: Selection, decided: int) -> bool:
        """Whether no selection with these items, whatever else is decided, has a schedule."""
        # (What is undecided may give what these need, so it stays optional.)
        undecided = frozenset(range(decided, len(self.space.items)))
        return is_refuted(self.space.restricted(chosen, undecided), thoroughly=False)

    def _repeats_in_order(self, k: int, chosen: Selection) -> bool:
        """Whether item k is no further occurrence, or the previous one of its action is chosen."""
        items = self.space.items
        return not (items[k].further and k and items[k] == items[k - 1]) or k - 1 in chosen
