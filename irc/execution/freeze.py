"""Freezes a running task: in its problem the history is fixed, and the rest is later.

The frozen problem contains the whole history, so that its answer is the merged schedule: lags to
executed activities, capacity while they run, state and stock need no rule of their own. Demands
that the history alone breaks (a capacity below what running activities hold, an observation against
a lag) are relaxed only as far as the history needs: `irc.execution.conflicts`.
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
from irc.execution.past import known_ranks, past_first, stock_past_first, without_clashes
from irc.execution.state import Key, key_of
from irc.model.quantities import Number
from irc.problem import IMPOSSIBLE_DEADLINE, Activity, Group, PreviousPlace, Problem
from irc.schedule import Entry


@dataclass(frozen=True, slots=True)
class FrozenProblem:
    """A problem whose history is fixed. `executed` are by activity; `now` is in ticks.

    `problem` keeps the demands of the history that open activities may still meet, by stock or by
    state. Where there are any, `all_carried` is the problem without these: they are carried.
    """

    problem: Problem
    now: int
    executed: Mapping[int, ExecutedActivity]
    all_carried: Problem | None = None

    @property
    def begun(self) -> frozenset[Key]:
        """The occurrences that have begun by now, those at this instant as observed."""
        activities = self.problem.activities
        return frozenset(
            (activities[i].id, activities[i].details.occurrence) for i in self.executed
        )

    def half_done(self) -> tuple[int, ...]:
        """The optional groups with executed members and open members."""
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
) -> FrozenProblem:
    """The problem of a revised task as of `now` (`ticks` in ticks), given its history.

    `world_changes` are ids of actions that stand for world changes: those that are due have
    happened. Optional groups stay as they are: `with_groups` requires those that must be finished.
    Raises `UnexplainedError` where an entry of the history does not fit its action.
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
            replace(
                executed_activity(problem, activity, e, running=r),
                by_itself=by_itself,
                least_end=problem.whole_ticks(history.least_ends.get(key_of(e), 0)),
            )
            for e, r in begun
        ]
        if activity.details.repeats is not None:
            in_order = sorted(found, key=lambda f: (f.start, f.entry.occurrence))
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
            known = _places_of_first(problem, activity, planned.get(activity.id, ()))
            earlier.append(known[0] if known else None)
            recurring[i] = known[1:]
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
    places = (*earlier, *(None for _ in further)) if any(earlier) else ()
    frozen = replace(
        problem,
        activities=(*activities, *_chained(further, len(activities))),
        previous=replace(problem.previous, places=places, recurring=recurring),
    )
    frozen = replace(frozen, required=_still_required(frozen, executed))
    return _without_conflicts(frozen, executed, ticks)


def _without_conflicts(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int
) -> FrozenProblem:
    """The frozen problem in which the past comes first, and its conflicts do not bind."""
    if problem.has_state:
        problem = without_clashes(problem, executed)
        problem, executed = past_first(problem, executed, now)
    if problem.reservoirs:
        problem = stock_past_first(problem, executed, now)
    hopeful, hoped = relaxed(problem, executed, now)
    carried = relaxed(problem, executed, now, hopes=False)[0] if hoped else None
    return FrozenProblem(hopeful, now, executed, carried)


def _places_of_first(
    problem: Problem, activity: Activity, entries: Collection[Entry]
) -> tuple[PreviousPlace, ...]:
    """The previous places of an action's first occurrences, up to the first unknown one.

    (After an unknown place, the numbers of the occurrences would not be certain.)
    """
    in_order = sorted(entries, key=lambda e: e.occurrence)
    places = (previous_place_of(problem, activity, e) for e in in_order)
    return tuple(place for place in takewhile(lambda p: p is not None, places) if place is not None)


def _is_due(activity: Activity, now: int) -> bool:
    return activity.start is not None and activity.start <= now


def _happened(problem: Problem, activity: Activity) -> ExecutedActivity:
    """The executed activity of a world change, which takes place at its fixed start."""
    assert activity.start is not None
    time = problem.to_units(activity.start)
    entry = Entry(activity.id, time, time)
    return ExecutedActivity(
        entry, activity.start, activity.start, None, (), running=False, by_itself=True
    )


def _still_required(problem: Problem, executed: Mapping[int, ExecutedActivity]) -> tuple[int, ...]:
    """The goals still to reach: a goal is reached when an occurrence of its action has begun."""
    begun = {problem.activities[i].id for i, past in executed.items() if not past.cancelled}
    return tuple(i for i in problem.required if problem.activities[i].id not in begun)


def _by_action(entries: Sequence[Entry]) -> dict[str, list[Entry]]:
    found: dict[str, list[Entry]] = {}
    for entry in entries:
        found.setdefault(entry.id, []).append(entry)
    return found


def _rest(activity: Activity, begun: Sequence[ExecutedActivity]) -> Activity:
    """The rest of an action that may repeat, after its executed occurrences."""
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
    """Executed occurrences, each linked to the previous occurrence."""
    return [
        a
        if a.details.occurrence == 1
        else replace(a, details=replace(a.details, previous_occurrence=first + k - 1))
        for k, a in enumerate(further)
    ]


def _open(activity: Activity, now: int, cancelled: bool) -> Activity:
    """An open activity: it starts now or later, or never if it was cancelled."""
    if not cancelled:
        return replace(activity, release=max(activity.release, now))
    details = replace(activity.details, optional=True, repeats=None)
    return replace(activity, deadline=IMPOSSIBLE_DEADLINE, details=details)


def with_groups(
    frozen: FrozenProblem, given_up: Collection[int], *, all_carried: bool = False
) -> Problem:
    """The problem in which half-done groups must be finished, except for the groups `given_up`.

    Open members of a given-up group are left out, unless another required group has them.
    `all_carried`: what open activities may still meet for the history does not bind.
    """
    problem = frozen.problem
    if all_carried and frozen.all_carried is not None:
        problem = frozen.all_carried
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
