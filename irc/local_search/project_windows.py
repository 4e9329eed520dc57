"""Searches large projects window by window: a rolling horizon over the list of the best schedule.

List schedules with double justification come first. Then a window of the list, in the order of
starts, is a project of its own: what has begun before it gives releases, and takes its amounts for
as long as it lasts. The genetic search of `irc.local_search.project` makes it short, the first half
of it is fixed, and the window rolls on by as much. Every few windows what is fixed and the rest of
the list make a schedule of the whole.

Source: Debels and Vanhoucke, "A decomposition-based genetic algorithm for the
resource-constrained project-scheduling problem", Operations Research 55 (2007), for subprojects
cut out of a schedule.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from irc.local_search.arcs import adjacent, order_by, urgencies
from irc.local_search.compiled import IS_COMPILED, ints
from irc.local_search.genetic import BEST_START, BEST_WAY, COUNTS, MOST_ROUNDS, WAY_AT
from irc.local_search.project import ProjectSearch
from irc.local_search.ways import Found, NotApplicable, Way, Ways
from irc.problem import Activity, Arc, Bounds, ContendedPool, Window

SIZES = (120, 180, 80)
"""The activities of a window, in one pass after another."""

MANY = 20_000
BIRTHS = (300_000, 100_000) if IS_COMPILED else (500, 500)
"""Schedules of a window times its activities, of a project of up to `MANY` and of one of more: in
the same time more windows with fewer schedules each give about as much, and one pass is over
sooner.
"""

MEMBERS = 100
"""Of the population of a window."""

ROUNDS = 40_000
"""The activities that are justified in one step, at least once each."""

LEAST_GAIN = 2_000
"""The whole is justified again as long as a step of it makes it shorter by a part of this many."""

COMPLETIONS = 20
"""How often in a pass the whole is made of what is fixed and the rest, at least."""


class ProjectWindows(ProjectSearch):
    """The search of one large project, from the same seed always the same.

    Raises `irc.local_search.ways.NotApplicable` where activities use up stock.
    """

    def __init__(self, ways: Ways, seed: int, target: int) -> None:
        if ways.stock:
            raise NotApplicable("activities use up stock")
        super().__init__(ways, seed, target)
        self._seed = seed
        self._work[COUNTS, MOST_ROUNDS] = max(1, ROUNDS // max(1, len(ways.of)))
        lengths = [min(way.duration for way in own) for own in ways.of]
        self._tails = [u - d for u, d in zip(urgencies(ways), lengths, strict=True)]
        self._passes = 0
        self._pass: _Pass | None = None
        self._justified: int | None = None

    def step(self) -> None:
        """Makes the list schedule, justifies it, or searches one window."""
        if self.value is None:
            urgent = [-tail for tail in self._tails]
            self._list(order_by(self.ways.problem, urgent), self._quickest())
            return
        if self.value <= self.target:
            return
        if self._justifies():
            return
        if self._pass is None:
            self._pass = self._next_pass()
        rolling = self._pass
        rolling.roll()
        if rolling.is_over or rolling.rolled % rolling.between == 0:
            self._list(rolling.order(), rolling.chosen)
        if rolling.is_over:
            self._pass = None

    def _justifies(self) -> bool:
        """Justifies the whole once more, if it has become much shorter by the last time."""
        value, before = self.value or 0, self._justified
        if self._pass is not None or (before is not None and (before - value) * LEAST_GAIN < value):
            return False
        self._justified = value
        order, _, chosen = self._best()
        self._list(order, chosen)
        return True

    def give(self, found: Found) -> None:
        """Gives a schedule of somebody else's, which counts where it is better."""
        decisions, pools = found
        order = order_by(self.ways.problem, [int(d.start) for d in decisions])
        self._list(order, [self.ways.way_of(i, d.mode, pools[i]) for i, d in enumerate(decisions)])

    def _quickest(self) -> list[int]:
        return [min(range(len(o)), key=lambda k: o[k].duration) for o in self.ways.of]

    def _list(self, order: Sequence[int], chosen: Sequence[int]) -> None:
        """Makes a schedule of a list, and justifies it."""
        first = self.project[WAY_AT]
        self._take(ints(order), ints(first[i] + k for i, k in enumerate(chosen)))

    def _next_pass(self) -> _Pass:
        size = min(len(self.ways.of), SIZES[self._passes % len(SIZES)])
        self._passes += 1
        self._seed += 1
        births = BIRTHS[len(self.ways.of) > MANY] // size
        return _Pass(self.ways, self._tails, self._best(), size, births, self._seed)

    def _best(self) -> tuple[list[int], list[int], list[int]]:
        """The best schedule so far: its list, starts, and ways."""
        n, first = len(self.ways.of), self.project[WAY_AT]
        starts: list[int] = self._work[BEST_START, :n].tolist()
        chosen: list[int] = (self._work[BEST_WAY, :n] - first[:n]).tolist()
        return order_by(self.ways.problem, starts), starts, chosen


class _Pass:
    """One way of a window through the list, from its beginning."""

    def __init__(
        self,
        ways: Ways,
        tails: Sequence[int],
        schedule: tuple[list[int], list[int], list[int]],
        size: int,
        births: int,
        seed: int,
    ) -> None:
        """`schedule`: a list, starts and ways; `births`: the schedules of a window."""
        order, self._starts, self.chosen = schedule
        self.ways, self._births = ways, births
        self._tails, self._size, self._seed = tails, size, seed
        self._incoming = adjacent(ways.problem, after=False)
        self._rest, self._at = order, 0
        self._makespan = max((self._end(i) for i in order), default=0)
        self._open: list[int] = []
        self._fixed: list[int] = []
        self._running: list[int] = []
        self._now = 0
        self.rolled = 0
        self.between = max(1, 2 * len(order) // size // COMPLETIONS)

    @property
    def is_over(self) -> bool:
        """Whether all are fixed."""
        return not self._open and self._at == len(self._rest)

    def order(self) -> list[int]:
        """The list of all: what is fixed, the window, the rest."""
        return [*self._fixed, *self._open, *self._rest[self._at :]]

    def roll(self) -> None:
        """Searches the next window, and fixes the first half of it."""
        self.rolled += 1
        last = min(len(self._rest), self._at + self._size - len(self._open))
        more, self._at = self._rest[self._at : last], last
        window = [*self._open, *more]
        # (What is still to follow on the whole, if it takes as long as it does now.)
        following = self._makespan - max(self._end(i) for i in window)
        self._search(window, following)
        # (Stable: the window is in an order that precedence allows.)
        window.sort(key=self._starts.__getitem__)
        half = len(window) if self._at == len(self._rest) else (len(window) + 1) // 2
        fixed, self._open = window[:half], window[half:]
        self._fixed += fixed
        self._now = max(self._now, *(self._starts[i] for i in fixed))
        self._running = [i for i in (*self._running, *fixed) if self._end(i) > self._now]

    def _end(self, i: int) -> int:
        return self._starts[i] + self.ways.of[i][self.chosen[i]].duration

    def _search(self, window: Sequence[int], following: int) -> None:
        """Takes the starts and ways of the best schedule of a window."""
        ways = self._project(window, following)
        behind = [0] * (len(ways.of) - len(window))
        seed = self._seed + self.rolled
        search = ProjectSearch(ways, seed, 0, births=self._births, members=MEMBERS, justifies=True)
        # (The time of a window begins with it: a grid has no room for all that was before.)
        starts = [self._starts[i] - self._now for i in window]
        numbers = [self.chosen[i] for i in window]
        search.give(ways.found([*starts, *behind], [*numbers, *behind]))
        search.step()
        found = search.found()
        if found is None:
            return
        for k, i in enumerate(window):
            decision, pools = found[0][k], found[1][k]
            self._starts[i] = self._now + int(decision.start)
            self.chosen[i] = ways.way_of(k, decision.mode, pools)

    def _project(self, window: Sequence[int], following: int) -> Ways:
        """The ways of a window as a project of its own.

        Behind it there is an activity that takes nothing for each that has more to follow it than
        the whole has.
        """
        problem = self.ways.problem
        place = {i: k for k, i in enumerate(window)}
        activities, arcs = list[Activity](), list[Arc]()
        for k, i in enumerate(window):
            release = max(problem.activities[i].release - self._now, 0)
            for j, lag in self._incoming[i]:
                if j in place:
                    arcs.append(Arc(place[j], k, min_lag=lag))
                else:
                    release = max(release, self._end(j) + lag - self._now)
            activities.append(replace(problem.activities[i], release=release))
        of = [self.ways.of[i] for i in window]
        for k, i in enumerate(window):
            if (rest := self._tails[i] - following) > 0:
                arcs.append(Arc(k, len(of)))
                activities.append(Activity("", rest, rest))
                of.append((Way(None, (), rest, ()),))
        pools = tuple(self._left(r, pool) for r, pool in enumerate(problem.contention.pools))
        part = replace(
            problem,
            activities=tuple(activities),
            arcs=tuple(arcs),
            contention=replace(problem.contention, pools=pools, fixed_choices={}),
            bounds=Bounds(),
        )
        return Ways(part, tuple(of), ())

    def _left(self, r: int, pool: ContendedPool) -> ContendedPool:
        """A pool without what is held of it by activities that have begun before the window."""
        changes: Counter[int] = Counter()
        for i in self._running:
            for held, amount in self.ways.of[i][self.chosen[i]].held:
                if held == r:
                    changes[0] += amount
                    changes[self._end(i) - self._now] -= amount
        levels = [(max(0, at - self._now), level) for at, level in pool.levels()]
        if not changes and len(levels) == 1:
            return pool
        times = sorted({*changes, *(at for at, _ in levels)})
        windows, taken, level = list[Window](), 0, 0
        for time, after in zip(times, [*times[1:], times[-1] + 1], strict=True):
            taken += changes[time]
            level = next((n for at, n in reversed(levels) if at <= time), level)
            windows.append(Window(time, after, level - taken))
        return replace(pool, base=levels[-1][1], windows=tuple(windows))
