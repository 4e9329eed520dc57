"""Searches large shops window by window: list schedules first, then tabu search in a part of time.

A window is a contiguous part of a topological order by start. The operations before it give its
operations releases, and those behind it give times that must still follow: to the makespan of the
whole, nothing else matters, since no path leaves a window and comes back. So tabu search works on
the window alone, with an operation without a machine for each time that must follow. Windows
overlap by half, and pass through the schedule again and again, with more patience each time. An
operation keeps the machine that its list schedule chose.

Source, for windows of time: Pacino and Van Hentenryck, "Large neighborhood search and adaptive
randomized decompositions for flexible jobshop scheduling", IJCAI (2011).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from irc.local_search import active_lists
from irc.local_search.arcs import urgencies
from irc.local_search.arrays import columns, places, stacked
from irc.local_search.compiled import IS_COMPILED, Ints, constant, ints, table
from irc.local_search.shop import machines_of, read, room_for
from irc.local_search.tabu import (
    AFTER,
    AFTER_AT,
    AFTER_LAG,
    BEFORE,
    BEFORE_AT,
    BEFORE_LAG,
    BEST,
    BEST_ORDER,
    COUNTS,
    DURATION,
    HEAD,
    LASTS,
    LEFT,
    MACHINE,
    MAKESPAN,
    ORDER,
    RELEASE,
    RIGHT,
    TAIL,
    WAY,
    Shop,
    load,
    search,
)
from irc.local_search.ways import Found, Ways

SIZES = (2000, 3000)
"""The operations of a window, in one pass after another."""

PATIENCE = 4_000
MOST_PATIENCE = 32_000
"""The steps of tabu search without a better schedule after which it leaves a window: in the first
pass, and the most, to which they double with each size.
"""

REACH = 6
"""The most places that a move goes within a critical block. Those of large windows are long, and
all moves within one take more than in proportion.
"""

DELAYS = (0, 25)
"""How long machines wait in list schedules, in percent: see `irc.local_search.active_lists`."""

_STEPS = 1_000 if IS_COMPILED else 5
"""The steps of tabu search in one call."""

_ORDERS = 1 << 20
"""The room for orders of two operations that are tabu in a window."""


@dataclass(slots=True)
class _Open:
    """A window that is searched: its place in the order, its operations, and the search."""

    begin: int
    order: Ints
    chosen: list[int]
    shop: Shop
    size: int
    walk: Ints
    tabu: Ints
    before: int


class ShopWindows:
    """The search of one large shop, from the same seed always the same."""

    def __init__(self, ways: Ways, seed: int, target: int) -> None:
        self.ways, self.target = ways, target
        self.machines = machines_of(ways)
        self._arrays = [array.tolist() for array in self.machines.shop]
        n, count = len(ways.of), self.machines.count
        self._walk = room_for(n, count, 1, seed)
        # (The walk of the whole is only loaded, never searched: it needs no room for what is tabu.)
        self._tabu = constant(0, 1)
        self._seed, self._passes = seed, 0
        self._value: int | None = None
        self._given: list[Found] = []
        self._cuts: Iterator[tuple[int, int]] = iter(())
        self._open: _Open | None = None

    def step(self) -> None:
        """Makes a list schedule, or searches a window for a little while."""
        if self._value is None:
            self._list()
            return
        if self._given:
            self._take(self._given.pop())
        if self._value <= self.target:
            return
        if self._open is None:
            self._open = self._opened(*self._next_cut())
        window = self._open
        done = search(window.shop, window.walk, window.tabu, _STEPS, self._patience, self.target)
        if done < _STEPS:
            self._close(window)
            self._open = None

    def give(self, found: Found) -> None:
        """Gives a schedule of somebody else's, which counts where it is better."""
        self._given.append(found)

    @property
    def value(self) -> int | None:
        """The makespan of the best schedule so far, in ticks."""
        return self._value

    def found(self) -> Found | None:
        """The best schedule so far."""
        if self._value is None:
            return None
        n = len(self.ways.of)
        numbers = [self.machines.numbers[w] for w in self._walk[WAY, :n].tolist()]
        return self.ways.found(self._walk[HEAD, :n].tolist(), numbers)

    @property
    def _patience(self) -> int:
        return min(MOST_PATIENCE, PATIENCE << (self._passes // 2))

    def _list(self) -> None:
        """Takes the best of some list schedules: by tails, with and without the own duration."""
        shop, n = self.machines.shop, len(self.ways.of)
        tails = urgencies(self.ways)
        shortest = [min(way.duration for way in own) for own in self.ways.of]
        rests = [tail - lasts for tail, lasts in zip(tails, shortest, strict=True)]
        count = self.machines.count
        work = table(active_lists.ROWS, max(n, count))
        for urgency in (ints(rests), ints(tails)):
            for delay in DELAYS:
                value = active_lists.listed(shop, work, count, urgency, delay)
                if self._value is None or value < self._value:
                    self._load(work[active_lists.ORDER, :n], work[active_lists.WAY, :n])

    def _load(self, order: Ints, way: Ints) -> None:
        """Makes a solution the current one."""
        load(self.machines.shop, self._walk, self._tabu, order, way)
        self._value = int(self._walk[COUNTS, MAKESPAN])

    def _take(self, found: Found) -> None:
        """Takes a schedule of somebody else's where it is better."""
        decisions, _ = found
        if self._value is not None and max(int(d.end) for d in decisions) >= self._value:
            return
        order, ways = read(self.ways, self.machines, found)
        self._load(ints(order), ints(ways))
        self._open = None

    def _next_cut(self) -> tuple[int, int]:
        """The next window: from the end of the schedule, then from its beginning, and again."""
        cut = next(self._cuts, None)
        if cut is not None:
            return cut
        n = len(self.ways.of)
        size = min(n, SIZES[self._passes // 2 % len(SIZES)])
        first = [*range(0, max(1, n - size // 2), max(1, size // 2))]
        if self._passes % 2 == 0:
            first.reverse()
        self._passes += 1
        self._cuts = ((at, min(n, at + size)) for at in first)
        return next(self._cuts)

    def _opened(self, begin: int, end: int) -> _Open:
        """The window of the operations from one place to another, in the order of their starts."""
        walk, n = self._walk, len(self.ways.of)
        # (Stable: of operations that start at the same time the first one stays the first.)
        order = walk[ORDER, :n][walk[HEAD, walk[ORDER, :n]].argsort(kind="stable")]
        chosen: list[int] = order[begin:end].tolist()
        shop, size = _cut(self._arrays, walk, chosen, self.machines.count)
        self._seed += 1
        room = room_for(size, self.machines.count, _ORDERS, self._seed, REACH)
        tabu = constant(0, _ORDERS + size)
        load(shop, room, tabu, ints(range(size)), ints(range(size)))
        return _Open(begin, order, chosen, shop, size, room, tabu, int(room[COUNTS, BEST]))

    def _close(self, window: _Open) -> None:
        """Takes what a window has found, if the whole is no worse with it."""
        if int(window.walk[COUNTS, BEST]) >= window.before or self._value is None:
            return
        count, value = len(window.chosen), self._value
        found = window.walk[BEST_ORDER, : window.size].tolist()
        n = len(self.ways.of)
        old, ways = self._walk[ORDER, :n].copy(), self._walk[WAY, :n].copy()
        order = window.order.copy()
        order[window.begin : window.begin + count] = [window.chosen[k] for k in found if k < count]
        self._load(order, ways)
        if self._value > value:
            self._load(old, ways)


def _cut(
    arrays: Sequence[Sequence[int]], walk: Ints, chosen: Sequence[int], machines: int
) -> tuple[Shop, int]:
    """The shop of operations that are contiguous in a topological order, and its size.

    Behind them it has an operation without a machine for each time that must follow some of them.
    """
    ways = walk[WAY, chosen].tolist()
    machine = [arrays[MACHINE][w] for w in ways]
    lasts = [arrays[LASTS][w] for w in ways]
    place = {i: k for k, i in enumerate(chosen)}
    ends, rests = walk[HEAD] + walk[DURATION], walk[TAIL] + walk[DURATION]
    free, after = _outside(walk, chosen, machine, place, machines)
    releases, before = list[int](), list[list[tuple[int, int]]]()
    follows: list[tuple[int, list[tuple[int, int]]]] = []
    on_machine: dict[int, list[tuple[int, int]]] = {}
    for k, i in enumerate(chosen):
        own, rest, m = list[tuple[int, int]](), 0, machine[k]
        release = max(arrays[RELEASE][i], free[m])
        for a in range(arrays[BEFORE_AT][i], arrays[BEFORE_AT][i + 1]):
            j, lag = arrays[BEFORE][a], arrays[BEFORE_LAG][a]
            if j in place:
                own.append((place[j], lag))
            else:
                release = max(release, int(ends[j]) + lag)
        for a in range(arrays[AFTER_AT][i], arrays[AFTER_AT][i + 1]):
            j = arrays[AFTER][a]
            if j not in place:
                rest = max(rest, int(rests[j]) + arrays[AFTER_LAG][a])
        releases.append(release)
        before.append(own)
        if rest > after[m]:
            follows.append((rest, [(k, 0)]))
        if after[m]:
            on_machine.setdefault(m, []).append((k, 0))
    follows += [(after[m], own) for m, own in on_machine.items()]
    return _shop(
        [*releases, *(0 for _ in follows)],
        [*before, *(own for _, own in follows)],
        [*machine, *(-1 for _ in follows)],
        [*lasts, *(rest for rest, _ in follows)],
    )


def _outside(
    walk: Ints,
    chosen: Sequence[int],
    machine: Sequence[int],
    place: dict[int, int],
    machines: int,
) -> tuple[list[int], list[int]]:
    """When each machine is free for a window, and the time that follows on it; last, no machine."""
    free, after = [0] * (machines + 1), [0] * (machines + 1)
    left, right = walk[LEFT, chosen].tolist(), walk[RIGHT, chosen].tolist()
    for k, m in enumerate(machine):
        if left[k] >= 0 and left[k] not in place:
            free[m] = int(walk[HEAD, left[k]] + walk[DURATION, left[k]])
        if right[k] >= 0 and right[k] not in place:
            after[m] = int(walk[TAIL, right[k]] + walk[DURATION, right[k]])
    return free, after


def _shop(
    releases: Sequence[int],
    before: Sequence[Sequence[tuple[int, int]]],
    machine: Sequence[int],
    lasts: Sequence[int],
) -> tuple[Shop, int]:
    """The shop of operations with one way each, and their number."""
    behind: list[list[tuple[int, int]]] = [[] for _ in releases]
    for k, own in enumerate(before):
        for j, lag in own:
            behind[j].append((k, lag))
    rows = (
        ints(releases),
        *(places(before), *columns(before, 2)),
        *(places(behind), *columns(behind, 2)),
        ints(range(len(releases) + 1)),
        ints(machine),
        ints(lasts),
    )
    return stacked(rows), len(releases)
