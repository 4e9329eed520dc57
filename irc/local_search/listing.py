"""Reads a problem as arrays for the search over lists of activities, and no more than it knows.

What it knows: resources of one unit and of many, calendars and windows, pauses, set-ups, modes and
`one_of`, releases, least lags, deadlines; and the first objective, where that is the makespan, has
to do with due dates, flow time, set-ups or costs, or is a sum of these. All else makes a problem
not applicable, with a reason in words.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import accumulate

from irc.local_search.arrays import Ints, columns, ints, places
from irc.local_search.ways import (
    LATEST_TIME,
    MOST_ACTIVITIES,
    Assignment,
    Found,
    NotApplicable,
    decision_of,
    in_all_modes,
    number_of,
    others,
    pools_in,
)
from irc.problem import NO_FAMILY, PLAIN, Activity, ContendedPool, Problem, Setups
from irc.problem.horizon import safe_horizon
from irc.problem.objective_values import whole_terms
from irc.problem.work_times import WorkTimes, WorkTimesOf, work_range

Plan = Ints
"""A problem as one array of arrays; times in ticks. `plan[plan[NAME] + k]` is entry k of an array.

Of activity i, `WAY_AT[i]` to `WAY_AT[i + 1]` are the places of its ways, `ENDING_AT` those of what
it ends. Of way w, `HELD_AT` gives the places of the pools that it holds; `TIMES` is the number of
its open times (-1: always open), `PAUSE` the most closed time in it (-1: it does not pause).
A pool is a line, where one use follows another, or has a profile of amounts over time (`IS_LINE`).
Families are numbered by pool; 0 stands for the state before the first use.
"""

RELEASE = 0
BEFORE_AT = 1
BEFORE = 2
LAG = 3
FROM_END = 4
AFTER_AT = 5
AFTER = 6
WAY_AT = 7
WORK = 8
TIMES = 9
PAUSE = 10
COST = 11
HELD_AT = 12
POOL = 13
AMOUNT = 14
FAMILY = 15
OPEN_AT = 16
OPEN = 17
CLOSE = 18
IS_LINE = 19
CAPACITY = 20
BASE_AT = 21  # Of the profile of a pool with nothing on it: times, and amounts that are not there.
BASE_TIME = 22
BASE_USED = 23
SETUP_AT = 24  # -1: the pool has no set-ups.
FAMILIES = 25
SETUP_TIME = 26
SETUP_COST = 27
SINCE = 28
ENDING_AT = 29
ENDING = 30
MEMBERS = 31
DUE = 32  # NEVER: no due date.
WEIGHT = 33
ENTERED = 34  # NEVER: no flow time.
TAIL = 35
LATEST_START = 36
LATEST_END = 37
PARTS = 38  # The weights of the parts of the objective.
POOLS = 39  # The number of pools, and
ENDINGS = 40  # of what activities end.
HEADER = 41

NEVER = 1 << 60

MAKESPAN = 0
TARDINESS = 1
TARDY = 2
MAX_TARDINESS = 3
FLOW_TIME = 4
OF_SETUP_TIME = 5
OF_SETUP_COST = 6
OF_COST = 7
_PARTS = (
    *("makespan", "tardiness", "tardy", "max_tardiness"),
    *("flow_time", "setup_time", "setup_cost", "cost"),
)

MOST_TABLE = 1 << 22
"""The most entries that all tables of set-ups have together."""


@dataclass(frozen=True, slots=True)
class Choice(Assignment):
    """An assignment, its working time, and (pool, amount, family) of what it holds."""

    work: int
    held: tuple[tuple[int, int, int], ...]


@dataclass(frozen=True, slots=True)
class Listing:
    """A problem as arrays, and what leads back: the ways of each activity."""

    problem: Problem
    plan: Plan
    choices: tuple[tuple[Choice, ...], ...]
    width: int

    def found(self, starts: Sequence[int], ends: Sequence[int], ways: Sequence[int]) -> Found:
        """The list schedule with these times and ways (numbers among those of the activity)."""
        taken = [self.choices[i][int(w)] for i, w in enumerate(ways)]
        decisions = [
            decision_of(self.problem, i, int(start), int(end), choice)
            for i, (start, end, choice) in enumerate(zip(starts, ends, taken, strict=True))
        ]
        return decisions, [self._pools(i, choice) for i, choice in enumerate(taken)]

    def _pools(self, i: int, choice: Choice) -> tuple[int, ...]:
        demands = self.problem.activities[i].open_demands
        return tuple(
            pool if pool >= 0 else demand.alternatives[0]
            for demand, pool in zip(demands, choice.pools, strict=True)
        )

    def way_of(self, i: int, mode: int | None, pools: Sequence[int]) -> int:
        """The number of the way with a mode and the pools of the demands held in it; 0 if none."""
        return number_of(self.choices[i], mode, pools)


def listing_of(problem: Problem) -> Listing:
    """The arrays of a problem whose repeats are unrolled. Raises `NotApplicable`."""
    for reason in _reasons_against(problem):
        raise NotApplicable(reason)
    choices = tuple(in_all_modes(a, partial(_choices_in, problem, a)) for a in problem.activities)
    kinds = [_families(problem, pool) for pool in problem.contention.pools]
    bases = [_base(pool) for pool in problem.contention.pools]
    lines = _lines(problem, choices)
    arrays = (
        ints(a.release for a in problem.activities),
        *_arcs(problem),
        *_ways(problem, choices, kinds),
        *_pools(problem, bases, lines),
        *_setups(problem, kinds),
        *_endings(problem),
        ints(problem.bounds.tails or [0] * len(choices)),
        *_limits(problem),
        ints(_weights(problem)),
    )
    return Listing(problem, _plan(arrays), choices, _width(problem, choices, bases))


def _plan(arrays: Sequence[Ints]) -> Plan:
    """All arrays in one, behind the places at which they begin."""
    places = [*accumulate((len(array) for array in arrays), initial=HEADER)][:-1]
    header = [*places, len(arrays[CAPACITY]), len(arrays[MEMBERS])]
    return ints([*header, *(int(n) for array in arrays for n in array)])


def least_value(problem: Problem) -> int:
    """A lower bound on the first objective, in its whole numbers."""
    weights = _weights(problem)
    costs = sum(
        min((mode.cost for mode in a.details.modes), default=0) + a.details.cost
        for a in problem.activities
    )
    return weights[MAKESPAN] * problem.bounds.makespan.value + weights[OF_COST] * costs


# --- what is known --------------------------------------------------------------------------------

_OF_PROBLEMS = frozenset(
    [
        *("name", "time_unit", "tick", "activities", "resources", "families", "arcs", "groups"),
        *("deadline", "required", "objectives", "calendars", "horizon", "contention", "bounds"),
        "previous",
    ]
)
_OF_ACTIVITIES = frozenset(
    [
        *("id", "duration_min", "duration_max", "release", "uses", "open_demands", "origin"),
        *("details", "deadline", "deadline_by", "latest_start"),
    ]
)
_OF_DETAILS = frozenset(
    [
        *("modes", "use_modes", "occurrence", "due", "weight", "reward", "cost", "entered"),
        *("calendar", "work", "max_pause"),
    ]
)
_OF_RESOURCES = frozenset(("id", "capacity", "origin", "windows", "setups"))
"""The fields that the search knows about; all others must have their defaults."""


def may_list(problem: Problem) -> bool:
    """Whether nothing but single activities could rule the search out; a quick test."""
    return next(_general_reasons(problem), None) is None


def _reasons_against(problem: Problem) -> Iterator[str]:
    yield from _general_reasons(problem)
    if any(arc.max_lag is not None for arc in problem.arcs):
        yield "it has maximum lags"
    if any(arc.to_end or arc.min_lag < 0 for arc in problem.arcs):
        yield "lags count to an end, or are negative"
    for activity in problem.activities:
        yield from _reasons_against_activity(activity)
    if safe_horizon(problem) > LATEST_TIME:
        yield "its times are too large"


def _general_reasons(problem: Problem) -> Iterator[str]:
    if not 0 < len(problem.activities) <= MOST_ACTIVITIES:
        yield "it has no activities, or too many"
    for weight, name in whole_terms(problem, problem.objectives[0]):
        if name not in _PARTS or weight < 0:
            yield f"the first objective has {name}"
    for name in others(problem, _OF_PROBLEMS):
        yield f"it has {name}"
    for resource in problem.resources:
        for name in others(resource, _OF_RESOURCES):
            yield f"{resource.id!r} has {name}"
        if resource.setups is not None and (resource.setups.tight or resource.setups.waived_before):
            yield f"{resource.id!r} has no idle time, or uses that wait for no set-up"
    if not all(group.required for group in problem.groups):
        yield "a group may be absent"
    if any(problem.previous.places):
        yield "there is a previous plan"


def _reasons_against_activity(activity: Activity) -> Iterator[str]:
    for name in others(activity, _OF_ACTIVITIES):
        yield f"{activity.id!r} has {name}"
    details = activity.details
    if details is PLAIN:
        return
    for name in others(details, _OF_DETAILS):
        yield f"{activity.id!r} has {name}"
    if any(mode != mode.bare._replace(cost=mode.cost) for mode in details.modes):
        yield f"a mode of {activity.id!r} has stock, conditions or effects"


def _weights(problem: Problem) -> list[int]:
    """The weights of the parts of the first objective."""
    weights = [0] * len(_PARTS)
    for weight, name in whole_terms(problem, problem.objectives[0]):
        weights[_PARTS.index(name)] += weight
    return weights


# --- activities -----------------------------------------------------------------------------------


def _choices_in(problem: Problem, activity: Activity, mode: int | None) -> Iterator[Choice]:
    work = work_range(activity, mode)[0]
    for taken, amounts in pools_in(problem, activity, mode, work):
        families = {
            pool: activity.uses[demand.use].family
            for demand, pool in zip(activity.open_demands, taken, strict=True)
        }
        held = tuple((r, n, families[r]) for r, n in sorted(amounts.items()))
        yield Choice(mode, taken, work, held)


def _arcs(problem: Problem) -> tuple[Ints, ...]:
    """Arcs by the activity after them (who, lag, whether it counts from the end), and before."""
    count = len(problem.activities)
    into: list[list[tuple[int, int, int]]] = [[] for _ in range(count)]
    out_of: list[list[int]] = [[] for _ in range(count)]
    for arc in problem.arcs:
        into[arc.after].append((arc.before, arc.min_lag, int(arc.from_end)))
        out_of[arc.before].append(arc.after)
    return (
        places(into),
        *columns(into, 3),
        places(out_of),
        ints(j for own in out_of for j in own),
    )


def _ways(
    problem: Problem, choices: Sequence[Sequence[Choice]], kinds: Sequence[dict[int, int]]
) -> tuple[Ints, ...]:
    """Ways, what they hold, and the open times that they number."""
    times, numbers = WorkTimesOf(problem), dict[int, int]()
    opened: list[WorkTimes] = []
    rows, held = list[tuple[int, int, int, int]](), list[list[tuple[int, int, int]]]()
    for activity, own in zip(problem.activities, choices, strict=True):
        details = activity.details
        for choice in own:
            pools = [problem.contention.pools[r] for r, _, _ in choice.held]
            windowed = [pool.members[0] for pool in pools if pool.windows]
            found = times.of(activity, windowed)
            if not found.always and id(found) not in numbers:
                numbers[id(found)] = len(opened)
                opened.append(found)
            number = -1 if found.always else numbers[id(found)]
            longest = NEVER if details.max_pause is None else details.max_pause
            cost = details.cost + (0 if choice.mode is None else details.modes[choice.mode].cost)
            rows.append((choice.work, number, longest if details.work else -1, cost))
            held.append([(r, n, kinds[r].get(family, 0)) for r, n, family in choice.held])
    return (
        places(choices),
        *columns([rows], 4),
        places(held),
        *columns(held, 3),
        places([found.intervals for found in opened]),
        *columns([found.intervals for found in opened], 2),
    )


# --- pools ----------------------------------------------------------------------------------------


def _base(pool: ContendedPool) -> list[tuple[int, int]]:
    """(time, amount that is not there from then on) of a pool that is never away."""
    return [(at, pool.capacity - n) for at, n in pool.never_away.levels()]


def _lines(problem: Problem, choices: Sequence[Sequence[Choice]]) -> list[bool]:
    """Whether uses of a pool always follow each other."""
    least = [pool.capacity for pool in problem.contention.pools]
    for own in choices:
        for choice in own:
            for r, amount, _ in choice.held:
                least[r] = min(least[r], amount)
    found = [
        2 * amount > pool.capacity and not any(used for _, used in _base(pool))
        for amount, pool in zip(least, problem.contention.pools, strict=True)
    ]
    for pool, is_line in zip(problem.contention.pools, found, strict=True):
        if not is_line and _setups_of(problem, pool) is not None:
            raise NotApplicable(f"{pool.id!r} has set-ups and more than one unit")
    return found


def _pools(
    problem: Problem, bases: Sequence[Sequence[tuple[int, int]]], lines: Sequence[bool]
) -> tuple[Ints, ...]:
    return (
        ints(map(int, lines)),
        ints(pool.capacity for pool in problem.contention.pools),
        places(bases),
        *columns(bases, 2),
    )


def _setups_of(problem: Problem, pool: ContendedPool) -> Setups | None:
    return problem.resources[pool.members[0]].setups


def _families(problem: Problem, pool: ContendedPool) -> dict[int, int]:
    """The numbers of the families that can use a pool, from 1; none without set-ups."""
    if _setups_of(problem, pool) is None:
        return {}
    found = {use.family for a in problem.activities for use in a.uses if _asks(pool, use[0])}
    return {family: k for k, family in enumerate(sorted(found | {NO_FAMILY}), 1)}


def _asks(pool: ContendedPool, alternatives: tuple[int, ...]) -> bool:
    return pool.members[0] in alternatives


def _setups(problem: Problem, kinds: Sequence[dict[int, int]]) -> tuple[Ints, ...]:
    """The tables of set-ups, one after another; the first row is that of the first use."""
    times, costs = list[int](), list[int]()
    places, widths, since = list[int](), list[int](), list[int]()
    for pool, own in zip(problem.contention.pools, kinds, strict=True):
        setups = _setups_of(problem, pool)
        places.append(-1 if setups is None else len(times))
        widths.append(len(own) + 1)
        since.append(0 if setups is None else setups.since)
        if setups is None:
            continue
        if len(times) + (len(own) + 1) ** 2 > MOST_TABLE:
            raise NotApplicable("its tables of set-ups are too large")
        firsts = [setups.first(b) for b in own]
        rows = [firsts, *([setups.between(a, b) for b in own] for a in own)]
        times += [t for row in rows for t in (0, *(setup.time for setup in row))]
        costs += [c for row in rows for c in (0, *(setup.cost for setup in row))]
    return ints(places), ints(widths), ints(times), ints(costs), ints(since)


def _width(
    problem: Problem,
    choices: Sequence[Sequence[Choice]],
    bases: Sequence[Sequence[tuple[int, int]]],
) -> int:
    """The most places that a line or a profile needs."""
    users: Counter[int] = Counter()
    for own in choices:
        users.update({r for choice in own for r, _, _ in choice.held})
    pools = range(len(problem.contention.pools))
    return max((len(bases[r]) + 2 * users[r] + 2 for r in pools), default=1)


# --- objectives and limits ------------------------------------------------------------------------


def _endings(problem: Problem) -> tuple[Ints, ...]:
    """Lists what each activity ends: itself, and groups with a due date or flow time."""
    grouped = {i for group in problem.groups for i in group.members}
    by_activity: list[list[int]] = [[] for _ in problem.activities]
    rows: list[tuple[int, int, int, int]] = []
    for i, activity in enumerate(problem.activities):
        details = activity.details
        by_activity[i].append(len(rows))
        entered = NEVER if i in grouped else details.entered or 0
        due = NEVER if details.due is None else details.due
        rows.append((1, due, details.weight, entered))
    for group in problem.groups:
        if group.members:
            members = {*group.members}
            for i in members:
                by_activity[i].append(len(rows))
            entered = min(problem.activities[i].details.entered or 0 for i in members)
            due = NEVER if group.due is None else group.due
            rows.append((len(members), due, group.weight, entered))
    flat = ints(e for own in by_activity for e in own)
    return (places(by_activity), flat, *columns([rows], 4))


def _limits(problem: Problem) -> tuple[Ints, Ints]:
    """The latest start and the latest end of each activity."""
    ends = []
    for i, _ in enumerate(problem.activities):
        known = problem.effective_deadline(i), problem.horizon
        ends.append(min((limit for limit in known if limit is not None), default=NEVER))
    starts = (NEVER if a.latest_start is None else a.latest_start for a in problem.activities)
    return ints(starts), ints(ends)
