"""Searches lists of activities by simulated annealing, cycle after cycle, each twice as long."""

from __future__ import annotations

from collections.abc import Sequence
from math import log

from irc.local_search.arrays import first_random
from irc.local_search.compiled import IS_COMPILED, constant, ints, table
from irc.local_search.listing import (
    ENDINGS,
    OF_SETUP_COST,
    OF_SETUP_TIME,
    PARTS,
    WAY_AT,
    Listing,
)
from irc.local_search.lists import (
    APPENDS,
    BEST,
    BEST_END,
    BEST_LIST,
    BEST_START,
    BEST_WAY,
    COLUMNS,
    COUNTS,
    HEAT,
    LACKING,
    LENGTH,
    RANDOM,
    ROWS,
    SIZE,
    STEP,
    anneal,
    take,
    warm,
)
from irc.local_search.ways import Found

CYCLE = 60
"""The first cycle has this many steps for each activity, and"""
LONGEST_CYCLE = 4_000
"""the longest ones this many."""

COOLEST = 200
"""A cycle ends at its first temperature divided by this."""

AGAIN = 4
"""A cycle that begins at the best list is colder by this."""

TRIALS = 200
"""The neighbours that are tried to find the first temperature."""

_ACTIVITY_STEPS = 200_000 if IS_COMPILED else 300
"""The steps of one call are about this, divided by the number of activities."""

STEADY_STEPS = 4_000
"""The same for a steady search, with llvmlite and without it."""

_LEVELS = 256
_CHANCES = 4096


class ListSearch:
    """The search of one problem, from the same seed always the same.

    `value` is that of the first objective, in its whole numbers
    (`irc.problem.objective_values.whole_terms`), and only of schedules that keep all limits.
    """

    def __init__(self, listing: Listing, seed: int, target: int, *, steady: bool = False) -> None:
        problem = self.problem = listing.problem
        self.listing, self.target = listing, target
        plan = listing.plan
        self._size, pools = len(problem.activities), max(1, len(problem.contention.pools))
        self._work = table(ROWS, max(COLUMNS, self._size, pools, plan[ENDINGS]))
        self._lines = table(3 * pools, self.listing.width).reshape(3, pools, -1)
        counts = self._work[COUNTS]
        counts[SIZE], counts[BEST] = self._size, LACKING
        counts[RANDOM] = first_random(seed)
        counts[APPENDS] = plan[plan[PARTS] + OF_SETUP_TIME] or plan[plan[PARTS] + OF_SETUP_COST]
        self._cooling = ints(round(1024 * COOLEST ** (-k / _LEVELS)) for k in range(_LEVELS))
        self._chances = ints(round(-1024 * log((k + 0.5) / _CHANCES)) for k in range(_CHANCES))
        self._first_ways = plan[plan[WAY_AT] :][: self._size]
        self._given: list[Found] = []
        self._cycles = -1
        self._heat = 0
        self._steps = max(1, (STEADY_STEPS if steady else _ACTIVITY_STEPS) // self._size)

    def step(self) -> None:
        """Searches on for a little while."""
        counts = self._work[COUNTS]
        if self._cycles < 0:
            self._begin()
        while self._given:
            found = self._given.pop()
            if self._read(found) <= counts[BEST]:
                self._cycle(self._heat // AGAIN)
        if counts[STEP] >= counts[LENGTH]:
            self._next_cycle()
        anneal(
            *(self.listing.plan, self._work, self._lines, self._cooling, self._chances),
            *(self._steps, self.target),
        )

    def give(self, found: Found) -> None:
        """Gives a schedule of somebody else's, from which the search goes on if it is the best."""
        self._given.append(found)

    def found(self) -> Found | None:
        """The best schedule so far."""
        if self.value is None:
            return None
        work, n = self._work, self._size
        ways = work[BEST_WAY, :n] - self._first_ways
        return self.listing.found(work[BEST_START, :n], work[BEST_END, :n], ways)

    @property
    def value(self) -> int | None:
        """The value of the best schedule so far."""
        best = int(self._work[COUNTS, BEST])
        return None if best >= LACKING else best

    def _begin(self) -> None:
        """Makes the first lists, by rules, and goes on from the best of them."""
        from irc.local_search.first_lists import first_lists

        free = constant(-1, self._size)
        found = [(self._take(order, free), order) for order in first_lists(self.listing)]
        self._take(min(found, key=lambda pair: pair[0])[1], free)
        worse = warm(self.listing.plan, self._work, self._lines, TRIALS)
        self._heat = min(1 << 50, max(1, int(worse)) * 1024)
        self._cycles = 0
        self._cycle(self._heat // AGAIN)

    def _next_cycle(self) -> None:
        """Begins a cycle at the best list, or, hotter, at the one that the search is at."""
        self._cycles += 1
        work, n = self._work, self._size
        if self._cycles % 2 or work[COUNTS, BEST] >= LACKING:
            self._cycle(self._heat)
        else:
            self._take(work[BEST_LIST, :n].copy(), work[BEST_WAY, :n].copy())
            self._cycle(self._heat // AGAIN)

    def _cycle(self, heat: int) -> None:
        counts = self._work[COUNTS]
        length = min(LONGEST_CYCLE, CYCLE << min(20, self._cycles // 2))
        counts[HEAT], counts[STEP], counts[LENGTH] = heat, 0, length * self._size

    def _take(self, order: Sequence[int], ways: Sequence[int]) -> int:
        arrays = ints(map(int, order)), ints(map(int, ways))
        return int(take(self.listing.plan, self._work, self._lines, *arrays))

    def _read(self, found: Found) -> int:
        """The value of a schedule of somebody else's, from which the search goes on then."""
        from irc.local_search.arcs import order_by

        decisions, pools = found
        order = order_by(self.problem, [int(d.start) for d in decisions])
        ways = [
            self._first_ways[i] + self.listing.way_of(i, decision.mode, pools[i])
            for i, decision in enumerate(decisions)
        ]
        return self._take(order, ways)
