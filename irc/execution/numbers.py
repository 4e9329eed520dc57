"""Number variables while a task runs: the levels that the history leaves, and what it breaks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

from irc.execution.awaited_ends import with_conditions, with_end_variables
from irc.execution.executed import ExecutedActivity
from irc.problem import (
    Activity,
    Condition,
    Details,
    Mode,
    NumberCondition,
    NumberVariable,
    Problem,
    ProtectedLimits,
    TimedChange,
)

_Key = tuple[int, int, int]
"""(time, rank, stage): at an instant ends (0) come before changes of the world (1), starts last."""


class _Change(NamedTuple):
    """A change of a number by an executed activity (None: a timed change)."""

    key: _Key
    activity: int | None
    amount: int
    sets: bool


def numbers_now(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int, places: Mapping[int, int]
) -> tuple[NumberVariable, ...]:
    """The numbers with the levels that the history leaves, and timed changes counted from now.

    `places` are the running activities. A level beyond a bound moves that bound, so that what is
    open need not mend it.
    """
    found = []
    for k, number in enumerate(problem.numbers):
        level = number.initial
        for change in _history(problem, executed, k):
            running = change.activity in places
            over = change.key[0] <= now if change.activity is None else not running
            if over or (running and _is_start(executed, change, now)):
                level = change.amount if change.sets else level + change.amount
        found.append(
            replace(
                number,
                initial=level,
                least=None if number.least is None else min(number.least, level),
                greatest=None if number.greatest is None else max(number.greatest, level),
                changes=tuple(
                    TimedChange(c.at - now, c.value) for c in number.changes if c.at > now
                ),
            )
        )
    return tuple(found)


def _is_start(executed: Mapping[int, ExecutedActivity], change: _Change, now: int) -> bool:
    """Whether a change of a running activity was at its start, before now."""
    past = executed[change.activity or 0]
    return change.key[0] == past.start < now and change.key[2] > 0


def _history(problem: Problem, executed: Mapping[int, ExecutedActivity], k: int) -> list[_Change]:
    """The changes of a number by executed activities and by the world, in their order."""
    changes = [_Change((at, -1, 1), None, level, True) for at, level in problem.numbers[k].changes]
    for i, past in executed.items():
        for effect in problem.activities[i].details.number_effects:
            if effect.number == k:
                key = _key(past, at_end=effect.at_end)
                changes.append(_Change(key, i, effect.amount, effect.sets))
    return sorted(changes, key=lambda change: change.key)


def _key(past: ExecutedActivity, *, at_end: bool) -> _Key:
    time, rank = (past.end, past.end_rank) if at_end else (past.start, past.rank)
    return time, rank, 1 if past.by_itself else 0 if past.start < time else 2


def without_unmet_limits(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int
) -> Problem:
    """Drops conditions on numbers that the history broke: they bind no more.

    Where one binds throughout what still runs, open activities do not break it again.
    """
    if not any(problem.activities[i].details.number_conditions for i in executed):
        return problem
    histories = [_history(problem, executed, k) for k in range(len(problem.numbers))]
    activities = list(problem.activities)
    protected: list[ProtectedLimits] = []
    for i, past in executed.items():
        details = activities[i].details
        kept = tuple(
            c
            for c in details.number_conditions
            if _is_met(problem, histories[c.number], c, i, past, now)
        )
        if len(kept) < len(details.number_conditions):
            activities[i] = replace(activities[i], details=replace(details, number_conditions=kept))
            gone = (c for c in details.number_conditions if c not in kept and c.at == "all")
            protected += [ProtectedLimits(i, c) for c in gone if past.running]
    for j, activity in enumerate(activities if protected else ()):
        its = tuple(p for p in protected if _may_take_away(activity, p))
        if its and j not in executed:
            details = replace(activity.details, protects_limits=its)
            activities[j] = replace(activity, details=details)
    return replace(problem, activities=tuple(activities))


def with_bounds_carried(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int, *, hopes: bool
) -> tuple[Problem, bool]:
    """The problem in which the history may leave the bounds of numbers, and nothing open does.

    With `hopes` the bounds that only what is to come leaves are kept, for open activities may
    prevent that; returns also whether some are.
    """
    hoped = False
    for k, number in enumerate(problem.numbers):
        levels, later = [number.initial], False
        for change in _history(problem, executed, k):
            levels.append(change.amount if change.sets else levels[-1] + change.amount)
            later = later or (change.key[0] > now and not number.allows(levels[-1]))
        if all(map(number.allows, levels[1:])):
            continue
        if later and hopes:
            hoped = True
            continue
        problem = _leaving_bounds(problem, executed, k, levels)
    return problem, hoped


def _leaving_bounds(
    problem: Problem, executed: Mapping[int, ExecutedActivity], k: int, levels: list[int]
) -> Problem:
    """The problem in which a number may have some levels, but open activities keep its bounds."""
    number = problem.numbers[k]
    least = None if number.least is None else min(number.least, *levels)
    greatest = None if number.greatest is None else max(number.greatest, *levels)
    numbers = list(problem.numbers)
    numbers[k] = replace(number, least=least, greatest=greatest)
    bounds = ProtectedLimits(-1, NumberCondition(k, number.least, number.greatest, "all"))
    activities = list(problem.activities)
    for j, activity in enumerate(activities):
        if j not in executed and _may_take_away(activity, bounds):
            its = (*activity.details.protects_limits, bounds)
            activities[j] = replace(
                activity, details=replace(activity.details, protects_limits=its)
            )
    return replace(problem, activities=tuple(activities), numbers=tuple(numbers))


def _may_take_away(activity: Activity, protected: ProtectedLimits) -> bool:
    return any(map(protected.takes_away, activity.details.all_number_effects))


def with_limits_held(problem: Problem) -> Problem:
    """The problem in which protected limits may not be touched at all, instead of not broken again.

    This is for a target that cannot say "where the number is within them" (see
    `irc.execution.state_conflicts.with_values_held`).
    """
    needs = (
        (p, p.activity, problem.numbers[p.condition.number].id)
        for activity in problem.activities
        for p in activity.details.protects_limits
        if p.activity >= 0
    )
    extended, over = with_end_variables(problem, needs)
    if not over:
        return problem
    activities = tuple(_behind(activity, over) for activity in extended.activities)
    return replace(extended, activities=activities)


def _behind(activity: Activity, over: Mapping[ProtectedLimits, int]) -> Activity:
    """An activity that breaks protected limits only behind what needs these."""

    def needed(part: Details | Mode) -> tuple[Condition, ...]:
        return tuple(
            Condition(over[p], 1, "end" if e.at_end else "start")
            for p in activity.details.protects_limits
            for e in part.number_effects
            if p in over and p.takes_away(e)
        )

    return with_conditions(activity, needed) if activity.details.protects_limits else activity


def _is_met(
    problem: Problem,
    history: list[_Change],
    condition: NumberCondition,
    i: int,
    past: ExecutedActivity,
    now: int,
) -> bool:
    initial = problem.numbers[condition.number].initial
    if condition.at == "start" or past.start == past.end:
        before = (c for c in history if c.key < _key(past, at_end=False) and c.activity != i)
        return condition.allows(_level(initial, before))
    closing = _key(past, at_end=True)
    if condition.at == "end":
        before = (c for c in history if c.key < closing)
        return past.running or condition.allows(_level(initial, before))
    opening = _key(past, at_end=False)
    levels = [_level(initial, (c for c in history if c.key <= opening))]
    for change in history:
        if opening < change.key < closing and change.key[0] <= now:
            levels.append(change.amount if change.sets else levels[-1] + change.amount)
        elif change.activity is None and opening < change.key < closing:
            levels.append(change.amount)  # The world sets it, whatever is planned.
    return all(map(condition.allows, levels))


def _level(initial: int, changes: Iterator[_Change]) -> int:
    for change in changes:
        initial = change.amount if change.sets else initial + change.amount
    return initial


def without_limits_on(activity: Activity, number: int) -> Activity:
    """An activity without its conditions on a number, in all of its modes."""
    details = activity.details

    def kept(conditions: tuple[NumberCondition, ...]) -> tuple[NumberCondition, ...]:
        return tuple(c for c in conditions if c.number != number)

    modes = tuple(m._replace(number_conditions=kept(m.number_conditions)) for m in details.modes)
    details = replace(
        details,
        number_conditions=kept(details.number_conditions),
        modes=modes,
        protects_limits=tuple(p for p in details.protects_limits if p.condition.number != number),
    )
    return replace(activity, details=details)
