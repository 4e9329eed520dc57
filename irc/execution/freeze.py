"""A task that is being carried out, as a problem: what has begun is fixed, the rest is later.

The frozen problem is of the whole history, so that its answer is the merged schedule: lags to what
already ran, capacity while it runs, state and stock need no rule of their own. What history alone
contradicts (a capacity cut below what is running, an observation against a lag) is relaxed just so
far that history is possible: `irc.execution.conflicts`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile

from irc.execution.conflicts import relaxed
from irc.execution.executed import (
    ExecutedActivity,
    as_executed,
    executed_activity,
    previous_place_of,
)
from irc.execution.history import History
from irc.execution.past import known_ranks, past_first, stock_past_first
from irc.model.quantities import Number
from irc.problem import IMPOSSIBLE_DEADLINE, Activity, Group, PreviousPlace, Problem
from irc.schedule import Entry


@dataclass(frozen=True, slots=True)
class Frozen:
    """A problem whose history is fixed. `executed` are by activity; `now` is in ticks.

    `helpers` are ids of activities that only say what must hold for a while.
    """

    problem: Problem
    now: int
    executed: Mapping[int, ExecutedActivity]
    helpers: frozenset[str] = frozenset()

    def half_done(self) -> tuple[int, ...]:
        """The optional groups of which something has begun and something is open."""
        return tuple(k for k, group in enumerate(self.problem.groups) if self._is_half_done(group))

    def _is_half_done(self, group: Group) -> bool:
        begun = [i in self.executed for i in group.members]
        return not group.required and any(begun) and not all(begun)


def freeze(
    problem: Problem,
    history: History,
    now: Number,
    ticks: int,
    world_changes: Collection[str] = (),
) -> Frozen:
    """The problem of a revised task as of `now` (`ticks` in ticks), given its history.

    `world_changes` are ids of actions that say how the world has changed by itself: what is due has
    happened. Optional groups are as they were: `with_groups` says which of them must be finished.
    Raises `UnexplainedError` where an entry that has begun says what its action cannot have.
    """
    state = history.state(now)
    completed, running = _by_action(state.completed), _by_action(state.running)
    planned = _by_action(state.open)
    activities: list[Activity] = []
    further: list[Activity] = []
    executed: dict[int, ExecutedActivity] = {}
    earlier: list[PreviousPlace | None] = []
    recurring: dict[int, tuple[PreviousPlace, ...]] = {}
    for i, activity in enumerate(problem.activities):
        begun = [(e, False) for e in completed.get(activity.id, ())]
        begun += [(e, True) for e in running.get(activity.id, ())]
        by_itself = activity.id in world_changes
        found = [
            replace(executed_activity(problem, activity, e, running=r), by_itself=by_itself)
            for e, r in begun
        ]
        if activity.details.repeats is not None:
            in_order = sorted(found, key=lambda f: (f.start, f.end))
            first = len(problem.activities)
            for k, past in enumerate(in_order, 1):
                executed[first + len(further)] = past
                ranks = known_ranks(problem, history, activity, past)
                further.append(_occurrence(as_executed(problem, activity, past, ticks, ranks), k))
            rest = _rest(activity, in_order)
            if found:
                previous = first + len(further) - 1
                rest = replace(rest, details=replace(rest.details, previous_occurrence=previous))
            activities.append(_open(rest, ticks, activity.id in history.cancelled))
            its = sorted(planned.get(activity.id, ()), key=lambda e: e.occurrence)
            places = [previous_place_of(problem, activity, e) for e in its]
            # (Without all of the first ones known, nobody could say which is which.)
            known = [*takewhile(lambda place: place is not None, places)]
            earlier.append(known[0] if known else None)
            recurring[i] = tuple(place for place in known[1:] if place is not None)
        elif found:
            executed[i] = found[0]
            ranks = known_ranks(problem, history, activity, found[0])
            activities.append(as_executed(problem, activity, found[0], ticks, ranks))
            earlier.append(None)
        elif by_itself and _is_due(activity, ticks):
            executed[i] = _happened(problem, activity)
            activities.append(activity)
            earlier.append(None)
        else:
            activities.append(_open(activity, ticks, activity.id in history.cancelled))
            entries = planned.get(activity.id)
            earlier.append(previous_place_of(problem, activity, entries[0]) if entries else None)
    before = (*earlier, *(None for _ in further)) if any(earlier) else ()
    frozen = replace(
        problem,
        activities=(*activities, *_chained(further, len(activities))),
        previous=replace(problem.previous, places=before, recurring=recurring),
    )
    frozen = replace(frozen, required=_still_required(frozen, executed))
    return _without_conflicts(frozen, executed, ticks)


def _without_conflicts(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int
) -> Frozen:
    """The frozen problem in which the past comes first, and its conflicts do not bind."""
    if problem.variables:
        problem, executed = past_first(problem, executed, now)
    if problem.reservoirs:
        problem = stock_past_first(problem, executed, now)
    count = len(problem.activities)
    problem, executed = relaxed(problem, executed, now)
    return Frozen(problem, now, executed, frozenset(a.id for a in problem.activities[count:]))


def _is_due(activity: Activity, now: int) -> bool:
    return activity.start is not None and activity.start <= now


def _happened(problem: Problem, activity: Activity) -> ExecutedActivity:
    """A change of the world that nobody has planned: it takes place when it does."""
    assert activity.start is not None
    time = problem.to_units(activity.start)
    entry = Entry(activity.id, time, time)
    return ExecutedActivity(
        entry, activity.start, activity.start, None, (), running=False, by_itself=True
    )


def _still_required(problem: Problem, executed: Mapping[int, ExecutedActivity]) -> tuple[int, ...]:
    """A goal is reached when one occurrence of its action has begun."""
    begun = {problem.activities[i].id for i, past in executed.items() if not past.cancelled}
    return tuple(i for i in problem.required if problem.activities[i].id not in begun)


def _by_action(entries: Sequence[Entry]) -> dict[str, list[Entry]]:
    found: dict[str, list[Entry]] = {}
    for entry in entries:
        found.setdefault(entry.id, []).append(entry)
    return found


def _rest(activity: Activity, begun: Sequence[ExecutedActivity]) -> Activity:
    """The occurrences that are left of an action that may repeat."""
    assert activity.details.repeats is not None
    least, greatest = activity.details.repeats
    count = sum(1 for past in begun if not past.cancelled)
    least = max(0, least - count)
    greatest = None if greatest is None else max(0, greatest - len(begun))
    details = replace(activity.details, occurrence=len(begun) + 1)
    if greatest is None or greatest > 1:
        return replace(activity, details=replace(details, repeats=(least, greatest)))
    details = replace(details, repeats=None, optional=least == 0)
    deadline = IMPOSSIBLE_DEADLINE if greatest == 0 else activity.deadline
    return replace(activity, deadline=deadline, details=details)


def _occurrence(activity: Activity, number: int) -> Activity:
    return replace(activity, details=replace(activity.details, occurrence=number))


def _chained(further: Sequence[Activity], first: int) -> list[Activity]:
    """Each occurrence that has begun with the one before it."""
    return [
        a
        if a.details.occurrence == 1
        else replace(a, details=replace(a.details, previous_occurrence=first + k - 1))
        for k, a in enumerate(further)
    ]


def _open(activity: Activity, now: int, cancelled: bool) -> Activity:
    """What has not begun starts now or later, or, when it was cancelled, never."""
    if not cancelled:
        return replace(activity, release=max(activity.release, now))
    details = replace(activity.details, optional=True, repeats=None)
    return replace(activity, deadline=IMPOSSIBLE_DEADLINE, details=details)


def with_groups(frozen: Frozen, given_up: Collection[int]) -> Problem:
    """The problem in which what is half-done is finished, but for the groups `given_up`.

    Of those, what has not begun is left out, unless another group that must be there has it.
    """
    problem = frozen.problem
    required = {
        k for k, g in enumerate(problem.groups) if any(i in frozen.executed for i in g.members)
    } - set(given_up)
    needed = {i for k in required for i in problem.groups[k].members}
    needed |= {i for g in problem.groups if g.required for i in g.members}
    gone = {i for k in given_up for i in problem.groups[k].members} - needed - set(frozen.executed)
    activities = list(problem.activities)
    for i in needed:
        activities[i] = _mandatory(activities[i])
    for i in gone:
        activities[i] = replace(activities[i], deadline=IMPOSSIBLE_DEADLINE)
    return replace(
        problem,
        activities=tuple(activities),
        groups=tuple(
            replace(group, required=group.required or k in required)
            for k, group in enumerate(problem.groups)
            if k not in given_up
        ),
    )


def _mandatory(activity: Activity) -> Activity:
    if not activity.details.optional:
        return activity
    return replace(activity, details=replace(activity.details, optional=False))
