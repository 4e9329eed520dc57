"""Searches lists of activities: populations, one after another, that evolve."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from irc.local_search.arcs import arcs_of, order_by, urgencies
from irc.local_search.arrays import first_random, places
from irc.local_search.compiled import IS_COMPILED, Ints, constant, ints, table
from irc.local_search.genetic import (
    BASE_TIME,
    BASE_USE,
    BEST,
    BEST_START,
    BEST_WAY,
    BIRTHS,
    COLUMNS,
    COUNTS,
    GUARD,
    IMPROVED_AT,
    JUSTIFIES,
    MOST,
    MOST_ROUNDS,
    PART_TICKS,
    PARTS,
    RANDOM,
    ROWS,
    SIZE,
    TICKS,
    WAY_AT,
    Project,
    draw,
    evolve,
    lay_grid,
    store,
    take,
)
from irc.local_search.ways import Found, NotApplicable, Way, Ways
from irc.problem import Problem
from irc.problem.horizon import safe_horizon

LEAST_POPULATION = 100
MOST_POPULATION = 1000
ACTIVITY_MEMBERS = 120_000
"""The members of a population are about this, divided by the number of activities, so that it has
some hundred children for each within seconds. A steady search has the fewest, as does one without
llvmlite.
"""

PATIENCE = 100
"""Per member, the children none of which is better than all, after which another population begins.
"""

SPREAD = 60
"""The urgency of activities in the first lists of a population is raised by up to this, percent."""

MOST_TICKS = 1 << 14
MOST_MEAN_TICKS = 50
"""The most ticks of the horizon, and of an activity on average, for which there is a grid."""

_WORD_BITS = 62

_ACTIVITY_BIRTHS = 300_000 if IS_COMPILED else 500
"""The children of one call are about this, divided by the number of activities."""

STEADY_BIRTHS = 5_000
"""The same for a steady search, with llvmlite and without it."""


class ProjectSearch:
    """The search of one problem, from the same seed always the same."""

    def __init__(
        self,
        ways: Ways,
        seed: int,
        target: int,
        *,
        steady: bool = False,
        births: int | None = None,
        members: int | None = None,
        justifies: bool = False,
    ) -> None:
        """`births`: of one step; `members`: of a population; `justifies`: schedules are justified
        where capacities change, too.

        (From the end they count as they are last. So it pays where they change at the beginning.)
        """
        self.ways, self.target = ways, target
        ticks = _ticks(ways)
        self.project = _project(ways, ticks)
        n, words = len(ways.of), max(1, len(self.project[GUARD]))
        nodes = ticks or 2 * n + 2 + len(self.project[BASE_TIME])
        self._work = table(ROWS, max(COLUMNS, n + 1, nodes, len(ways.stock)))
        self._use = table(words, ticks) if ticks else table(nodes, words)
        few = steady or not IS_COMPILED
        usual_members = LEAST_POPULATION if few else _population(n)
        self._population = usual_members if members is None else members
        self._lists, self._starts, self._ways = (table(self._population, n) for _ in range(3))
        self._values = constant(MOST, self._population)
        self._members = 0
        self._given: list[tuple[Ints, Ints]] = []
        counts = self._work[COUNTS]
        counts[SIZE], counts[BEST] = n, MOST
        changes = any(pool.windows for pool in ways.problem.contention.pools)
        counts[JUSTIFIES] = justifies or not changes
        counts[MOST_ROUNDS] = MOST
        counts[PARTS] = n + 1
        counts[PART_TICKS] = 1 + _longest(ways) // (n + 1)
        if ticks:
            counts[TICKS] = ticks
            lay_grid(self._work, self._use, self.project[BASE_USE])
        counts[RANDOM] = first_random(seed)
        usual = (STEADY_BIRTHS if steady else _ACTIVITY_BIRTHS) // max(1, n)
        self._births = max(1, usual if births is None else births)

    def step(self) -> None:
        """Searches on for a little while."""
        counts = self._work[COUNTS]
        for _ in range(self._births):
            if self._members == self._population or counts[BEST] <= self.target:
                break
            self._add()
        else:
            return
        rooms = self._lists, self._starts, self._ways, self._values
        while self._given:
            self._take(*self._given.pop())
        evolve(
            self.project,
            self._work,
            self._use,
            *rooms,
            self._births,
            self.target,
        )
        if counts[BIRTHS] - counts[IMPROVED_AT] > PATIENCE * self._population:
            counts[BIRTHS] = counts[IMPROVED_AT] = 0
            self._members = 0

    def give(self, found: Found) -> None:
        """Gives a schedule of somebody else's, which joins the population in time."""
        decisions, pools = found
        order = order_by(self.ways.problem, [int(d.start) for d in decisions])
        numbers = [self.ways.way_of(i, d.mode, pools[i]) for i, d in enumerate(decisions)]
        first = self.project[WAY_AT]
        self._given.append((ints(order), ints(first[i] + k for i, k in enumerate(numbers))))

    def found(self) -> Found | None:
        """The best schedule so far."""
        work, n = self._work, len(self.ways.of)
        if work[COUNTS, BEST] >= MOST:
            return None
        first = self.project[WAY_AT]
        return self.ways.found(work[BEST_START, :n], work[BEST_WAY, :n] - first[:n])

    @property
    def value(self) -> int | None:
        """The makespan of the best schedule so far, in ticks."""
        best = int(self._work[COUNTS, BEST])
        return None if best >= MOST else best

    def _add(self) -> None:
        """Adds a member to the population that is drawn at random."""
        spread = SPREAD if self._members else 0
        value = draw(self.project, self._work, self._use, spread)
        store(
            self._work,
            self._lists,
            self._starts,
            self._ways,
            self._values,
            self._members,
            value,
        )
        self._members += 1

    def _take(self, order: Ints, ways: Ints) -> None:
        value = take(self.project, self._work, self._use, order, ways)
        worst = int(self._values.argmax())
        store(self._work, self._lists, self._starts, self._ways, self._values, worst, value)


def _population(activities: int) -> int:
    """The members of a population."""
    fitting = ACTIVITY_MEMBERS // max(1, activities)
    return min(MOST_POPULATION, max(LEAST_POPULATION, fitting))


def _longest(ways: Ways) -> int:
    """The ticks within which every list has a schedule."""
    # (A list can have a schedule that ends after a deadline, which is then no answer.)
    return safe_horizon(replace(ways.problem, deadline=None, horizon=None))


def _ticks(ways: Ways) -> int:
    """The ticks of a grid on which every list has a schedule; 0 where nodes are better."""
    durations = [max(way.duration for way in own) for own in ways.of]
    ticks = _longest(ways) + 2
    few = sum(durations) <= MOST_MEAN_TICKS * len(durations)
    return ticks if few and ticks <= MOST_TICKS else 0


def _project(ways: Ways, ticks: int) -> Project:
    """The arrays of a problem."""
    problem = ways.problem
    flat = [way for own in ways.of for way in own]
    _refuse_temporary(problem, flat)
    fields = _fields(problem)
    held = [_packed(way.held, fields) for way in flat]
    used = [pair for way in flat for pair in way.used_up]
    base_time, base_use = _base(ways, fields)
    last_use = base_use[-1:]
    if ticks:
        last_use = [own * ticks for own in last_use]
        ends = [*base_time[1:], ticks]
        lengths = [end - begin for begin, end in zip(base_time, ends, strict=True)]
        base_use = [own * length for own, length in zip(base_use, lengths, strict=True)]
    n = len(problem.activities)
    return (
        ints(a.release for a in problem.activities),
        *arcs_of(problem, after=False),
        *arcs_of(problem, after=True),
        places(ways.of),
        ints(way.duration for way in flat),
        places(held),
        ints(word for own in held for word in own),
        ints(amount for own in held for amount in own.values()),
        places(way.used_up for way in flat),
        ints(s for s, _ in used),
        ints(amount for _, amount in used),
        ints(_packed([(r, 1 << bits) for r, (_, _, bits) in enumerate(fields)], fields).values()),
        ints(ways.stock),
        constant(0, n),
        ints(base_time),
        ints(word for own in base_use for word in own),
        ints(urgencies(ways)),
        ints([0]),
        ints(word for own in last_use for word in own),
    )


def _refuse_temporary(problem: Problem, flat: Sequence[Way]) -> None:
    """Raises `NotApplicable` where a way fits only in windows, so that it may come too late."""
    last = [[*pool.levels()][-1][1] for pool in problem.contention.pools]
    for way in flat:
        for r, amount in way.held:
            if amount > last[r]:
                pool = problem.contention.pools[r]
                raise NotApplicable(f"{pool.id!r} has enough capacity for a while only")


_Field = tuple[int, int, int]
"""Of a pool: the word, its lowest bit, and the bits that its capacity needs."""


def _fields(problem: Problem) -> list[_Field]:
    """A field in a word for each pool, with one bit more than its capacity needs."""
    fields: list[_Field] = []
    word = at = 0
    for pool in problem.contention.pools:
        bits = pool.capacity.bit_length()
        if bits >= _WORD_BITS:
            raise NotApplicable(f"{pool.id!r} has a capacity that is too large")
        if at + bits + 1 > _WORD_BITS:
            word, at = word + 1, 0
        fields.append((word, at, bits))
        at += bits + 1
    return fields


def _packed(amounts: Iterable[tuple[int, int]], fields: Sequence[_Field]) -> dict[int, int]:
    """Amounts of pools as words, in the order of the words."""
    words: dict[int, int] = {}
    for r, amount in sorted(amounts):
        word, at, _ = fields[r]
        words[word] = words.get(word, 0) + (amount << at)
    return words


def _base(ways: Ways, fields: Sequence[_Field]) -> tuple[list[int], list[list[int]]]:
    """The times at which capacities change, and the words of the profile from each on.

    A pool's field holds the amount that lacks to a capacity of all bits, so that one unit more than
    fits reaches the bit above.
    """
    pools = ways.problem.contention.pools
    levels = [[*pool.levels()] for pool in pools]
    times = sorted({0, *(at for own in levels for at, _ in own)})
    words = []
    for time in times:
        present = [[n for at, n in own if at <= time][-1] for own in levels]
        missing = [(r, (1 << fields[r][2]) - 1 - n) for r, n in enumerate(present)]
        words.append([*_packed(missing, fields).values()] or [0])
    return times, words
