"""Timed changes of state in re-timing: each becomes an activity of its own, at its time.

At the instant of a change the starts that touch its variable come after it; ends come on either
side (docs/semantics.md, rule 6). Re-timing moves nothing later, so what starts before a change
stays before it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from irc.problem import Activity, Details, Effect, NumberEffect, Problem
from irc.problem.decisions import AnswerError, Decision
from irc.problem.temporal_network import Network
from irc.problem.time_points import PointMap
from irc.retiming.numbers import number_orders, number_suits
from irc.retiming.state import Happening, HappeningOrder, is_one_happening, state_orders

_Key = tuple[Fraction | int, int]
"""The time and the rank of a happening."""


@dataclass(frozen=True)
class ChangeActivity:
    """The activity of a timed change at the tick `at`, of the variable `var` or, where `number`,
    of the number `var`.
    """

    index: int
    var: int
    at: int
    number: bool = False


def with_change_activities(problem: Problem) -> tuple[Problem, list[ChangeActivity]]:
    """The problem with an activity for each timed change until the deadline, behind all others."""
    activities = list(problem.activities)
    found = []
    for v, variable in enumerate(problem.variables):
        for at, value in variable.changes:
            if problem.deadline is not None and at > problem.deadline:
                break
            found.append(ChangeActivity(len(activities), v, at))
            details = Details(effects=(Effect(v, value, False),))
            name = f"the timed change of {variable.id}"
            activities.append(Activity(name, 0, 0, start=at, details=details))
    for k, number in enumerate(problem.numbers):
        for at, level in number.changes:
            if problem.deadline is not None and at > problem.deadline:
                break
            found.append(ChangeActivity(len(activities), k, at, number=True))
            details = Details(number_effects=(NumberEffect(k, level, True, False),))
            name = f"the timed change of {number.id}"
            activities.append(Activity(name, 0, 0, start=at, details=details))
    if not found:
        return problem, found
    return replace(problem, activities=tuple(activities)), found


def _touches(activity: Activity, change: ChangeActivity) -> set[str]:
    """The times at which an activity reads, holds or changes the variable of a change."""
    var, details = change.var, activity.details
    if change.number:
        found = {c.at for c in details.number_conditions if c.number == var}
        return found | {
            "end" if e.at_end else "start" for e in details.number_effects if e.number == var
        }
    found = {c.at for c in details.conditions if c.var == var}
    return found | {"end" if e.at_end else "start" for e in details.effects if e.var == var}


def in_their_order(
    problem: Problem,
    decisions: Sequence[Decision],
    changes: Sequence[ChangeActivity],
    tolerance: Fraction | int,
) -> list[Decision]:
    """The decisions, in which each change has a place among the ends of its instant.

    An engine does not say where a change comes; every place is tried until all conditions before
    the next change of the same variable find their values. (Ranks are spread, so that there is a
    place between any two.) Raises `AnswerError` where no place suits.
    """
    spread = [replace(d, rank=3 * d.rank, end_rank=3 * d.end_rank) for d in decisions]
    for change in changes:
        spread[change.index] = Decision(change.at, change.at)
    following = dict[tuple[int, bool], int]()
    until = list[int | None]()
    for change in reversed(changes):
        until.append(following.get((change.var, change.number)))
        following[change.var, change.number] = change.at
    for change, end_of_view in zip(changes, reversed(until), strict=True):
        moments: dict[_Key, None] = {(change.at, -1): None}
        for i in range(len(problem.activities) - len(changes)):
            end, rank = spread[i].end, spread[i].end_rank
            if _touches(problem.activities[i], change) and (
                spread[i].start < change.at <= end <= change.at + tolerance
            ):
                moments |= {(end, rank - 1): None, (end, rank): None, (end, rank + 1): None}
        seen = problem if end_of_view is None else _before(problem, spread, change, end_of_view)
        spread[change.index] = _best_place(seen, spread, change, sorted(moments), tolerance)
    return spread


def _before(
    problem: Problem, decisions: Sequence[Decision], change: ChangeActivity, until: int
) -> Problem:
    """The problem as far as the variable of a change is read, held or changed before a time.

    What holds beyond that time holds on both sides of the instant of the change, wherever in it
    the change comes.
    """
    kept = []
    for activity, decision in zip(problem.activities, decisions, strict=True):
        starts, ends = decision.start < until, decision.end < until
        if ends or not _touches(activity, change):
            kept.append(activity)
            continue
        kept.append(replace(activity, details=_left_of(activity.details, change, starts)))
    return replace(problem, activities=tuple(kept), goals=(), number_goals=())


def _left_of(details: Details, change: ChangeActivity, starts: bool) -> Details:
    """The details without what touches the variable of a change; at the start it stays if `starts`
    says so.
    """

    def stays(var: int, number: bool, at_start: bool) -> bool:
        return (var, number) != (change.var, change.number) or (starts and at_start)

    return replace(
        details,
        conditions=tuple(c for c in details.conditions if stays(c.var, False, c.at == "start")),
        effects=tuple(e for e in details.effects if stays(e.var, False, not e.at_end)),
        number_conditions=tuple(
            c for c in details.number_conditions if stays(c.number, True, c.at == "start")
        ),
        number_effects=tuple(
            e for e in details.number_effects if stays(e.number, True, not e.at_end)
        ),
    )


def _best_place(
    problem: Problem,
    decisions: list[Decision],
    change: ChangeActivity,
    moments: Sequence[tuple[Fraction | int, int]],
    tolerance: Fraction | int,
) -> Decision:
    """The first place that suits exactly, else the last one that suits within the tolerance."""
    usable: Decision | None = None
    error: AnswerError | None = None
    for time, rank in moments:
        place = Decision(time, time, rank=rank, end_rank=rank)
        decisions[change.index] = place
        suits = number_suits if change.number else _suits
        if suits(problem, decisions, change.var):
            return place
        try:
            if change.number:
                list(number_orders(problem, decisions, tolerance, only=change.var))
            else:
                state_orders(problem, decisions, tolerance, only=change.var)
        except AnswerError as found:
            error = found
        else:
            usable = place
    if usable is None:
        raise error or AnswerError("the answer leaves a timed change no place")
    return usable


def _suits(problem: Problem, decisions: Sequence[Decision], var: int) -> bool:
    """Whether all conditions and goals on a variable hold exactly, and nothing interferes."""
    reads: list[tuple[_Key, int, int]] = []
    writes: list[tuple[_Key, int, int]] = []
    holds: list[tuple[_Key, _Key, int]] = []
    last: Fraction | int = 0
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        start, end = (decision.start, decision.rank), (decision.end, decision.end_rank)
        if is_one_happening(activity, decision):
            end = start
        if activity.origin:
            last = max(last, decision.end)
        for c in activity.details.conditions:
            if c.var == var and c.at == "all" and start != end:
                holds.append((start, end, c.value))
            elif c.var == var:
                reads.append((end if c.at == "end" else start, i, c.value))
        own = (e for e in activity.details.effects if e.var == var)
        writes += [(end if e.at_end else start, i, e.value) for e in own]
    initial = problem.variables[var].initial

    def before(key: _Key) -> int:
        found = [(at, value) for at, _, value in writes if at < key]
        return max(found)[1] if found else initial

    touched = [(at, i) for at, i, _ in (*writes, *reads)]
    return (
        all(at != k or i == j for at, i, _ in writes for k, j in touched)
        and all(before(at) == value for at, _, value in reads)
        and all(before((a[0], a[1] + 1)) == value for a, _, value in holds)
        and all(not a < at < b or x == v for a, b, v in holds for at, _, x in writes)
        and all(before((last + 1, 0)) == value for v, value in problem.goals if v == var)
    )


def change_orders(
    problem: Problem,
    decisions: Sequence[Decision],
    changes: Sequence[ChangeActivity],
    points: PointMap,
    network: Network,
) -> Iterator[HappeningOrder]:
    """The orders of changes and of the starts that come after them."""
    for change in changes:
        for i in range(len(problem.activities) - len(changes)):
            touches = _touches(problem.activities[i], change)
            if touches and decisions[i].start >= change.at:
                one = is_one_happening(problem.activities[i], decisions[i])
                world = Happening(change.index, False)
                yield HappeningOrder(world, Happening(i, False), "start" in touches or one)
    _keep_goals(problem, decisions, changes, points, network)


def _keep_goals(
    problem: Problem,
    decisions: Sequence[Decision],
    changes: Sequence[ChangeActivity],
    points: PointMap,
    network: Network,
) -> None:
    """A goal that the last change brings about needs an end at that change or later."""
    count = len(problem.activities) - len(changes)
    last = max(range(count), key=lambda i: decisions[i].end, default=None)
    if last is None:
        return
    goals = {(var, False) for var, _ in problem.goals}
    goals |= {(goal.number, True) for goal in problem.number_goals}
    for var, number in sorted(goals):
        own = [
            c for c in changes if (c.var, c.number) == (var, number) and c.at <= decisions[last].end
        ]
        if own and _brings_about(problem, own[-1]):
            change = points.start[own[-1].index]
            network.add(change, points.end[last], -points.end_offset[last])


def _brings_about(problem: Problem, change: ChangeActivity) -> bool:
    """Whether a goal may rest on a change. (Whatever adds to a number may come after it.)"""
    details = problem.activities[change.index].details
    if change.number:
        return True
    return any(goal == (change.var, details.effects[0].value) for goal in problem.goals)
