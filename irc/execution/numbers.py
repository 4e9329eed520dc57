"""Number variables while a task runs: the levels that the history leaves, and what it breaks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

from irc.execution.executed import ExecutedActivity
from irc.problem import Activity, NumberCondition, NumberVariable, Problem, TimedChange

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
    """Drops conditions on numbers that executed activities broke: they bind no more."""
    if not any(problem.activities[i].details.number_conditions for i in executed):
        return problem
    histories = [_history(problem, executed, k) for k in range(len(problem.numbers))]
    activities = list(problem.activities)
    for i, past in executed.items():
        details = activities[i].details
        kept = tuple(
            c
            for c in details.number_conditions
            if _is_met(problem, histories[c.number], c, i, past, now)
        )
        if len(kept) < len(details.number_conditions):
            activities[i] = replace(activities[i], details=replace(details, number_conditions=kept))
    return replace(problem, activities=tuple(activities))


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
    details = replace(details, number_conditions=kept(details.number_conditions), modes=modes)
    return replace(activity, details=details)
