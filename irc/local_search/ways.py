"""Reads a problem as activities with ways: what local search needs to know of it, and no more.

A way of an activity is a mode of it with a pool for each of its demands. What the search does not
know about (state, set-ups, deadlines, maximum lags) makes a problem not applicable, with a reason
in words; nothing is left out in silence.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from functools import partial
from itertools import islice, product
from math import prod
from typing import Any, TypeVar

from irc.errors import IrcError
from irc.problem import PLAIN, Activity, Problem
from irc.problem.decisions import Decision
from irc.problem.horizon import safe_horizon

MOST_WAYS = 200
"""The greatest number of ways of an activity."""

MOST_ACTIVITIES = 10_000
"""The most activities for which lists are searched, with objectives and limits of any kind."""

MOST_OPERATIONS = 200_000
MOST_OF_A_PROJECT = 20_000
"""The most activities whose makespan is searched, and of a project that is searched as a whole:
not in windows.
"""

LARGE = 5_000
"""From this many activities on, a model of the whole improves no list schedule in reasonable
time.
"""

LATEST_TIME = 1 << 50
"""Sums of times must stay below this."""

Found = tuple[list[Decision], list[tuple[int, ...]]]
"""Starts and ends in ticks, and for each activity the pool of each open demand (-1: not held)."""


class NotApplicable(IrcError):
    """A problem has something that this search does not know about; the text says what."""


class NotInTime(NotApplicable):
    """The loops of a search are not compiled in the time that there is."""


@dataclass(frozen=True, slots=True)
class Assignment:
    """A mode (None: there are none), and the pool of each open demand (-1: not held in it)."""

    mode: int | None
    pools: tuple[int, ...]


AnyAssignment = TypeVar("AnyAssignment", bound=Assignment)


@dataclass(frozen=True, slots=True)
class Way(Assignment):
    """An assignment, and what follows: ticks, amounts of pools, and amounts of stock used up."""

    duration: int
    held: tuple[tuple[int, int], ...]
    used_up: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True, slots=True)
class Ways:
    """The ways of each activity of a problem, and the stock that there is of each reservoir."""

    problem: Problem
    of: tuple[tuple[Way, ...], ...]
    stock: tuple[int, ...]

    def found(self, starts: Sequence[int], chosen: Sequence[int]) -> Found:
        """The list schedule with these starts and ways (numbers among those of the activity)."""
        ways = [self.of[i][int(w)] for i, w in enumerate(chosen)]
        decisions = [
            decision_of(self.problem, i, int(start), int(start) + way.duration, way)
            for i, (start, way) in enumerate(zip(starts, ways, strict=True))
        ]
        return decisions, [way.pools for way in ways]

    def way_of(self, i: int, mode: int | None, pools: Sequence[int]) -> int:
        """The number of the way with a mode and the pools of the demands held in it; 0 if none."""
        return number_of(self.of[i], mode, pools)


def decision_of(problem: Problem, i: int, start: int, end: int, assigned: Assignment) -> Decision:
    """The decision on activity i; it names the resource of each use whose pool has but one."""
    activity = problem.activities[i]
    taken: list[int | None] = [None] * len(activity.uses)
    for demand, pool in zip(activity.open_demands, assigned.pools, strict=True):
        members = problem.contention.pools[pool].members if pool >= 0 else ()
        taken[demand.use] = members[0] if len(members) == 1 else None
    return Decision(start, end, tuple(taken), mode=assigned.mode)


def number_of(known: Sequence[Assignment], mode: int | None, pools: Sequence[int]) -> int:
    """The number of the one with a mode and the pools of the demands held in it; 0 if none."""
    for number, one in enumerate(known):
        if one.mode == mode and all(
            own in (-1, pool) for own, pool in zip(one.pools, pools, strict=True)
        ):
            return number
    return 0


def ways_of(problem: Problem) -> Ways:
    """The ways of all activities. Raises `NotApplicable`."""
    for reason in _reasons_against(problem):
        raise NotApplicable(reason)
    stock = tuple(r.initial - r.least for r in problem.reservoirs)
    of = (in_all_modes(a, partial(_ways_in, problem, a)) for a in problem.activities)
    return Ways(problem, tuple(of), stock)


_OF_PROBLEMS = frozenset(
    [
        "name",
        "time_unit",
        "tick",
        "activities",
        "resources",
        "families",
        "reservoirs",
        "arcs",
        "groups",
        "deadline",
        "required",
        "objectives",
        "state_precedences",
        "horizon",
        "contention",
        "bounds",
        "previous",
    ]
)
_OF_ACTIVITIES = frozenset(
    ("id", "duration_min", "duration_max", "release", "uses", "open_demands", "origin", "details")
)
_OF_DETAILS = frozenset(
    ("modes", "use_modes", "stock", "occurrence", "due", "weight", "reward", "cost", "entered")
)
_OF_RESOURCES = frozenset(("id", "capacity", "origin", "windows"))
"""The fields that the search knows about; all others must have their defaults."""


def others(element: Any, known: frozenset[str]) -> Iterator[str]:
    """The fields of an element that say something that the search does not know about."""
    for one in fields(element):
        usual = one.default
        if one.name not in known and usual is not MISSING and getattr(element, one.name) != usual:
            yield one.name.replace("_", " ")


def may_apply(problem: Problem) -> bool:
    """Whether nothing but single activities could rule local search out; a quick test."""
    return next(_general_reasons(problem), None) is None


def knows(problem: Problem) -> bool:
    """Whether the search knows all that a problem has; an activity may still have too many ways."""
    return next(_reasons_against(problem), None) is None


def _reasons_against(problem: Problem) -> Iterator[str]:
    yield from _general_reasons(problem)
    if any(arc.max_lag is not None for arc in problem.arcs):
        yield "it has maximum lags"
    if any(not a.from_end or a.to_end or a.min_lag < 0 for a in problem.arcs):
        yield "lags count from other points than an end to a start, or are negative"
    for activity in problem.activities:
        yield from _reasons_against_activity(activity)
    if safe_horizon(problem) > LATEST_TIME:
        yield "its times are too large"


def _general_reasons(problem: Problem) -> Iterator[str]:
    if len(problem.activities) > MOST_OPERATIONS:
        yield "it has too many activities"
    if problem.objectives[0] != "makespan":
        yield f"the first objective is {problem.objectives[0]}"
    for name in others(problem, _OF_PROBLEMS):
        yield f"it has {name}"
    for resource in problem.resources:
        for name in others(resource, _OF_RESOURCES):
            yield f"{resource.id!r} has {name}"
    if not all(group.required for group in problem.groups):
        yield "a group may be absent"
    if any(problem.previous.places):
        yield "there is a previous plan"
    if any(r.least > r.initial for r in problem.reservoirs):
        yield "stock is missing from the beginning"


def _reasons_against_activity(activity: Activity) -> Iterator[str]:
    for name in others(activity, _OF_ACTIVITIES):
        yield f"{activity.id!r} has {name}"
    details = activity.details
    if details is PLAIN:
        return
    for name in others(details, _OF_DETAILS):
        yield f"{activity.id!r} has {name}"
    if any(mode != mode.bare._replace(stock=mode.stock, cost=mode.cost) for mode in details.modes):
        yield f"a mode of {activity.id!r} has conditions or effects"
    if any(change.amount > 0 for change in details.all_stock):
        yield f"{activity.id!r} adds to stock"


def in_all_modes(
    activity: Activity, in_mode: Callable[[int | None], Iterator[AnyAssignment]]
) -> tuple[AnyAssignment, ...]:
    """The findings of `in_mode` for every mode of an activity, or for `None` without modes.

    Raises `NotApplicable` for none or too many.
    """
    modes: list[int | None] = [*range(len(activity.details.modes))]
    found = [one for mode in modes or [None] for one in in_mode(mode)]
    if not found or len(found) > MOST_WAYS:
        raise NotApplicable(f"{activity.id!r} has {len(found)} ways")
    return tuple(found)


def pools_in(
    problem: Problem, activity: Activity, mode: int | None, duration: int
) -> Iterator[tuple[tuple[int, ...], Mapping[int, int]]]:
    """Each choice of pools in a mode that are large enough, and the amounts held of them.

    Raises `NotApplicable` for too many. What takes no time holds nothing.
    """
    pools = problem.contention.pools
    choices: list[tuple[int, ...]] = []
    for demand in activity.open_demands:
        held = activity.details.use_mode(demand.use) in (None, mode)
        large = tuple(r for r in demand.alternatives if pools[r].capacity >= demand.amount)
        choices.append((large if duration else demand.alternatives) if held else (-1,))
    if prod(map(len, choices)) > MOST_WAYS:
        raise NotApplicable(f"{activity.id!r} has too many ways")
    for taken in islice(product(*choices), MOST_WAYS + 1):
        amounts: Counter[int] = Counter()
        for demand, pool in zip(activity.open_demands, taken, strict=True):
            if pool >= 0 and duration:
                amounts[pool] += demand.amount
        if all(amount <= pools[r].capacity for r, amount in amounts.items()):
            yield taken, amounts


def _ways_in(problem: Problem, activity: Activity, mode: int | None) -> Iterator[Way]:
    details = activity.details
    duration = activity.duration_min if mode is None else details.modes[mode].duration_min
    used_up: Counter[int] = Counter()
    for change in details.in_mode(mode).stock:
        used_up[change.reservoir] -= change.amount
    for taken, amounts in pools_in(problem, activity, mode, duration):
        yield Way(mode, taken, duration, tuple(sorted(amounts.items())), tuple(used_up.items()))


MOST_UNITS = 6
"""The most interchangeable units of a pool that are taken as machines."""


def units_of(ways: Ways) -> list[int]:
    """The number of machines that each pool stands for. Raises `NotApplicable` for no shop."""
    amounts: dict[int, set[int]] = {}
    for own in ways.of:
        for way in own:
            if len(way.held) > 1:
                raise NotApplicable("activities hold several resources at once")
            if way.used_up:
                raise NotApplicable("activities use up stock")
            for pool, amount in way.held:
                amounts.setdefault(pool, set()).add(amount)
    units = [0] * len(ways.problem.contention.pools)
    for number, asked in amounts.items():
        whole = ways.problem.contention.pools[number]
        if whole.windows:
            raise NotApplicable("capacities change")
        if 2 * min(asked) > whole.capacity:
            units[number] = 1
        elif asked == {1} and whole.capacity <= MOST_UNITS:
            units[number] = whole.capacity
        else:
            raise NotApplicable("resources have many units")
    return units
