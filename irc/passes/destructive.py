"""The destructive bound: assume a makespan of at most D; if that is refuted, D + 1 is a bound.

Under the assumption every time point has a window. Windows shrink by

- the lags (the timing network),
- the order of two activities that cannot overlap: two that fit in one order only get that order,
- energetic reasoning on each load (see `irc.passes.energy`): the part of each activity that an
  interval must hold, wherever its windows place it; it refutes, and moves starts and ends
  (Baptiste, Le Pape, Nuijten, "Constraint-based scheduling", 2001, chapter 3);
- turns: seven activities on two units mean that one of the units serves four, one by one.

Where that refutes nothing, a search goes through the orders of activities that compete. An
assumption is refuted when every case contradicts itself; when a case stands, or the budget is
spent, nothing has been shown. So each refutation is a proof by itself, and the
bound does not depend on refutation being monotone in D.

The budget counts elementary steps (a constraint looked at, an activity entered in an interval),
never time: the same problem gives the same bound on any machine. A step takes some 0.2 µs.
"""

from __future__ import annotations

from bisect import insort
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import permutations
from typing import NamedTuple

from irc.model.times import format_number
from irc.passes.energy import Load, loads, thinned
from irc.problem import Problem
from irc.problem.temporal_network import earliest
from irc.problem.time_points import (
    PointMap,
    TimingNetwork,
    latest_times,
    least_times_to_end,
    timing_network,
)

BASE_STEPS = 40_000
STEPS_PER_ACTIVITY = 1_000
MOST_STEPS = 1_000_000
"""The budget is `BASE_STEPS + STEPS_PER_ACTIVITY * n`, at most `MOST_STEPS`."""

SIZE_LIMIT = 20_000
"""Problems with more activities and arcs than this are not changed."""

PAIRS_LIMIT = 50_000
"""At most this many pairs that cannot overlap get pairwise orders, over all loads."""

BEGINNINGS_LIMIT = 64
"""An energetic sweep over a load looks at intervals from at most this many beginnings."""

TURNS_LIMIT = 30
"""Loads with more activities than this are not examined for turns (cubic time)."""

DEPTH_LIMIT = 300
"""At most this many orders are assumed one inside the other."""


def destructive_bound(problem: Problem, reached: int | None = None) -> Problem:
    """Raises the bound to one more than the greatest refuted makespan.

    `reached` is the makespan of a known schedule, in ticks: no makespan from there on can be
    refuted, so none is tried.

    Deadlines and fixed starts count. Where even the task's deadline is refuted the bound becomes
    deadline + 1: there is no schedule. Where a task without a deadline has none (its actions'
    deadlines or maximum lags cannot be kept), every makespan is refuted, and the problem is
    returned as it is.

    Source: Klein, Scholl, "Computing lower bounds by destructive improvement", EJOR 112 (1999).
    """
    if not problem.has_contention or len(problem.activities) + len(problem.arcs) > SIZE_LIMIT:
        return problem
    model = _model(problem)
    if model is None or problem.bounds.makespan.value > model.limit:
        return problem
    steps = min(MOST_STEPS, BASE_STEPS + STEPS_PER_ACTIVITY * len(problem.activities))
    refuter = _Refuter(model, steps)
    value, reason = problem.bounds.makespan.value, ""
    stands = model.limit + 1 if reached is None else min(reached, model.limit + 1)
    for depth in (0, DEPTH_LIMIT):
        value, reason = _climb(value, reason, refuter, depth, stands)
        if value >= stands:
            break
    if value == problem.bounds.makespan.value or (value > model.limit and problem.deadline is None):
        return problem
    last = format_number(problem.to_units(value - 1))
    return problem.with_bound(value, f"a makespan of {last} {reason}")


def _climb(value: int, reason: str, refuter: _Refuter, depth: int, stands: int) -> tuple[int, str]:
    """One more than the greatest refuted D from `value` on (below `stands`), and the reason.

    `value` first, then steps that double, then bisection: few trials where times are long.
    """
    refuted, step = value - 1, 1
    while stands - refuted > 1:
        tried = min(refuted + step, (refuted + stands) // 2)
        why = refuter.refute(tried, depth)
        if why is None:
            stands = tried
        else:
            refuted, reason = tried, why
            step = max(2 * step, value >> 8)
    return stands, reason


# --- what does not depend on D ------------------------------------------------------------------

_Edges = list[list[tuple[int, int]]]
"""For each point the (other point, weight) pairs of its constraints."""


class _LoadRow(NamedTuple):
    """An activity on a load: its points, the offset of its end, its least duration, its amount."""

    start: int
    end: int
    offset: int
    duration: int
    amount: int


@dataclass(frozen=True, slots=True)
class _Demand:
    """A load as the sweeps read it."""

    of: str
    capacity: int
    rows: list[_LoadRow]


@dataclass(frozen=True, slots=True)
class _Model:
    """The problem as points, constraints between them, and loads.

    `earliest[p]` and `latest[p]` are the window of point p in schedules that end by `limit`;
    `tail[p]` is the least time from p to the end of the schedule. `partners[i]` are the
    activities that cannot overlap activity i. While a case is explored, `leaving` and `entering`
    hold its orders too.
    """

    problem: Problem
    points: PointMap
    owner: list[int]
    leaving: _Edges
    entering: _Edges
    earliest: list[int]
    latest: list[int]
    tail: list[int]
    limit: int
    demands: list[_Demand]
    demands_of: list[list[int]]
    partners: list[list[int]]


def _model(problem: Problem) -> _Model | None:
    """The model of a problem; None where its time constraints contradict each other."""
    timing = timing_network(problem)
    points, network = timing.points, timing.network
    leaving: _Edges = [[] for _ in range(points.size)]
    entering: _Edges = [[] for _ in range(points.size)]
    for u, v, weight in zip(network.src, network.dst, network.weight, strict=True):
        leaving[u].append((v, weight))
        entering[v].append((u, weight))
    limit = problem.deadline
    if limit is None:
        limit = max(_enough_time(problem, timing), problem.bounds.makespan.value)
    latest = latest_times(problem, points, network, limit)
    if latest is None:
        return None
    contended = list(loads(problem))
    demands = [_demand(problem, points, load) for load in contended]
    demands_of: list[list[int]] = [[] for _ in range(points.size)]
    for k, demand in enumerate(demands):
        for row in demand.rows:
            for point in {row.start, row.end}:
                demands_of[point].append(k)
    return _Model(
        problem=problem,
        points=points,
        owner=timing.owner,
        leaving=leaving,
        entering=entering,
        earliest=earliest(network, timing.floors).t,
        latest=latest,
        tail=least_times_to_end(points, network),
        limit=limit,
        demands=demands,
        demands_of=demands_of,
        partners=_partners(problem, contended),
    )


def _enough_time(problem: Problem, timing: TimingNetwork) -> int:
    """A makespan that some best schedule does not exceed, if there is a schedule.

    In an earliest schedule each time is the length of a simple path of floors, of constraints,
    and of orders chosen on resources, which add one activity's duration each.
    """
    lags = sum(weight for weight in timing.network.weight if weight > 0)
    durations = sum(activity.duration_min for activity in problem.activities)
    return max(timing.floors) + lags + 2 * durations


def _demand(problem: Problem, points: PointMap, load: Load) -> _Demand:
    rows = [
        _LoadRow(
            points.start[i],
            points.end[i],
            points.end_offset[i],
            problem.activities[i].duration_min,
            amount,
        )
        for i, amount in zip(load.activities, load.amounts, strict=True)
    ]
    return _Demand(load.of, load.capacity, rows)


def _partners(problem: Problem, contended: list[Load]) -> list[list[int]]:
    """For each activity, the activities that cannot overlap it."""
    found: list[set[int]] = [set() for _ in problem.activities]
    room = PAIRS_LIMIT
    for load in contended:
        pairs = _exclusive_pairs(load, room)
        room -= len(pairs)
        for i, j in pairs:
            found[i].add(j)
            found[j].add(i)
    return [sorted(partners) for partners in found]


def _exclusive_pairs(load: Load, room: int) -> list[tuple[int, int]]:
    """The pairs whose amounts do not fit together; none if there are more than `room`."""
    jobs = sorted(zip(load.amounts, load.activities, strict=True), reverse=True)
    pairs: list[tuple[int, int]] = []
    first_fitting = len(jobs)
    for k, (amount, i) in enumerate(jobs):
        while first_fitting > k + 1 and amount + jobs[first_fitting - 1][0] <= load.capacity:
            first_fitting -= 1
        pairs += [(i, j) for _, j in jobs[k + 1 : first_fitting]]
        if len(pairs) > room:
            return []
        if first_fitting <= k + 1:
            break
    return pairs


# --- refuting one D -----------------------------------------------------------------------------


class _Refuted(Exception):
    """The assumption contradicts itself; the text completes "a makespan of 27 …"."""


class _Spent(Exception):
    """The step budget is used up."""


class _CaseOrder(NamedTuple):
    """The case that one activity ends before another starts."""

    first: int
    second: int


_Windows = list[tuple[int, int, int, int, int, int]]
"""For each row: earliest and latest start, earliest and latest end, least duration, amount."""


@dataclass
class _Refuter:
    """Refutes assumed makespans, one after another, within one budget.

    `lo` and `hi` are the windows under the assumption and the cases entered. `changed` lists the
    points whose window shrank since their constraints were looked at, `due` the demands with such
    a point.
    """

    model: _Model
    steps: int
    lo: list[int] = field(default_factory=list)
    hi: list[int] = field(default_factory=list)
    changed: list[int] = field(default_factory=list)
    waiting: set[int] = field(default_factory=set)
    due: set[int] = field(default_factory=set)
    cases: int = 0

    def refute(self, makespan: int, depth: int) -> str | None:
        """The reason why no schedule ends by `makespan`; None if that is not shown.

        With a depth of 0 no cases are distinguished.
        """
        model = self.model
        lo = list(model.earliest)
        hi = [
            min(latest, makespan - tail)
            for latest, tail in zip(model.latest, model.tail, strict=True)
        ]
        if any(first > last for first, last in zip(lo, hi, strict=True)):
            return "leaves too little time for the lags, releases and deadlines"
        self.cases = 0
        try:
            self._restart(lo, hi, range(len(lo)))
            self._explore(depth)
        except _Refuted as refuted:
            return str(refuted)
        except _Spent:
            return None
        return None

    def _restart(self, lo: list[int], hi: list[int], changed: Iterable[int]) -> None:
        self.lo, self.hi = list(lo), list(hi)
        self.changed, self.due = list(changed), set()
        self.waiting = set(self.changed)

    # --- cases ---

    def _explore(self, depth: int) -> None:
        """Returns if a case stands; raises `_Refuted` if all cases contradict themselves."""
        self.cases += 1
        self._propagate()
        orders = self._conflict() if depth else None
        if orders is None:
            return
        lo, hi = self.lo, self.hi
        for order in orders:
            self._restart(lo, hi, ())
            self._enter(order)
            try:
                self._keep_order(*order)
                self._explore(depth - 1)
                return
            except _Refuted:
                continue
            finally:
                self._leave(order)
        raise _Refuted(f"fails in each of {self.cases} cases of order")

    def _enter(self, order: _CaseOrder) -> None:
        model, points = self.model, self.model.points
        end, start = points.end[order.first], points.start[order.second]
        offset = points.end_offset[order.first]
        model.leaving[end].append((start, offset))
        model.entering[start].append((end, offset))

    def _leave(self, order: _CaseOrder) -> None:
        model, points = self.model, self.model.points
        model.leaving[points.end[order.first]].pop()
        model.entering[points.start[order.second]].pop()

    def _conflict(self) -> list[_CaseOrder] | None:
        """Orders of which each schedule keeps at least one; None if earliest times are no conflict.

        Activities that hold too much together, were each as early as it can be, do not all
        overlap: one ends before another starts. Of several such sets that with the fewest
        possible orders is taken, then that with the least room for them. (Forbidden sets:
        Bartusch, Möhring, Radermacher, "Scheduling project networks with resource constraints
        and time windows", 1988.)
        """
        best: list[tuple[int, int, int]] | None = None
        least = 0, 0
        for demand in self.model.demands:
            together = self._forbidden_set(demand)
            if not together:
                continue
            orders = self._possible_orders(together)
            measure = len(orders), sum(room for room, _, _ in orders)
            if best is None or measure < least:
                best, least = orders, measure
        return None if best is None else [_CaseOrder(first, second) for _, first, second in best]

    def _forbidden_set(self, demand: _Demand) -> list[int]:
        """A minimal set of activities that exceed the capacity at their earliest times."""
        lo, hi, rows = self.lo, self.hi, demand.rows
        starts = [lo[row.start] for row in rows]
        ends = [lo[row.end] + row.offset for row in rows]
        running: list[int] = []
        for k in sorted(range(len(rows)), key=starts.__getitem__):
            running = [j for j in running if ends[j] > starts[k]]
            running.append(k)
            self._spend(1 + len(running))
            excess = sum(rows[j].amount for j in running) - demand.capacity
            if excess <= 0:
                continue
            for j in sorted(running, key=lambda j: (starts[j] - hi[rows[j].start], j)):
                if rows[j].amount < excess:
                    excess -= rows[j].amount
                    running.remove(j)
            return [self.model.owner[rows[j].start] for j in running]
        return []

    def _possible_orders(self, together: list[int]) -> list[tuple[int, int, int]]:
        """The possible orders of two of these as (room, first, second), least room first."""
        points, lo, hi = self.model.points, self.lo, self.hi
        found = []
        for i, j in permutations(together, 2):
            room = hi[points.start[j]] - lo[points.end[i]] - points.end_offset[i]
            if room >= 0:
                found.append((room, i, j))
        return sorted(found)

    # --- propagation ---

    def _spend(self, steps: int) -> None:
        self.steps -= steps
        if self.steps < 0:
            raise _Spent

    def _raise(self, point: int, time: int) -> None:
        """Raises the earliest time of a point to `time`."""
        self.lo[point] = time
        self._note(point)

    def _lower(self, point: int, time: int) -> None:
        """Lowers the latest time of a point to `time`."""
        self.hi[point] = time
        self._note(point)

    def _note(self, point: int) -> None:
        if self.lo[point] > self.hi[point]:
            name = self.model.problem.activities[self.model.owner[point]].id
            raise _Refuted(f"leaves no time for {name!r}")
        if point not in self.waiting:
            self.waiting.add(point)
            self.changed.append(point)

    def _propagate(self) -> None:
        """Shrinks the windows until none changes any more."""
        self._propagate_lags()
        while self.due:
            k = min(self.due)
            self.due.discard(k)
            self._sweep(self.model.demands[k])
            self._propagate_lags()

    def _propagate_lags(self) -> None:
        """Propagates lags and pairwise orders from each point that changed."""
        model, lo, hi = self.model, self.lo, self.hi
        for point in self.changed:
            self.waiting.discard(point)
            self.due.update(model.demands_of[point])
            leaving, entering = model.leaving[point], model.entering[point]
            self._spend(1 + len(leaving) + len(entering))
            time = lo[point]
            for other, weight in leaving:
                if lo[other] < time + weight:
                    self._raise(other, time + weight)
            time = hi[point]
            for other, weight in entering:
                if hi[other] > time - weight:
                    self._lower(other, time - weight)
            if model.partners[model.owner[point]]:
                self._order_with_partners(model.owner[point])
        self.changed.clear()

    def _order_with_partners(self, i: int) -> None:
        """Orders activity i and each partner that fits on only one side of it."""
        points, lo, hi = self.model.points, self.lo, self.hi
        starts, ends, offsets = points.start, points.end, points.end_offset
        partners = self.model.partners[i]
        self._spend(2 * len(partners))
        first_end, last_start = lo[ends[i]] + offsets[i], hi[starts[i]]
        for j in partners:
            if first_end > hi[starts[j]]:
                self._keep_order(j, i)
            elif lo[ends[j]] + offsets[j] > last_start:
                self._keep_order(i, j)

    def _keep_order(self, first: int, second: int) -> None:
        """Propagates that one activity ends before another starts."""
        points = self.model.points
        end, offset, start = points.end[first], points.end_offset[first], points.start[second]
        if self.lo[start] < self.lo[end] + offset:
            self._raise(start, self.lo[end] + offset)
        if self.hi[end] > self.hi[start] - offset:
            self._lower(end, self.hi[start] - offset)

    def _sweep(self, demand: _Demand) -> None:
        """Applies energetic reasoning to a load, over intervals that begin where one may start."""
        lo, hi = self.lo, self.hi
        windows = [
            (lo[start], hi[start], lo[end] + offset, hi[end] + offset, duration, amount)
            for start, end, offset, duration, amount in demand.rows
        ]
        if demand.capacity > 1 and len(windows) <= TURNS_LIMIT:
            self._take_turns(demand, windows)
        for begin in thinned({time for w in windows for time in w[:2]}, BEGINNINGS_LIMIT):
            self._spend(4 * len(windows))
            for end, slack in self._tight_ends(demand, windows, begin):
                self._move(demand, windows, (begin, end), slack)

    def _take_turns(self, demand: _Demand, windows: _Windows) -> None:
        """Refutes intervals too short for the turns that activities inside must take."""
        for begin in sorted({window[0] for window in windows}):
            inside = sorted((w[3], -w[4], w[5]) for w in windows if w[0] >= begin)
            self._spend(4 * len(inside))
            longest_first: list[tuple[int, int]] = []
            units = 0
            for k, (end, negated_duration, amount) in enumerate(inside, 1):
                insort(longest_first, (negated_duration, amount))
                units += amount
                if units > demand.capacity and (k == len(inside) or end < inside[k][0]):
                    self._spend(4 * k)
                    if _turns(longest_first, demand.capacity) > end - begin:
                        raise _Refuted(self._overload(demand, begin, end))

    def _tight_ends(self, demand: _Demand, windows: _Windows, begin: int) -> list[tuple[int, int]]:
        """Ends of intervals from `begin` whose slack some activity could exceed, with the slack.

        From `begin` on, what an interval must hold of an activity grows from its latest start
        (or `begin`) by its amount per tick, until all that must lie behind `begin` is held.
        """
        events: list[tuple[int, int]] = []
        widest = 0
        for _, last_start, first_end, _, duration, amount in windows:
            if first_end > begin:
                held = min(duration, first_end - begin)
                grows = max(last_start, begin)
                events.append((grows, amount))
                events.append((grows + held, -amount))
            widest = max(widest, duration * amount)
        events.sort()
        tight: list[tuple[int, int]] = []
        slack, rate, at = 0, demand.capacity, begin
        for time, change in events:
            slack += rate * (time - at)
            at = time
            rate -= change
            if slack < 0:
                raise _Refuted(self._overload(demand, begin, time))
            if change < 0 and slack < widest:
                tight.append((time, slack))
        return tight

    def _overload(self, demand: _Demand, begin: int, end: int) -> str:
        to_units = self.model.problem.to_units
        first, last = format_number(to_units(begin)), format_number(to_units(end))
        return f"asks too much of {demand.of} between {first} and {last}"

    def _move(
        self, demand: _Demand, windows: _Windows, interval: tuple[int, int], slack: int
    ) -> None:
        """Moves starts and ends so that no activity alone takes more than the slack it has.

        With a start s it holds at least min(duration, length, first end - begin, end - s) of the
        interval, and correspondingly with an end.
        """
        begin, end = interval
        self._spend(len(windows))
        for row, window in zip(demand.rows, windows, strict=True):
            first_start, last_start, first_end, last_end, duration, amount = window
            if amount * duration <= slack or first_start >= end or last_end <= begin:
                continue
            self._spend(4)
            most = min(duration, end - begin)
            early, late = min(most, first_end - begin), min(most, end - last_start)
            free = slack + amount * max(0, min(early, late))
            if amount * early > free and (time := end - free // amount) > self.lo[row.start]:
                self._raise(row.start, time)
            if amount * late > free:
                time = begin + free // amount - row.offset
                if time < self.hi[row.end]:
                    self._lower(row.end, time)


def _turns(longest_first: list[tuple[int, int]], capacity: int) -> int:
    """The least total time that some unit of a resource is held, by (minus duration, amount) pairs.

    Of activities that need u units in all, some unit serves u / capacity, rounded up. That takes
    as long as the shortest of them; the k longest activities are looked at, for each k.
    """
    best, units, total = 0, 0, [0]
    for k, (negated_duration, amount) in enumerate(longest_first, 1):
        units += amount
        total.append(total[-1] - negated_duration)
        turns = -(-units // capacity)
        best = max(best, total[k] - total[max(0, k - turns)])
    return best
