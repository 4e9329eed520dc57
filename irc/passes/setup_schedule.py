"""List schedules with set-ups: one activity after another, each behind the last use.

The first order is that of a dispatching rule that weighs urgency against set-ups (apparent
tardiness cost with set-ups: Lee, Bhaskaran, Pinedo, "A heuristic to minimize the total weighted
tardiness with sequence-dependent setups", 1997), or the longest rest first. It is improved by
moving activities, with late acceptance (Burke, Bykov, "The late acceptance hill-climbing
heuristic", 2017). The result is a hint and an upper bound, not an answer: where limits defeat the
rule, there is no result.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from copy import copy
from math import exp
from typing import TYPE_CHECKING

from irc.passes.resource_profile import UNREACHABLE_TIME, Profile
from irc.problem import NO_FAMILY, NO_SETUP, Activity, ContendedPool, OpenDemand, Problem, Setup
from irc.problem.decisions import Decision
from irc.problem.setups import setups_from_now

if TYPE_CHECKING:
    from irc.passes.setup_work import WorkSpots

Choice = tuple[int, ...]

Fit = tuple[int, int, int, Choice]
"""The start, the end, the time of the set-ups before it, and the pool of each open demand."""

Found = tuple[list[Decision], list[Choice]]
"""Starts and ends in ticks, and for each activity the pool of each open demand."""

Key = tuple[int, ...]
"""By how much limits are broken, then the objectives in order; less is better."""

WORK = 20_000
"""At most about this many activities are placed to improve a schedule that a pass makes."""

SLOWER = 4
"""Placing among open times takes about this many times as long."""

ROUNDS = 8
"""How often each activity is moved for it, on average, at most."""

LOOK = 20
"""How many orders are tried between two looks at the time."""

_VALUED = frozenset(["makespan", "tardiness", "setup_time", "setup_cost"])

HISTORY = 50
"""A new order is accepted if it is no worse than the one this many orders ago."""


def setup_schedule(problem: Problem) -> Found | None:
    """An improved list schedule; None for a problem with other choices, or where none is found."""
    search = search_of(problem)
    if search is None:
        return None
    size = len(problem.activities)
    work = WORK // SLOWER if problem.has_work else WORK
    search.improve(min(work // size, ROUNDS * size))
    return search.found


def search_of(problem: Problem) -> SetupSearch | None:
    """The search for list schedules of a problem, with a first one; None where it does not apply.

    It knows modes, `one_of`, calendars and pauses, and no state, stock, choices that depend on each
    other, nor activities that may be absent.
    """
    if problem.sequences or any(r.setups is not None and r.setups.tight for r in problem.resources):
        return None
    if problem.couplings or problem.selections:
        return None
    if (
        problem.has_state
        or problem.has_batches
        or problem.reservoirs
        or not all(g.required for g in problem.groups)
    ):
        return None
    if not problem.activities or any(
        a.details.optional or a.details.repeats or a.details.stock for a in problem.activities
    ):
        return None
    search = SetupSearch(problem)
    return search if search.begin() else None


class Way:
    """One way to carry out an activity: its mode, its duration, and its open demands."""

    __slots__ = ("demands", "duration", "mode")

    def __init__(self, activity: Activity, mode: int | None) -> None:
        details = activity.details
        self.mode = mode
        self.duration = activity.duration_min if mode is None else details.modes[mode].duration_min
        self.demands: list[tuple[OpenDemand, int]] = [
            (demand, activity.uses[demand.use].family)
            for demand in activity.open_demands
            if details.use_mode(demand.use) in (None, mode)
        ]


class _Line:
    """The last family of a resource with set-ups, and since when it is free."""

    __slots__ = ("cost", "family", "free", "table", "time")

    def __init__(self, problem: Problem, pool: ContendedPool) -> None:
        setups, past = setups_from_now(problem, pool.members[0])
        families = {use.family for activity in problem.activities for use in activity.uses} | {
            NO_FAMILY
        }
        before = families if setups.initial is None else families | {setups.initial}
        self.table: dict[tuple[int | None, int], Setup] = {
            (a, b): setups.between(a, b) for a in before for b in families
        }
        self.table |= {(None, b): NO_SETUP for b in families}
        self.family, self.free = setups.initial, setups.since
        self.time, self.cost = past.time, past.cost


class SetupSearch:
    """List schedules of one problem; the best of them that keeps all limits is `found`."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.size = problem, len(problem.activities)
        modes = [range(len(a.details.modes)) or (None,) for a in problem.activities]
        self.ways = [
            [Way(a, m) for m in own] for a, own in zip(problem.activities, modes, strict=True)
        ]
        self.before: list[list[int]] = [[] for _ in range(self.size)]
        self.after: list[list[int]] = [[] for _ in range(self.size)]
        self.incoming: list[list[int]] = [[] for _ in range(self.size)]
        for k, arc in enumerate(problem.arcs):
            self.incoming[arc.after].append(k)
            self.before[arc.after].append(arc.before)
            self.after[arc.before].append(arc.after)
        pools = problem.contention.pools
        self.first_profiles = [Profile(pool) for pool in pools]
        self.first_lines = [
            _Line(problem, p) if problem.resources[p.members[0]].setups is not None else None
            for p in pools
        ]
        self.heads = problem.bounds.heads or tuple(a.release for a in problem.activities)
        self.tails = problem.bounds.tails or (0,) * self.size
        self.order: list[int] = []
        self.key: Key = ()
        self.best: tuple[Key, Found] | None = None
        self.work: WorkSpots | None = None
        if problem.has_work:
            from irc.passes.setup_work import WorkSpots

            self.work = WorkSpots(self)
        self.fast = _FastKeys.of(self)
        self._clear()

    @property
    def found(self) -> Found | None:
        """The best schedule so far, if it keeps all limits."""
        return None if self.best is None or self.best[0][0] else self.best[1]

    # --- orders ---

    def begin(self) -> bool:
        """Makes the first schedules, by the rules; False where precedence goes in a circle."""
        urgent = _Urgency(self)
        for rule in (urgent.tardiness, self._longest_rest):
            order = self._dispatched(rule)
            if len(order) < self.size:
                return False
            key = self._placed(order)
            if key is not None and (not self.order or key < self.key):
                self.order, self.key = order, key
        return bool(self.order)

    def improve(self, count: int, is_over: Callable[[], bool] = lambda: False) -> None:
        """Tries `count` other orders, or until it is over."""
        rng = random.Random(0)
        history = [self.key] * HISTORY
        for k in range(count):
            if self._is_enough() or (not k % LOOK and is_over()):
                return
            order = self._moved(rng)
            key = None if order is None else self._key_of(order)
            if order is None or key is None:
                continue
            if key <= self.key or key <= history[k % HISTORY]:
                self.order, self.key = order, key
            history[k % HISTORY] = min(history[k % HISTORY], self.key)

    def _is_enough(self) -> bool:
        """Whether no schedule can be better."""
        least = {"makespan": self.problem.bounds.makespan.value}
        return self.best is not None and self.best[0] == (
            0,
            *(least.get(name, 0) for name in self.problem.objectives if name in _VALUED),
        )

    def _key_of(self, order: Sequence[int]) -> Key | None:
        """The key of the schedule in an order, which is made where it is the best so far."""
        if self.fast is None:
            return self._placed(order)
        key = self.fast.key(order)
        if self.best is None or key < self.best[0]:
            self._placed(order)
        return key

    def _moved(self, rng: random.Random) -> list[int] | None:
        """The order with a few neighbours elsewhere, as far as precedence allows; None: nowhere."""
        at = rng.randrange(self.size)
        length = rng.choice((1, 1, 1, 2, 3))
        block = self.order[at : at + length]
        rest = [*self.order[:at], *self.order[at + length :]]
        inside = {*block}
        place = {i: k for k, i in enumerate(rest)}
        befores = (place[j] for i in block for j in self.before[i] if j not in inside)
        afters = (place[j] for i in block for j in self.after[i] if j not in inside)
        low, high = max(befores, default=-1) + 1, min(afters, default=len(rest))
        reach = rng.choice((2, 8, self.size))
        to = rng.randint(max(low, at - reach), max(low, min(high, at + reach)))
        return None if to == at else [*rest[:to], *block, *rest[to:]]

    def _dispatched(self, rule: Callable[[int, int, int], float]) -> list[int]:
        """An order made one by one: of those that can come next the one that the rule prefers.

        The rule is asked with an activity, its soonest start, and the set-up before it.
        """
        self._clear()
        waiting = [len(before) for before in self.before]
        ready = [i for i, count in enumerate(waiting) if not count]
        order: list[int] = []
        while ready:
            best = max(ready, key=lambda i: (self._rated(i, rule), -i))
            ready.remove(best)
            order.append(best)
            if not self._place(best):
                return []
            for j in self.after[best]:
                waiting[j] -= 1
                if not waiting[j]:
                    ready.append(j)
        return order

    def _rated(self, i: int, rule: Callable[[int, int, int], float]) -> tuple[int, float]:
        fixed = self.problem.activities[i].start
        if fixed is not None:
            return 1, -float(fixed)
        fitting = self._fitting(i)
        return 0, rule(i, *((0, 0) if fitting is None else (fitting[1], fitting[3])))

    def _longest_rest(self, i: int, start: int, setup: int) -> float:
        return self.tails[i] + self.ways[i][0].duration - start - setup

    # --- placing ---

    def _clear(self) -> None:
        self.profiles = [copied(p) for p in self.first_profiles]
        if self.work is not None:
            self.work.clear()
        self.lines = [None if line is None else copy(line) for line in self.first_lines]
        self.decisions = [Decision(0, 0)] * self.size
        self.choices: list[Choice] = [()] * self.size

    def _placed(self, order: Sequence[int]) -> Key | None:
        """The key of the schedule in an order; None where something finds no place at all."""
        self._clear()
        if not all(self._place(i) for i in order):
            return None
        key = (self._broken(), *self._values())
        if self.best is None or key < self.best[0]:
            self.best = key, (self.decisions, self.choices)
        return key

    def _place(self, i: int) -> bool:
        fitting = self._fitting(i)
        if fitting is None:
            return False
        end, start, way, _, choice = fitting
        taken = {demand.use: r for (demand, _), r in zip(way.demands, choice, strict=True)}
        for (demand, family), r in zip(way.demands, choice, strict=True) if end > start else ():
            self.profiles[r].take(start, end, demand.amount)
            if self.work is not None:
                self.work.take(r, start, end, demand.amount)
            line = self.lines[r]
            if line is not None:
                setup = line.table[line.family, family]
                line.time, line.cost = line.time + setup.time, line.cost + setup.cost
                line.family, line.free = family, max(line.free, end)
        self.decisions[i] = Decision(start, end, mode=way.mode)
        self.choices[i] = tuple(
            taken.get(demand.use, demand.alternatives[0])
            for demand in self.problem.activities[i].open_demands
        )
        return True

    def _fitting(self, i: int) -> tuple[int, int, Way, int, Choice] | None:
        """(end, start, way, set-up, pools) of the way to carry out an activity that ends first."""
        best: tuple[int, int, Way, int, Choice] | None = None
        for way in self.ways[i]:
            ready = self._ready(i, way.duration)
            placed = self._fit(way, ready) if self.work is None else self.work.fit(i, way, ready)
            if placed is not None:
                start, end, setup, choice = placed
                if best is None or (end, setup) < (best[0], best[3]):
                    best = end, start, way, setup, choice
        return best

    def _ready(self, i: int, duration: int) -> int:
        start = self.heads[i]
        fixed = self.problem.activities[i].start
        if fixed is not None:
            start = max(start, fixed)
        for k in self.incoming[i]:
            arc = self.problem.arcs[k]
            before = self.decisions[arc.before]
            point = int(before.end if arc.from_end else before.start) + arc.min_lag
            start = max(start, point - duration if arc.to_end else point)
        return start

    def _fit(self, way: Way, start: int) -> Fit | None:
        """The first place from `start` on at which all demands fit."""
        if not way.duration:
            return start, start, 0, tuple(demand.alternatives[0] for demand, _ in way.demands)
        while True:
            choice: list[int] = []
            setup, later = 0, start
            for demand, family in way.demands:
                wait, r, own = min(
                    self._offers(demand, family, start, start + way.duration, choice)
                )
                later, setup = max(later, wait), setup + own
                choice.append(r)
            if later == start:
                return start, start + way.duration, setup, tuple(choice)
            if later >= UNREACHABLE_TIME:
                return None
            start = later

    def _offers(
        self, demand: OpenDemand, family: int, start: int, end: int, held: Sequence[int]
    ) -> Iterator[tuple[int, int, int]]:
        """(when it may be free, pool, set-up) of each alternative."""
        for r in demand.alternatives:
            profile, amount = self.profiles[r], demand.amount
            if r in held or amount > profile.capacity:
                yield UNREACHABLE_TIME, r, 0
                continue
            ready, setup = self.after_setup(r, family, start)
            if ready > start:
                yield ready, r, setup
                continue
            blocked = profile.blocked_until(start, end, amount)
            yield (start if blocked is None else blocked), r, setup

    def after_setup(self, r: int, family: int, start: int) -> tuple[int, int]:
        """(when, from a start on, a pool is free and set up for a family, the set-up's time)."""
        line = self.lines[r]
        if line is None:
            return start, 0
        setup = line.table[line.family, family].time
        return max(start, line.free + setup), setup

    # --- values ---

    def _broken(self) -> int:
        """The ticks by which limits are broken, all together."""
        problem, late = self.problem, 0
        for i, (activity, place) in enumerate(zip(problem.activities, self.decisions, strict=True)):
            deadline = problem.effective_deadline(i)
            for limit, time in (
                (deadline, place.end),
                (activity.start, place.start),
                (activity.latest_start, place.start),
            ):
                if limit is not None:
                    late += max(0, int(time) - limit)
        for arc in problem.arcs:
            if arc.max_lag is not None:
                before, after = self.decisions[arc.before], self.decisions[arc.after]
                lag = (after.end if arc.to_end else after.start) - (
                    before.end if arc.from_end else before.start
                )
                late += max(0, int(lag) - arc.max_lag)
        return late

    def _values(self) -> Iterator[int]:
        lines = [line for line in self.lines if line is not None]
        for name in self.problem.objectives:
            if name == "makespan":
                yield max(int(d.end) for d in self.decisions)
            elif name == "tardiness":
                yield self._tardiness()
            elif name == "setup_time":
                yield sum(line.time for line in lines)
            elif name == "setup_cost":
                yield sum(line.cost for line in lines)

    def _tardiness(self) -> int:
        late = 0
        for activity, place in zip(self.problem.activities, self.decisions, strict=True):
            details = activity.details
            if details.due is not None:
                late += details.weight * max(0, int(place.end) - details.due)
        for group in self.problem.groups:
            if group.due is not None and group.members:
                last = max(int(self.decisions[i].end) for i in group.members)
                late += group.weight * max(0, last - group.due)
        return late


class _FastKeys:
    """Keys of orders where each activity has one way, on resources of one unit, without windows.

    What the search does in general, in a few plain lists.
    """

    def __init__(self, search: SetupSearch) -> None:
        problem = search.problem
        self.objectives = [name for name in problem.objectives if name in _VALUED]
        self.heads = [
            max(head, a.start or 0)
            for head, a in zip(search.heads, problem.activities, strict=True)
        ]
        self.durations = [ways[0].duration for ways in search.ways]
        self.incoming = [
            [(problem.arcs[k].before, problem.arcs[k].min_lag) for k in own]
            for own in search.incoming
        ]
        self.uses = [
            [(demand.alternatives[0], family) for demand, family in ways[0].demands]
            if ways[0].duration
            else []
            for ways in search.ways
        ]
        families = {use.family for a in problem.activities for use in a.uses}
        plain = {(a, b): NO_SETUP for a in (None, *families) for b in families}
        self.tables = [plain if line is None else line.table for line in search.first_lines]
        self.begun = [
            (None, 0) if line is None else (line.family, line.free) for line in search.first_lines
        ]
        self.past = [
            sum(getattr(line, name) for line in search.first_lines if line is not None)
            for name in ("time", "cost")
        ]
        self.limits = [
            (i, limit, at_end)
            for i, a in enumerate(problem.activities)
            for limit, at_end in (
                (problem.effective_deadline(i), True),
                (a.start, False),
                (a.latest_start, False),
            )
            if limit is not None
        ]
        self.due: list[tuple[tuple[int, ...], int, int]] = [
            ((i,), a.details.due, a.details.weight)
            for i, a in enumerate(problem.activities)
            if a.details.due is not None
        ]
        self.due += [(g.members, g.due, g.weight) for g in problem.groups if g.due is not None]

    @staticmethod
    def of(search: SetupSearch) -> _FastKeys | None:
        """The keys of a search; None where its problem has more to decide than an order."""
        problem = search.problem
        plain_arcs = all(a.from_end and not a.to_end and a.max_lag is None for a in problem.arcs)
        plain_pools = all(p.capacity == 1 and not p.windows for p in problem.contention.pools)
        plain_ways = all(
            len(ways) == 1
            and all(len(d.alternatives) == 1 and d.amount == 1 for d, _ in ways[0].demands)
            for ways in search.ways
        )
        if problem.has_work or not (plain_arcs and plain_pools and plain_ways):
            return None
        return _FastKeys(search)

    def key(self, order: Sequence[int]) -> Key:
        """The key of the schedule in an order."""
        ends = [0] * len(order)
        lasts = [family for family, _ in self.begun]
        frees = [free for _, free in self.begun]
        heads, durations, incoming, uses, tables = (
            self.heads,
            self.durations,
            self.incoming,
            self.uses,
            self.tables,
        )
        time, cost = self.past
        for i in order:
            start = heads[i]
            for j, lag in incoming[i]:
                if ends[j] + lag > start:
                    start = ends[j] + lag
            for r, family in uses[i]:
                setup = tables[r][lasts[r], family]
                ready = frees[r] + setup[0]
                if ready > start:
                    start = ready
                time += setup[0]
                cost += setup[1]
                lasts[r] = family
            end = ends[i] = start + durations[i]
            for r, _ in uses[i]:
                frees[r] = end
        return (self._broken(ends), *self._values(ends, time, cost))

    def _broken(self, ends: Sequence[int]) -> int:
        broken = 0
        for i, limit, at_end in self.limits:
            over = ends[i] - limit - (0 if at_end else self.durations[i])
            if over > 0:
                broken += over
        return broken

    def _values(self, ends: Sequence[int], time: int, cost: int) -> Iterator[int]:
        for name in self.objectives:
            if name == "makespan":
                yield max(ends)
            elif name == "setup_time":
                yield time
            elif name == "setup_cost":
                yield cost
            else:
                late = 0
                for members, due, weight in self.due:
                    over = max(ends[i] for i in members) - due
                    if over > 0:
                        late += weight * over
                yield late


def copied(profile: Profile) -> Profile:
    found = copy(profile)
    found.times, found.used = list(profile.times), list(profile.used)
    return found


class _Urgency:
    """The rule "apparent tardiness cost with set-ups"; due dates reach back through precedence."""

    def __init__(self, search: SetupSearch) -> None:
        problem = search.problem
        self.durations = [max(1, ways[0].duration) for ways in search.ways]
        self.due: list[int | None] = [a.details.due for a in problem.activities]
        self.weight = [
            a.details.weight if a.details.due is not None else 0 for a in problem.activities
        ]
        for group in problem.groups:
            for i in group.members if group.due is not None else ():
                own = self.due[i]
                self.due[i] = group.due if own is None else min(own, group.due or 0)
                self.weight[i] += group.weight
        for i in _backwards(search):
            for j in search.after[i]:
                if (due := self.due[j]) is not None:
                    own = self.due[i]
                    due -= self.durations[j]
                    self.due[i] = due if own is None else min(own, due)
                    self.weight[i] = max(self.weight[i], self.weight[j])
        setups = [s.time for line in search.first_lines if line for s in line.table.values()]
        self.mean_setup = max(1.0, sum(setups) / max(1, len(setups)))
        self.mean_duration = max(1.0, sum(self.durations) / len(self.durations))

    def tardiness(self, i: int, start: int, setup: int) -> float:
        """How urgent an activity is that can start then, after a set-up."""
        due, duration = self.due[i], self.durations[i]
        if due is None:
            return -1e-3 * (start + duration)
        slack = max(0, due - duration - start)
        pressing = exp(-slack / (2 * self.mean_duration) - setup / (0.5 * self.mean_setup))
        return self.weight[i] / duration * pressing - 1e-9 * start


def _backwards(search: SetupSearch) -> list[int]:
    """The activities, each behind all that follow it by precedence."""
    waiting = [len(after) for after in search.after]
    ready = [i for i, count in enumerate(waiting) if not count]
    for i in ready:
        for j in search.before[i]:
            waiting[j] -= 1
            if not waiting[j]:
                ready.append(j)
    return ready
