"""Orders of uses on resources, decided one after another, and what they cost at least.

A resource with set-ups gets its sequence from the front: one use after another, until no further
use follows. Where the least times that all sequences leave put too much on another resource, two of
the activities that overlap there are put in order (minimal critical sets: Laborie, "Complete
MCS-based search", 2005). Each step makes the least times later, or the set-ups more; so the least
times and set-ups of partial orders are a bound on all that these leave.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise, permutations
from types import MappingProxyType
from typing import NamedTuple

from irc.passes.mandatory import mandatory_part
from irc.passes.restrict import restrict
from irc.passes.setup_totals import (
    SETUP_OBJECTIVES,
    SetupTour,
    least_setups,
    setup_value,
    tours_of,
)
from irc.problem import Activity, Arc, OpenDemand, Problem, Setups
from irc.problem.decisions import Decision
from irc.problem.objective_values import whole_terms
from irc.problem.setups import setups_from_now
from irc.problem.temporal_network import earliest
from irc.problem.time_points import least_times_to_end, timing_network
from irc_pddl21.search.dates import dues_of

Bounds = tuple[int, ...]
"""A lower bound on each objective, in its whole numbers; less is better (a reward is negative)."""


class Way(NamedTuple):
    """One way to carry out an activity: its mode (index), and whether it takes any time."""

    mode: int | None = None
    lasts: bool = True


class Orders(NamedTuple):
    """The decisions: the sequence of activities on each pool with set-ups (indexes).

    No further use follows on `closed` pools. `ways` are those of activities that have several, and
    `present` says which activities that may be absent are there. The first of each of the `pairs`
    ends before the second starts.
    """

    sequences: Mapping[int, tuple[int, ...]]
    closed: frozenset[int] = frozenset()
    ways: Mapping[int, Way] = MappingProxyType({})
    present: Mapping[int, bool] = MappingProxyType({})
    pairs: tuple[tuple[int, int], ...] = ()

    @property
    def depth(self) -> int:
        """The number of decisions."""
        others = len(self.closed) + len(self.ways) + len(self.present) + len(self.pairs)
        return sum(map(len, self.sequences.values())) + others


class LeastTimes(NamedTuple):
    """The least start and end of each activity that must be there, and the least time after it."""

    start: Mapping[int, int]
    end: Mapping[int, int]
    after: Mapping[int, int]


class Decided(NamedTuple):
    """A problem in which orders are decided.

    `kept` are its activities, by their numbers in the whole problem, which all else uses. No
    schedule is shorter than `makespan` (ticks).
    `overlapping` are activities that overlap at the least times on a resource without room for all.
    """

    orders: Orders
    problem: Problem
    kept: Sequence[int]
    times: LeastTimes
    makespan: int
    bounds: Bounds
    overlapping: tuple[int, ...] = ()


@dataclass(frozen=True)
class OrderSpace:
    """The partial orders of a problem.

    They have the sequences of the pools with set-ups of which each use is there at most once, and
    that no coupling is about. What else there is to decide is the planner's.
    """

    problem: Problem
    _cache: dict[tuple[int, Way], Activity] = field(default_factory=dict)

    @cached_property
    def users(self) -> Mapping[int, tuple[int, ...]]:
        """The activities that may use a pool, of the pools that have sequences."""
        found: dict[int, list[int]] = {}
        barred = {r for r, setups in self.setups.items() if setups.waived_before}
        coupled = {m.activity for c in self.problem.couplings for m in c.members}
        for i, activity in enumerate(self.problem.activities):
            for mode in range(len(activity.details.modes)) or (None,):
                own: set[int] = set()
                for demand in self._carried_out(i, Way(mode)).open_demands:
                    barred |= own & {*demand.alternatives}
                    own |= {*demand.alternatives}
                if activity.details.repeats is not None or i in coupled:
                    barred |= own
                for r in own:
                    found.setdefault(r, []).append(i)
        return {
            r: tuple(dict.fromkeys(own))
            for r, own in sorted(found.items())
            if r in self.setups and r not in barred
        }

    @cached_property
    def setups(self) -> Mapping[int, Setups]:
        """The set-ups from now on, by pool."""
        problem = self.problem
        return {
            r: setups_from_now(problem, pool.members[0])[0]
            for r, pool in enumerate(problem.contention.pools)
            if problem.resources[pool.members[0]].setups is not None
        }

    @cached_property
    def has_bounds(self) -> bool:
        """Whether rewards and costs of repeated actions leave bounds on the objectives."""
        return not any(
            details.repeats is not None
            and (details.reward or details.cost or any(mode.cost for mode in details.modes))
            for details in (a.details for a in self.problem.activities)
        )

    @property
    def root(self) -> Orders:
        """Nothing is decided."""
        return Orders(dict.fromkeys(self.users, ()))

    def orders_in(
        self, decisions: Sequence[Decision], choices: Sequence[tuple[int, ...]]
    ) -> Orders:
        """The orders that a schedule has: its decisions, and the pool of each open demand."""
        sequences: dict[int, tuple[int, ...]] = dict.fromkeys(self.users, ())
        ways: dict[int, Way] = {}
        for i in sorted(range(len(decisions)), key=lambda i: (decisions[i].start, i)):
            activity, decision = self.problem.activities[i], decisions[i]
            lasts = decision.end > decision.start
            if len(self._ways[i]) > 1:
                ways[i] = Way(decision.mode, lasts)
            for demand, r in zip(activity.open_demands, choices[i], strict=True):
                held = activity.details.use_mode(demand.use) in (None, decision.mode)
                if r in sequences and held and lasts:
                    sequences[r] = (*sequences[r], i)
        return Orders(sequences, frozenset(sequences), ways)

    def decided(self, orders: Orders) -> Decided | None:
        """The problem with these orders; None where no schedule has them."""
        whole = self.problem.activities
        narrowed = [self._narrowed(i, orders) for i in range(len(whole))]
        present = {i for sequence in orders.sequences.values() for i in sequence}
        present |= {i for i, is_there in orders.present.items() if is_there}
        absent = {i for i, activity in enumerate(narrowed) if activity is None}
        absent |= {i for i, is_there in orders.present.items() if not is_there}
        for group in self.problem.groups:
            members = set() if group.required else {*group.members}
            present |= members if members & present else set()
            absent |= members if members & absent else set()
        if present & absent or any(not _may_be_absent(whole[i]) for i in absent):
            return None
        problem = replace(
            self.problem,
            activities=tuple(a or b for a, b in zip(narrowed, whole, strict=True)),
            arcs=(*self.problem.arcs, *self._arcs(orders)),
        )
        optional = {i for i in present if whole[i].details.optional}
        problem = restrict(problem, optional, absent) if optional or absent else problem
        kept = [i for i in range(len(whole)) if i not in absent]
        times = least_times(problem, kept)
        if times is None:
            return None
        makespan = self._makespan(orders, times)
        if problem.deadline is not None and makespan > problem.deadline:
            return None
        bounds = self._bounds_of(orders, problem, makespan, times)
        over = _overlapping(problem, kept, times)
        return Decided(orders, problem, kept, times, makespan, bounds, over)

    def children(self, decided: Decided) -> Iterator[Orders]:
        """The orders with one more decision; none where all is decided."""
        orders = decided.orders
        for i in decided.kept:
            if i not in orders.ways and len(self._ways[i]) > 1:
                for way in self._ways[i]:
                    yield orders._replace(ways={**orders.ways, i: way})
                return
        left = {r: found for r in orders.sequences if (found := self._candidates(r, decided))}
        if left:
            yield from self._with_next_use(decided, left)
            return
        for i in self._valued:
            if i in decided.kept and i not in decided.times.start and i not in orders.present:
                for is_there in (True, False):
                    yield orders._replace(present={**orders.present, i: is_there})
                return
        for i, j in permutations(decided.overlapping, 2):
            yield orders._replace(pairs=(*orders.pairs, (i, j)))

    def _with_next_use(
        self, decided: Decided, left: Mapping[int, Sequence[int]]
    ) -> Iterator[Orders]:
        """The orders with one more use on the pool whose next use may start first, or none."""
        orders, start = decided.orders, decided.times.start
        r = min(left, key=lambda r: (min(start.get(i, 0) for i in left[r]), r))
        for i in left[r]:
            sequences = {**orders.sequences, r: (*orders.sequences[r], i)}
            yield orders._replace(sequences=sequences)
        if not any(self._is_certain(i, r, decided) for i in left[r]):
            yield orders._replace(closed=orders.closed | {r})

    @cached_property
    def _ways(self) -> Sequence[tuple[Way, ...]]:
        """The ways of each activity among which sequences depend on the one that is chosen."""
        found = []
        for i, activity in enumerate(self.problem.activities):
            modes = range(len(activity.details.modes)) or (None,)
            ways = [Way(m, lasts) for m in modes for lasts in self._lengths(i, m)]
            held = {r for way in ways for r in self._pools_of(i, way)}
            found.append(tuple(ways) if held & self.users.keys() else (Way(),))
        return found

    def _lengths(self, i: int, mode: int | None) -> tuple[bool, ...]:
        """Whether an activity in a mode takes time, or may do without."""
        activity = self.problem.activities[i]
        timed = activity if mode is None else activity.details.modes[mode]
        if not timed.duration_max:
            return (False,)
        return (True,) if timed.duration_min else (True, False)

    @cached_property
    def _valued(self) -> tuple[int, ...]:
        """The activities that may be absent, where an objective counts what there is."""
        if not any("reward" in n or "cost" in n for n in map(_without_setups, self.names)):
            return ()
        activities = enumerate(self.problem.activities)
        return tuple(i for i, a in activities if a.details.optional)

    @property
    def names(self) -> tuple[str, ...]:
        """The objectives, in order."""
        return self.problem.objectives

    def _candidates(self, r: int, decided: Decided) -> list[int]:
        """The activities that may be next on a pool."""
        orders, kept = decided.orders, {*decided.kept}
        if r in orders.closed:
            return []
        found = []
        for i in self.users[r]:
            demand = self._demand(i, r, orders) if i in kept else None
            if demand is None:
                continue
            if not any(i in orders.sequences.get(k, ()) for k in demand.alternatives):
                found.append(i)
        return found

    def _demand(self, i: int, r: int, orders: Orders) -> OpenDemand | None:
        """The demand of an activity on a pool, the way it is carried out."""
        demands = self._carried_out(i, orders.ways.get(i, self._ways[i][0])).open_demands
        return next((demand for demand in demands if r in demand.alternatives), None)

    def _family(self, i: int, r: int, orders: Orders) -> int:
        demand = self._demand(i, r, orders)
        assert demand is not None
        return self.problem.activities[i].uses[demand.use].family

    def _pools_of(self, i: int, way: Way) -> set[int]:
        demands = self._carried_out(i, way).open_demands
        return {r for demand in demands for r in demand.alternatives}

    def _is_certain(self, i: int, r: int, decided: Decided) -> bool:
        """Whether an activity must come on a pool, sooner or later."""
        demand = self._demand(i, r, decided.orders)
        assert demand is not None
        others = {*demand.alternatives} - decided.orders.closed - {r}
        return i in decided.times.start and not others

    def _carried_out(self, i: int, way: Way) -> Activity:
        """An activity in one way."""
        if (i, way) not in self._cache:
            self._cache[i, way] = _in_way(self.problem.activities[i], way)
        return self._cache[i, way]

    def _narrowed(self, i: int, orders: Orders) -> Activity | None:
        """An activity with the pools that it may still take; None where it has none left."""
        activity = self.problem.activities[i]
        if i in orders.ways:
            activity = self._carried_out(i, orders.ways[i])
        elif len(self._ways[i]) > 1:
            return activity
        demands = []
        for demand in activity.open_demands:
            taken = [r for r in demand.alternatives if i in orders.sequences.get(r, ())]
            left = taken or [r for r in demand.alternatives if r not in orders.closed]
            if not left and activity.duration_max:
                return None
            demands.append(demand._replace(alternatives=tuple(left) or demand.alternatives))
        if tuple(demands) != activity.open_demands:
            activity = replace(activity, open_demands=tuple(demands))
        for r, sequence in orders.sequences.items():
            if sequence[:1] == (i,) and activity.start is None:
                setups = self.setups[r]
                ready = setups.since + setups.first(self._family(i, r, orders)).time
                activity = replace(activity, release=max(activity.release, ready))
        return activity

    def _arcs(self, orders: Orders) -> Iterator[Arc]:
        """The orders as precedence, with the set-ups between neighbours."""
        for r, sequence in orders.sequences.items():
            families = {i: self._family(i, r, orders) for i in sequence}
            for i, j in pairwise(sequence):
                lag = self.setups[r].between(families[i], families[j]).time
                yield Arc(i, j, min_lag=lag, origin=-1)
            if sequence:
                still = (j for j in self._tour(r, "setup_time").activities if j not in sequence)
                yield from (Arc(sequence[-1], j, origin=-1) for j in still)
        yield from (Arc(i, j, origin=-1) for i, j in orders.pairs)

    # --- bounds ---

    @cached_property
    def _tours(self) -> Mapping[str, Mapping[int, SetupTour]]:
        return {name: tours_of(self.problem, name) for name in SETUP_OBJECTIVES}

    def _tour(self, pool: int, name: str) -> SetupTour:
        return self._tours[name][self.problem.contention.pools[pool].members[0]]

    @cached_property
    def _least(self) -> Mapping[str, int]:
        return {name: least_setups(self.problem, name) for name in SETUP_OBJECTIVES}

    def _bounds_of(
        self, orders: Orders, problem: Problem, makespan: int, times: LeastTimes
    ) -> Bounds:
        def part(name: str) -> int:
            if name == "makespan":
                return makespan
            if name in SETUP_OBJECTIVES:
                return self._setups(name, orders)
            if name in ("reward", "cost"):
                return _choices_bound(problem, name)
            return self._lateness(name, times)

        found = []
        for name in self.problem.objectives:
            terms = ((-1, name),) if name == "reward" else whole_terms(self.problem, name)
            found.append(sum(weight * part(term) for weight, term in terms))
        return tuple(found)

    def _makespan(self, orders: Orders, times: LeastTimes) -> int:
        ends = [end + times.after[i] for i, end in times.end.items()]
        ends.append(self.problem.bounds.makespan.value)
        for r, sequence in orders.sequences.items():
            tour = self._tour(r, "setup_time")
            still = [j for j in tour.activities if j not in sequence and j in times.start]
            if sequence and still:
                work = sum(self.problem.activities[j].duration_min for j in still)
                setups = self._rest(r, "setup_time", orders)
                after = min(times.after[j] for j in still)
                ends.append(times.end[sequence[-1]] + work + setups + after)
        return max(ends)

    def _setups(self, name: str, orders: Orders) -> int:
        """The set-ups that are decided, and the least that are left."""
        problem = self.problem
        total = 0
        pools = {pool.members[0]: r for r, pool in enumerate(problem.contention.pools)}
        for resource, tour in self._tours[name].items():
            total += setup_value(setups_from_now(problem, resource)[1], name)
            sequence = orders.sequences.get(pools.get(resource, -1), ())
            if not sequence:
                total += tour.least()
                continue
            r = pools[resource]
            families = [self._family(i, r, orders) for i in sequence]
            links = [self.setups[r].first(families[0])]
            links += [self.setups[r].between(a, b) for a, b in pairwise(families)]
            total += sum(setup_value(link, name) for link in links)
            total += self._rest(r, name, orders)
        return max(total, self._least[name])

    def _rest(self, r: int, name: str, orders: Orders) -> int:
        """The least set-ups after the sequence on a pool."""
        tour, sequence = self._tour(r, name), orders.sequences[r]
        done = frozenset(k for k, i in enumerate(tour.activities) if i in sequence)
        return tour.least(done, self._family(sequence[-1], r, orders))

    def _lateness(self, name: str, times: LeastTimes) -> int:
        late = [0]
        for due in dues_of(self.problem):
            if all(i in times.end for i in due.members):
                over = max(0, max(times.end[i] for i in due.members) - due.due)
                late.append(due.weight * (over > 0 if name == "tardy" else over))
        return max(late) if name == "max_tardiness" else sum(late)


def _in_way(activity: Activity, way: Way) -> Activity:
    """The activity in one way; its uses keep their numbers."""
    if way.mode is not None:
        details, mode = activity.details, activity.details.modes[way.mode]
        kept = activity.uses_in(way.mode)
        activity = replace(
            activity,
            duration_min=mode.duration_min,
            duration_max=mode.duration_max,
            open_demands=tuple(d for d in activity.open_demands if d.use in kept),
            details=replace(
                details.in_mode(way.mode),
                modes=(mode.bare,),
                # (A use of a mode that is not there is never held.)
                use_modes=tuple(None if u in kept else 1 for u in range(len(activity.uses))),
                work=details.work[way.mode : way.mode + 1],
            ),
        )
    if not way.lasts:
        return replace(activity, duration_min=0, duration_max=0, open_demands=())
    least = max(activity.duration_min, min(1, activity.duration_max))
    return replace(activity, duration_min=least)


def _without_setups(name: str) -> str:
    return name.replace("setup_cost", "").replace("setup_time", "")


def _may_be_absent(activity: Activity) -> bool:
    repeats = activity.details.repeats
    return activity.details.optional if repeats is None else repeats[0] == 0


def _choices_bound(problem: Problem, name: str) -> int:
    """The least cost, or the greatest reward, of what there is or may be."""
    sign = 1 if name == "cost" else -1
    total = sum(sign * group.reward for group in problem.groups if group.required and sign < 0)
    for group in problem.groups:
        if not group.required and sign < 0:
            total += min(0, -group.reward)
    for activity in problem.activities:
        details = activity.details
        least = sign * (details.cost if sign > 0 else details.reward)
        if sign > 0:
            least += min((mode.cost for mode in details.modes), default=0)
        total += min(0, least) if _may_be_absent(activity) else least
    return sign * total


def least_times(problem: Problem, kept: Sequence[int]) -> LeastTimes | None:
    """The least times of activities by the numbers that `kept` gives them; None: there are none."""
    core, way = mandatory_part(problem)
    timing = timing_network(core)
    points = timing.points
    forward = earliest(timing.network, timing.floors)
    if forward.cycles:
        return None
    to_end = least_times_to_end(points, timing.network)
    start, end, after = dict[int, int](), dict[int, int](), dict[int, int]()
    for k, activity in enumerate(core.activities):
        begin = forward.t[points.start[k]]
        finish = forward.t[points.end[k]] + points.end_offset[k]
        deadline, latest = core.effective_deadline(k), activity.latest_start
        if activity.start is not None:
            latest = activity.start if latest is None else min(latest, activity.start)
        if (deadline is not None and finish > deadline) or (latest is not None and begin > latest):
            return None
        i = kept[way.activities.old[k]]
        if i not in start:
            start[i], end[i] = begin, finish
            after[i] = to_end[points.end[k]] - points.end_offset[k]
    return LeastTimes(start, end, after)


def _overlapping(problem: Problem, kept: Sequence[int], times: LeastTimes) -> tuple[int, ...]:
    """Some activities that overlap at the least times on a pool without room for all of them.

    Each of them takes time and is there for certain, so that two of them must be in order.
    """
    held: dict[int, list[tuple[int, int, int, int]]] = {}
    for k, activity in enumerate(problem.activities):
        i = kept[k]
        if (
            i not in times.start
            or not activity.duration_min
            or activity.details.repeats is not None
        ):
            continue
        for demand in activity.open_demands:
            if len(demand.alternatives) == 1 and activity.details.use_mode(demand.use) is None:
                users = held.setdefault(demand.alternatives[0], [])
                users.append((times.start[i], times.end[i], i, demand.amount))
    for r, users in sorted(held.items()):
        pool = problem.contention.pools[r]
        if problem.resources[pool.members[0]].batch:
            continue
        found = _first_overload(users, pool.capacity)
        if found:
            return found
    return ()


def _first_overload(users: Sequence[tuple[int, int, int, int]], capacity: int) -> tuple[int, ...]:
    """The fewest users (start, end, activity, amount) that first overlap beyond a capacity."""
    for at, _, _, _ in sorted(users):
        running = [(n, end, i) for start, end, i, n in users if start <= at < end]
        if sum(n for n, _, _ in running) > capacity:
            chosen: list[int] = []
            load = 0
            for n, _, i in sorted(running, reverse=True):
                if load <= capacity:
                    chosen.append(i)
                    load += n
            return tuple(dict.fromkeys(chosen))
    return ()
