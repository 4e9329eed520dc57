"""Searches the sequences of machines: tabu search from elite solutions and from between them.

Where activities hold one unit each of machines, or of a few interchangeable ones, a schedule is an
assignment to machines and a sequence for each. A few elite solutions are kept. A new one begins
between two of them, in the order of weighted means of their times, tabu search improves it, and
it takes the place of the worst, as in path relinking. Where that no longer leads to better ones,
all but the best are drawn anew.

Source: Peng, Lü, Cheng, "A tabu search/path relinking algorithm to solve the job shop scheduling
problem", Computers & Operations Research 53 (2015); here the path is not walked, its middle is
computed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from random import Random

from irc.local_search.arcs import arcs_of, order_by, urgencies
from irc.local_search.arrays import first_random, stacked
from irc.local_search.compiled import IS_COMPILED, Ints, constant, ints, table
from irc.local_search.dispatch import dispatched
from irc.local_search.tabu import (
    BEST,
    BEST_HEAD,
    BEST_ORDER,
    BEST_WAY,
    COLUMNS,
    COUNTS,
    IMPROVED_AT,
    LASTS,
    MACHINE,
    MACHINES,
    ORDERS,
    RANDOM,
    REACH,
    ROWS,
    SIZE,
    STEP,
    WAY_AT,
    Shop,
    load,
    search,
)
from irc.local_search.ways import Found, Ways, units_of

MOST_ARCS = 1 << 22

ELITE = 8
RENEWAL = 100
"""After this many solutions without a new best one, the elite is the best one and new ones."""

SPREAD = 0.3
"""The urgency of operations in the first solutions is more or less by up to this share."""

PATIENCE = 5_000
"""Steps without a better schedule after which tabu search begins elsewhere."""

_ACTIVITY_STEPS = 3_000_000 if IS_COMPILED else 5_000
"""The steps of one call are about this, divided by the number of activities."""

STEADY_STEPS = 50_000
"""The same for a steady search, with llvmlite and without it."""


@dataclass(frozen=True, slots=True)
class Solution:
    """The makespan, starts, a topological order, and a way (by its place in `Shop`) of each."""

    value: int
    starts: tuple[int, ...]
    order: tuple[int, ...]
    ways: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Machines:
    """A problem as a shop. Of way `w` of the shop, `numbers[w]` is the one in `Ways`."""

    shop: Shop
    numbers: tuple[int, ...]
    count: int


def machines_of(ways: Ways) -> Machines:
    """The shop of a problem. Raises `NotApplicable`."""
    problem = ways.problem
    units = units_of(ways)
    first = [0, *accumulate(units)]
    way_at, machine, lasts, numbers = [0], list[int](), list[int](), list[int]()
    for own in ways.of:
        for number, way in enumerate(own):
            taken: Sequence[int] = [-1]
            if way.held:
                ((pool, _),) = way.held
                taken = range(first[pool], first[pool + 1])
            machine += taken
            lasts += [way.duration] * len(taken)
            numbers += [number] * len(taken)
        way_at.append(len(machine))
    rows = (
        ints(a.release for a in problem.activities),
        *arcs_of(problem, after=False),
        *arcs_of(problem, after=True),
        ints(way_at),
        ints(machine),
        ints(lasts),
    )
    return Machines(stacked(rows), tuple(numbers), first[-1])


class ShopSearch:
    """The search of one problem, from the same seed always the same; `best` is what it has."""

    def __init__(self, ways: Ways, seed: int, target: int, *, steady: bool = False) -> None:
        self.ways, self.target = ways, target
        self.machines = machines_of(ways)
        self.best: Solution | None = None
        self._random = Random(seed)
        self._urgencies = urgencies(ways)
        orders = _orders(len(ways.problem.activities))
        self._walk = room_for(len(ways.of), self.machines.count, orders, seed)
        self._tabu = constant(0, orders + len(self.machines.numbers))
        self._elite: list[Solution] = []
        self._given: Solution | None = None
        self._in_vain = 0
        self._begun = False
        n = len(ways.problem.activities)
        self._steps = max(20, (STEADY_STEPS if steady else _ACTIVITY_STEPS) // max(1, n))

    def step(self) -> None:
        """Searches on for a little while."""
        if not self._begun:
            self._begin()
        walk = self._walk
        search(self.machines.shop, walk, self._tabu, self._steps, PATIENCE, self.target)
        if self.best is None or walk[COUNTS, BEST] < self.best.value:
            self.best = self._solution()
            self._in_vain = 0
        if walk[COUNTS, STEP] - walk[COUNTS, IMPROVED_AT] >= PATIENCE:
            self._keep(self._solution())
            self._begun = False

    def give(self, found: Found) -> None:
        """Gives a schedule of somebody else's, from which the search goes on in time."""
        order, ways = read(self.ways, self.machines, found)
        self._given = Solution(0, (), tuple(order), tuple(ways))

    @property
    def value(self) -> int | None:
        """The makespan of the best schedule so far, in ticks."""
        return None if self.best is None else self.best.value

    def found(self) -> Found | None:
        """The best schedule so far."""
        if self.best is None:
            return None
        numbers = [self.machines.numbers[w] for w in self.best.ways]
        return self.ways.found(self.best.starts, numbers)

    def _begin(self) -> None:
        """Goes to the next solution to begin from."""
        if self._given is not None:
            start, self._given = self._given, None
        elif len(self._elite) < ELITE:
            start = self._drawn()
        else:
            start = self._between(*self._random.sample(self._elite, 2))
        load(self.machines.shop, self._walk, self._tabu, ints(start.order), ints(start.ways))
        self._begun = True

    def _keep(self, solution: Solution) -> None:
        """Makes a solution one of the elite, in place of the worst, unless its equal is there."""
        self._in_vain += 1
        if self._in_vain > RENEWAL and self.best is not None:
            self._in_vain, self._elite = 0, [self.best]
        if any(solution.starts == other.starts for other in self._elite):
            return
        self._elite.append(solution)
        if len(self._elite) > ELITE:
            self._elite.remove(max(self._elite, key=lambda s: s.value))

    def _solution(self) -> Solution:
        walk, n = self._walk, len(self.ways.of)
        return Solution(
            int(walk[COUNTS, BEST]),
            tuple(map(int, walk[BEST_HEAD, :n])),
            tuple(map(int, walk[BEST_ORDER, :n])),
            tuple(map(int, walk[BEST_WAY, :n])),
        )

    def _between(self, one: Solution, other: Solution) -> Solution:
        """Between two solutions: times are weighted means, ways are of the one or the other."""
        share = self._random.uniform(0.3, 0.7)
        times = [(1 - share) * a + share * b for a, b in zip(one.starts, other.starts, strict=True)]
        # (Sorting is stable: what starts at the same time stays in the order of the first one.)
        order = sorted(one.order, key=times.__getitem__)
        ways = tuple(
            b if self._random.random() < share else a
            for a, b in zip(one.ways, other.ways, strict=True)
        )
        return Solution(0, (), tuple(order), ways)

    def _drawn(self) -> Solution:
        """A list schedule: the most urgent first, each on the machine where it ends first."""
        spread = SPREAD if self._elite else 0.0
        urgent = [t * self._random.uniform(1 - spread, 1 + spread) for t in self._urgencies]
        order, ways = dispatched(self.machines.shop, self.machines.count, urgent)
        return Solution(0, (), tuple(order), tuple(ways))


def read(ways: Ways, machines: Machines, found: Found) -> tuple[list[int], list[int]]:
    """A schedule as an order, and a way of the shop for each operation.

    The units of a pool go to who starts first.
    """
    decisions, pools = found
    way_at, machine, lasts = (machines.shop[row].tolist() for row in (WAY_AT, MACHINE, LASTS))
    order = order_by(ways.problem, [int(d.start) for d in decisions])
    free = [0] * machines.count
    taken = [0] * len(order)
    for i in order:
        number = ways.way_of(i, decisions[i].mode, pools[i])
        own = [w for w in range(way_at[i], way_at[i + 1]) if machines.numbers[w] == number]
        way = taken[i] = min(own, key=lambda w: free[machine[w]] if machine[w] >= 0 else 0)
        if machine[way] >= 0:
            free[machine[way]] = int(decisions[i].start) + lasts[way]
    return order, taken


def room_for(n: int, machines: int, orders: int, seed: int, reach: int | None = None) -> Ints:
    """Room for a walk through the solutions of a shop of `n` operations.

    `orders` is the room for orders of two operations that are tabu, `reach` the most places that
    a move goes within a critical block; by default as many as there are.
    """
    walk = table(ROWS, max(COLUMNS, n, machines))
    walk[COUNTS, SIZE] = n
    walk[COUNTS, MACHINES] = machines
    walk[COUNTS, ORDERS] = orders
    walk[COUNTS, RANDOM] = first_random(seed)
    walk[COUNTS, REACH] = n if reach is None else reach
    return walk


def _orders(n: int) -> int:
    """The room for orders of two operations that are tabu: a power of 2."""
    return int(min(1 << (n * n).bit_length(), MOST_ARCS))
