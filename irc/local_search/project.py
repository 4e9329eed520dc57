"""Searches lists of activities: populations, one after another, that evolve."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

from irc.local_search.arcs import arcs_of, order_by, urgencies
from irc.local_search.compiled import IS_COMPILED, Ints, constant, ints, kept_or_not, table
from irc.local_search.genetic import (
    BEST,
    BEST_START,
    BEST_WAY,
    BIRTHS,
    COLUMNS,
    COUNTS,
    IMPROVED_AT,
    JUSTIFIES,
    RANDOM,
    ROWS,
    SIZE,
    Project,
    draw,
    evolve,
    store,
    take,
)
from irc.local_search.ways import Found, Ways

POPULATION = 60
PATIENCE = 100
"""Per member, the children without a better schedule after which another population begins."""

SPREAD = 60
"""The urgency of activities in the first lists of a population is raised by up to this, percent."""

_ACTIVITY_BIRTHS = 300_000 if IS_COMPILED else 500
"""The children of one call are about this, divided by the number of activities."""


class ProjectSearch:
    """The search of one problem, from the same seed always the same."""

    def __init__(self, ways: Ways, seed: int, target: int) -> None:
        self.ways, self.target = ways, target
        self.project, self._held = _project(ways)
        n, pools = len(ways.of), max(1, len(ways.problem.contention.pools))
        nodes = 2 * n + 2 + len(self.project[18])
        self._work = table(ROWS, max(COLUMNS, n, nodes, len(ways.stock)))
        self._use = table(nodes, pools)
        self._lists, self._ways = table(POPULATION, n), table(POPULATION, n)
        self._values = constant(1 << 60, POPULATION)
        self._members = 0
        self._given: list[tuple[Ints, Ints]] = []
        counts = self._work[COUNTS]
        counts[SIZE], counts[BEST] = n, 1 << 60
        counts[JUSTIFIES] = not any(pool.windows for pool in ways.problem.contention.pools)
        counts[RANDOM] = 1 + (seed * 7919 + 12345) % 2147483646
        self._births = max(1, _ACTIVITY_BIRTHS // max(1, n))

    def step(self) -> None:
        """Searches on for a little while."""
        counts = self._work[COUNTS]
        for _ in range(self._births):
            if self._members == POPULATION or counts[BEST] <= self.target:
                break
            self._add()
        else:
            return
        rooms = self._lists, self._ways, self._values
        while self._given:
            self._take(*self._given.pop())
        kept_or_not(
            evolve,
            self.project,
            self._held,
            self._work,
            self._use,
            *rooms,
            self._births,
            self.target,
        )
        if counts[BIRTHS] - counts[IMPROVED_AT] > PATIENCE * POPULATION:
            counts[BIRTHS] = counts[IMPROVED_AT] = 0
            self._members = 0

    def give(self, found: Found) -> None:
        """Gives a schedule of somebody else's, which joins the population in time."""
        decisions, pools = found
        order = order_by(self.ways.problem, [int(d.start) for d in decisions])
        numbers = [self.ways.way_of(i, d.mode, pools[i]) for i, d in enumerate(decisions)]
        first = self.project[7]
        self._given.append((ints(order), ints(first[i] + k for i, k in enumerate(numbers))))

    def found(self) -> Found | None:
        """The best schedule so far."""
        work, n = self._work, len(self.ways.of)
        if work[COUNTS, BEST] >= 1 << 60:
            return None
        first = self.project[7]
        return self.ways.found(work[BEST_START, :n], work[BEST_WAY, :n] - first[:n])

    @property
    def value(self) -> int | None:
        """The makespan of the best schedule so far, in ticks."""
        best = int(self._work[COUNTS, BEST])
        return None if best >= 1 << 60 else best

    def _add(self) -> None:
        """Adds a member to the population that is drawn at random."""
        spread = SPREAD if self._members else 0
        value = kept_or_not(draw, self.project, self._held, self._work, self._use, spread)
        kept_or_not(store, self._work, self._lists, self._ways, self._values, self._members, value)
        self._members += 1

    def _take(self, order: Ints, ways: Ints) -> None:
        value = kept_or_not(take, self.project, self._held, self._work, self._use, order, ways)
        worst = int(self._values.argmax())
        kept_or_not(store, self._work, self._lists, self._ways, self._values, worst, value)


def _project(ways: Ways) -> tuple[Project, Ints]:
    """The arrays of a problem, and the room that what each way holds needs: see `_is_full`."""
    problem = ways.problem
    flat = [way for own in ways.of for way in own]
    pools = problem.contention.pools
    held = [(r, pools[r].capacity - n, n) for way in flat for r, n in way.held]
    used = [pair for way in flat for pair in way.used_up]
    base_time, base_use = _base(ways)
    n = len(problem.activities)
    project = (
        ints(a.release for a in problem.activities),
        *arcs_of(problem, after=False),
        *arcs_of(problem, after=True),
        ints([0, *accumulate(map(len, ways.of))]),
        ints(way.duration for way in flat),
        ints([0, *accumulate(len(way.held) for way in flat)]),
        ints(r for r, _, _ in held),
        ints(amount for _, _, amount in held),
        ints([0, *accumulate(len(way.used_up) for way in flat)]),
        ints(s for s, _ in used),
        ints(amount for _, amount in used),
        ints(pool.capacity for pool in pools),
        ints(ways.stock),
        constant(0, n),
        ints(base_time),
        ints(base_use),
        ints(urgencies(ways)),
    )
    return project, ints(number for row in held for number in row)


def _base(ways: Ways) -> tuple[Sequence[int], Sequence[int]]:
    """The times at which capacities change, and what of each pool is missing from then on."""
    from irc.problem.resources import capacity_levels

    pools = ways.problem.contention.pools
    levels = [
        [*capacity_levels(pool.capacity if pool.base is None else pool.base, pool.windows)]
        for pool in pools
    ]
    times = sorted({0, *(at for own in levels for at, _ in own)})
    missing: list[int] = []
    for time in times:
        for pool, own in zip(pools, levels, strict=True):
            missing.append(pool.capacity - [n for at, n in own if at <= time][-1])
    return times, missing or [0]
