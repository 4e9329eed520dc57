"""Serial schedule generation: one activity after another, each as early as its resources allow.

The serial schedule generation scheme with the priority rule "longest head + duration + tail
first" (Kolisch, "Serial and parallel resource-constrained project scheduling methods
revisited", EJOR 90, 1996). The result is a hint and an upper bound, not an answer: where maximum
lags, deadlines or fixed starts defeat the rule, there is no result.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from heapq import heappop, heappush
from typing import TYPE_CHECKING

from irc.passes.resource_profile import UNREACHABLE_TIME, Profile
from irc.problem import Activity, Arc, ContendedPool, OpenDemand, PreviousPlace, Problem
from irc.problem.decisions import Decision

if TYPE_CHECKING:
    from irc.passes.work_placing import WorkPlacer

Choice = tuple[int, ...]

Found = tuple[list[Decision], list[Choice]]
"""Starts and ends in ticks, and for each activity the pool of each open demand."""


def list_schedule(
    problem: Problem,
    priorities: Sequence[int] | None = None,
    floors: Sequence[int] | None = None,
) -> Found | None:
    """Starts and ends in ticks, and for each activity the pool of each open demand.

    Where precedence leaves a choice, the activity with the least of the `priorities` comes first;
    by default fixed activities, and then the most urgent. No activity starts before its floor. None
    where the rule finds no schedule that keeps every window and lag.
    """
    if problem.has_setups or (problem.has_batches and problem.has_work):
        return None  # `irc.passes.setup_schedule` has the rule for set-ups.
    if priorities is None:
        priorities = [
            -(a.duration_min + tail) if a.start is None else a.start - UNREACHABLE_TIME
            for a, tail in zip(problem.activities, problem.bounds.tails, strict=True)
        ]
    order = order_of(problem, priorities)
    if order is None or any(
        demand.amount > max(problem.contention.pools[r].capacity for r in demand.alternatives)
        for activity in problem.activities
        for demand in activity.open_demands
    ):
        return None
    incoming: list[list[Arc]] = [[] for _ in problem.activities]
    for arc in problem.arcs:
        incoming[arc.after].append(arc)
    profiles = [_profile(problem, pool) for pool in problem.contention.pools]
    placer = _work_placer(problem, profiles)
    decisions = [Decision(0, 0)] * len(problem.activities)
    choices: list[Choice] = [()] * len(problem.activities)
    for i in order:
        activity = problem.activities[i]
        start = max(
            problem.bounds.heads[i], ready_behind(incoming[i], activity.duration_min, decisions)
        )
        if floors is not None:
            start = max(start, floors[i])
        if activity.start is not None:
            start = max(start, activity.start)
        if placer is not None:
            spot = placer.place(activity, start)
            if spot is None:
                return None
            choices[i] = spot[2]
            decisions[i] = Decision(spot[0], spot[1])
            continue
        placed = _place(activity, start, profiles)
        if placed is None:
            return None
        start, choices[i] = placed
        decisions[i] = Decision(start, start + activity.duration_min)
    return (decisions, choices) if keeps_windows(problem, decisions) else None


def _profile(problem: Problem, pool: ContendedPool) -> Profile:
    """The profile of a pool; that of a batch resource knows its loads."""
    if not problem.resources[pool.members[0]].batch:
        return Profile(pool)
    from irc.passes.load_profile import LoadProfile

    return LoadProfile(pool)


def _work_placer(problem: Problem, profiles: list[Profile]) -> WorkPlacer | None:
    """The placer of activities with calendars and pauses; loaded for problems that have them."""
    if not problem.has_work:
        return None
    from irc.passes.work_placing import WorkPlacer

    return WorkPlacer(problem, profiles)


def quick_schedule(problem: Problem) -> Found | None:
    """The quick schedule; with a previous plan, the best of three, and of equals the one that moves
    least: by the rule, in the order of the previous plan, and with no start before its start there.
    """
    if problem.has_setups:
        from irc.passes.setup_schedule import setup_schedule

        return setup_schedule(problem)
    if not any(problem.previous.places):
        return _by_rule(problem)
    as_before = as_previously_chosen(problem)
    order = previous_order(problem)
    floors = [0 if place is None else place.start for place in problem.previous.places]
    shifted = list_schedule(as_before, order, floors), list_schedule(as_before, order)
    best = _best(problem, shifted)
    if best is not None and _quality(problem, best)[0] <= problem.bounds.makespan.value:
        return best  # (None is shorter, and the rule knows nothing of the previous plan.)
    return _best(problem, (best, _by_rule(problem)))


def _best(problem: Problem, found: Iterable[Found | None]) -> Found | None:
    """The shortest of some schedules; of equals the one that moves least, and the first."""
    return min((f for f in found if f), key=lambda f: _quality(problem, f), default=None)


def _by_rule(problem: Problem) -> Found | None:
    """The schedule by the rule; with loads, perhaps the one in the order of due dates."""
    found = list_schedule(problem)
    return _on_time(problem, found) if problem.has_batches else found


def _on_time(problem: Problem, by_rule: Found | None) -> Found | None:
    """The schedule by the rule or in the order of due dates: that with less weighted tardiness.

    (Loads that are in the way of urgent work are what a schedule with loads is late by.)
    """
    dues = [a.details.due for a in problem.activities]
    if by_rule is None or all(due is None for due in dues):
        return by_rule
    order = [UNREACHABLE_TIME if due is None else due for due in dues]
    found = (by_rule, list_schedule(problem, order))
    return min((f for f in found if f), key=lambda f: _tardiness(problem, f), default=None)


def _tardiness(problem: Problem, found: Found) -> int:
    return sum(
        activity.details.weight * max(0, int(decision.end) - activity.details.due)
        for activity, decision in zip(problem.activities, found[0], strict=True)
        if activity.details.due is not None
    )


def _quality(problem: Problem, found: Found) -> tuple[int, int]:
    return max((int(d.end) for d in found[0]), default=0), moved_in(problem, found)


def moved_in(problem: Problem, found: Found) -> int:
    """The number of activities that have moved from their previous places, by start or pool."""
    decisions, choices = found
    return sum(
        decisions[i].start != place.start or _is_elsewhere(problem, i, place, choices[i])
        for i, place in enumerate(problem.previous.places)
        if place is not None
    )


def _is_elsewhere(problem: Problem, i: int, place: PreviousPlace, choice: Choice) -> bool:
    """Whether an open demand takes another pool than in the previous plan."""
    return any(
        place.resources[demand.use] not in problem.contention.pools[pool].members
        for demand, pool in zip(problem.activities[i].open_demands, choice, strict=True)
    )


def as_previously_chosen(problem: Problem) -> Problem:
    """The problem in which each open demand tries first the pool that the previous plan took."""
    activities = list(problem.activities)
    for i, place in enumerate(problem.previous.places):
        demands = activities[i].open_demands
        if place is None or all(len(demand.alternatives) == 1 for demand in demands):
            continue
        activities[i] = replace(
            activities[i],
            open_demands=tuple(_first_as_before(problem, c, place) for c in demands),
        )
    return replace(problem, activities=tuple(activities))


def _first_as_before(problem: Problem, demand: OpenDemand, place: PreviousPlace) -> OpenDemand:
    taken = place.resources[demand.use]
    order = sorted(
        demand.alternatives, key=lambda r: taken not in problem.contention.pools[r].members
    )
    return demand._replace(alternatives=tuple(order))


def previous_order(problem: Problem) -> list[int]:
    """Priorities: fixed activities first, then the order of the previous plan, then new ones."""
    return [_place_before(problem, i) for i in range(len(problem.activities))]


def _place_before(problem: Problem, i: int) -> int:
    place = problem.previous.places[i]
    if place is not None:
        return place.start
    fixed = problem.activities[i].start
    return UNREACHABLE_TIME if fixed is None else fixed - UNREACHABLE_TIME


def quick_makespan(problem: Problem) -> int | None:
    """The makespan of the quick schedule, in ticks; None where the rule finds none."""
    quick = list_schedule(problem)
    return None if quick is None else max((int(d.end) for d in quick[0]), default=0)


def order_of(problem: Problem, priorities: Sequence[int]) -> list[int] | None:
    """The activities in an order that keeps precedence, least priority first; None on a cycle."""
    waiting = [0] * len(problem.activities)
    following: list[list[int]] = [[] for _ in problem.activities]
    for arc in problem.arcs:
        following[arc.before].append(arc.after)
        waiting[arc.after] += 1
    heap: list[tuple[int, int]] = []

    def push(i: int) -> None:
        heappush(heap, (priorities[i], i))

    for i, count in enumerate(waiting):
        if not count:
            push(i)
    order = []
    while heap:
        _, i = heappop(heap)
        order.append(i)
        for j in following[i]:
            waiting[j] -= 1
            if not waiting[j]:
                push(j)
    return order if len(order) == len(waiting) else None


def ready_behind(arcs: Iterable[Arc], duration: int, decisions: Sequence[Decision]) -> int:
    """The first time, from 0 on, at which the arcs to an activity of a duration let it start."""
    ready = 0
    for arc in arcs:
        before = decisions[arc.before]
        point = int(before.end if arc.from_end else before.start) + arc.min_lag
        ready = max(ready, point - duration if arc.to_end else point)
    return ready


def _place(activity: Activity, start: int, profiles: list[Profile]) -> tuple[int, Choice] | None:
    """The first time from `start` on at which every open demand fits, and the pools it takes."""
    found = room_for(activity, start, profiles)
    if found is not None:
        take_room(activity, *found, profiles)
    return found


def room_for(activity: Activity, start: int, profiles: list[Profile]) -> tuple[int, Choice] | None:
    """The first time from `start` on at which every open demand fits, and the pools that do."""
    duration, demands = activity.duration_min, activity.open_demands
    if not demands or not duration:
        return start, tuple(demand.alternatives[0] for demand in demands)
    if len(demands) == 1 and len(demands[0].alternatives) == 1:
        return _room_on(activity, demands[0], start, profiles)
    while True:
        choice: list[int] = []
        needed: dict[int, int] = {}
        later: int | None = None
        for demand in demands:
            soonest: int | None = None
            for r in demand.alternatives:
                amount = demand.amount + needed.get(r, 0)
                if amount > profiles[r].capacity:
                    continue
                family = activity.uses[demand.use].family
                wait = profiles[r].blocked_until(start, start + duration, amount, family)
                if wait is None:
                    choice.append(r)
                    needed[r] = amount
                    break
                soonest = wait if soonest is None else min(soonest, wait)
            else:
                if soonest is None:
                    return None
                later = soonest
                break
        if later == UNREACHABLE_TIME:
            return None
        if later is None:
            return start, tuple(choice)
        start = later


def _room_on(
    activity: Activity, demand: OpenDemand, start: int, profiles: list[Profile]
) -> tuple[int, Choice] | None:
    """The first time from `start` on at which the only open demand fits, and its only pool."""
    (pool,) = demand.alternatives
    profile, family = profiles[pool], activity.uses[demand.use].family
    if demand.amount > profile.capacity:
        return None
    room = profile.first_room(start, activity.duration_min, demand.amount, family)
    return None if room is None else (room, (pool,))


def take_room(
    activity: Activity, start: int, choice: Choice, profiles: list[Profile], sign: int = 1
) -> None:
    """Takes the room of an activity in the profiles of the pools it takes; -1 gives it back."""
    duration = activity.duration_min
    for demand, r in zip(activity.open_demands, choice, strict=True) if duration else ():
        family = activity.uses[demand.use].family
        profiles[r].take(start, start + duration, sign * demand.amount, family)


def keeps_windows(problem: Problem, decisions: list[Decision]) -> bool:
    """Whether placed activities keep their dates, and all lags between them."""
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        deadline = problem.effective_deadline(i)
        if deadline is not None and decision.end > deadline:
            return False
        if activity.earliest_end is not None and decision.end < activity.earliest_end:
            return False
        if activity.start is not None and decision.start != activity.start:
            return False
        if activity.latest_start is not None and decision.start > activity.latest_start:
            return False
    for arc in problem.arcs:
        before, after = decisions[arc.before], decisions[arc.after]
        lag = (after.end if arc.to_end else after.start) - (
            before.end if arc.from_end else before.start
        )
        if lag < arc.min_lag or (arc.max_lag is not None and lag > arc.max_lag):
            return False
    return True
