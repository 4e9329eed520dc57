"""Checks for reservoirs that run out or overflow in every order of the actions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from irc.checks.required import greatest_occurrences, least_occurrences
from irc.diagnostics import Code, Findings
from irc.diagnostics.source import Pointer
from irc.model import Action, Mode, Task
from irc.problem import Activity, Problem, Reservoir, StockChange

_UNLIMITED = float("inf")


@dataclass
class _Totals:
    """The totals of one reservoir over the whole schedule.

    `highest` and `lowest`: the greatest and the least possible level at the end. `made` and
    `taken`: the greatest amounts that can be put in and taken out.
    """

    highest: float
    lowest: float
    made: float = 0
    taken: float = 0


def check_stock(task: Task, problem: Problem, required: frozenset[int], findings: Findings) -> None:
    """Adds reservoirs, and required actions, for which no order keeps the level within limits."""
    totals = [_Totals(r.initial, r.initial) for r in problem.reservoirs]
    for i, activity in enumerate(problem.activities):
        _count(activity, i in required, totals)
    reported: set[int] = set()
    for i in sorted(required):
        _check_single(task, problem, i, totals, reported, findings)
    for k, reservoir in enumerate(problem.reservoirs):
        if k not in reported:
            _check_sum(problem, k, reservoir, totals[k], required, findings)


def _count(activity: Activity, is_required: bool, totals: list[_Totals]) -> None:
    if not activity.details.all_stock:
        return
    greatest = greatest_occurrences(activity)
    most = _UNLIMITED if greatest is None else greatest
    least = min(max(least_occurrences(activity), int(is_required)), most)
    for k in _concerned(activity):
        amounts = [_amounts(way.stock, k) for way in activity.details.ways]
        totals[k].made += _times(most, max(made for made, _ in amounts))
        totals[k].taken += _times(most, max(taken for _, taken in amounts))
        nets = [made - taken for made, taken in amounts]
        ends = [_times(count, net) for count in (least, most) for net in nets]
        totals[k].highest += max(ends)
        totals[k].lowest += min(ends)


def _concerned(activity: Activity) -> list[int]:
    """The reservoirs that an activity changes, in some mode."""
    return sorted({change.reservoir for change in activity.details.all_stock})


def _amounts(stock: Iterable[StockChange], k: int) -> tuple[int, int]:
    """How much some changes put into a reservoir, and how much they take out of it."""
    own = [change.amount for change in stock if change.reservoir == k]
    return sum(a for a in own if a > 0), -sum(a for a in own if a < 0)


def _times(count: float, amount: int) -> float:
    """The product, in which an unlimited count of nothing is nothing."""
    return count * amount if count and amount else 0


def _check_single(
    task: Task,
    problem: Problem,
    i: int,
    totals: list[_Totals],
    reported: set[int],
    findings: Findings,
) -> None:
    """Checks one action, with the best levels that all other actions could give before it."""
    activity = problem.activities[i]
    most = greatest_occurrences(activity)
    if not activity.details.all_stock or most is None or most == 0:
        return
    for k in _concerned(activity):
        ways = [[c for c in way.stock if c.reservoir == k] for way in activity.details.ways]
        reservoir = problem.reservoirs[k]
        # What the action itself makes or takes helps only its other occurrences.
        highest = reservoir.initial + totals[k].made - max(_amounts(own, k)[0] for own in ways)
        lowest = reservoir.initial - totals[k].taken + max(_amounts(own, k)[1] for own in ways)
        lacks = [_lack(_levels(activity, own), highest, reservoir) for own in ways]
        excesses = [_excess(_levels(activity, own), lowest, reservoir) for own in ways]
        if all(lacks):
            reported.add(k)
            _report_lack(task, activity, reservoir, highest, min(map(int, lacks)), findings)
        elif all(excesses):
            reported.add(k)
            _report_excess(task, activity, reservoir, lowest, min(map(int, excesses)), findings)


def _lack(levels: Sequence[int], highest: float, reservoir: Reservoir) -> int:
    """How much the first change takes that cannot be there; 0 where all can."""
    return next((-change for change in levels if highest + change < reservoir.least), 0)


def _excess(levels: Sequence[int], lowest: float, reservoir: Reservoir) -> int:
    """How much the first change puts in for which there is no room; 0 where there is for all."""
    most = reservoir.greatest
    return next((c for c in levels if most is not None and lowest + c > most), 0)


def _levels(activity: Activity, own: list[StockChange]) -> list[int]:
    """The changes of the level after the start of an activity, and after its end."""
    whole = sum(c.amount for c in own)
    if activity.duration_min == 0:
        # Its two ends may be one instant, of which only the sum counts.
        return [whole]
    return [sum(c.amount for c in own if not c.at_end), whole]


def _report_lack(
    task: Task,
    activity: Activity,
    reservoir: Reservoir,
    highest: float,
    needs: int,
    findings: Findings,
) -> None:
    there = (
        f"there are only {reservoir.initial} and nothing else produces any"
        if highest == reservoir.initial
        else f"there are at most {highest}, even with everything that can be produced"
    )
    findings.add(
        Code.STOCK,
        f"action {activity.id!r} takes {needs} of {reservoir.id!r}, but {there}{_floor(reservoir)}",
        _place(task, activity, "consumes", reservoir.id),
        hint='raise "initial", let an action produce more, or let this one consume less',
    )


def _report_excess(
    task: Task,
    activity: Activity,
    reservoir: Reservoir,
    lowest: float,
    puts: int,
    findings: Findings,
) -> None:
    there = (
        f"already has {reservoir.initial}, and nothing else takes any"
        if lowest == reservoir.initial
        else f"has at least {lowest}, even after everything that can be consumed"
    )
    findings.add(
        Code.STOCK,
        f"action {activity.id!r} puts {puts} into {reservoir.id!r}, which holds at most "
        f"{reservoir.greatest} and {there}",
        _place(task, activity, "produces", reservoir.id),
        hint='raise "max", lower "initial", or let this action produce less',
    )


def _check_sum(
    problem: Problem,
    k: int,
    reservoir: Reservoir,
    total: _Totals,
    required: frozenset[int],
    findings: Findings,
) -> None:
    """Checks all required changes together, with the best of the optional ones."""
    if total.highest < reservoir.least:
        takers, sum_taken = _parties(problem, k, required, -1)
        made = sum_taken + total.highest - reservoir.initial
        produced = f" and {made} can be produced" if made else ""
        findings.add(
            Code.STOCK,
            f"{takers} take {sum_taken} of {reservoir.id!r} in all, "
            f"but it starts with {reservoir.initial}{produced}{_floor(reservoir)}",
            (*reservoir.origin, "initial"),
            hint=f'"initial" must be at least '
            f"{reservoir.initial + reservoir.least - total.highest}, "
            "or more must be produced",
        )
    elif reservoir.greatest is not None and total.lowest > reservoir.greatest:
        makers, sum_made = _parties(problem, k, required, 1)
        taken = sum_made + reservoir.initial - total.lowest
        consumed = f"; {taken} can be consumed" if taken else ""
        findings.add(
            Code.STOCK,
            f"{makers} put {sum_made} into {reservoir.id!r} in all, which starts with "
            f"{reservoir.initial} and holds at most {reservoir.greatest}{consumed}",
            (*reservoir.origin, "max"),
            hint=f'"max" must be at least {total.lowest}, or more must be consumed',
        )


def _floor(reservoir: Reservoir) -> str:
    return f", and it must not fall below {reservoir.least}" if reservoir.least else ""


_MOST_NAMED = 4


def _parties(problem: Problem, k: int, required: frozenset[int], sign: int) -> tuple[str, int]:
    """The required activities that take from (-1) or put into (1) a reservoir, and how much."""
    names: list[str] = []
    amount = 0
    for i in sorted(required):
        activity = problem.activities[i]
        amounts = [_amounts(way.stock, k) for way in activity.details.ways]
        net = min(sign * (made - taken) for made, taken in amounts)
        if net > 0:
            names.append(repr(activity.id))
            amount += net * max(1, least_occurrences(activity))
    if len(names) == 1:
        return f"the occurrences of action {names[0]}", amount
    if len(names) > _MOST_NAMED:
        return f"{len(names)} actions ({', '.join(names[:_MOST_NAMED])}, …)", amount
    return f"the actions {', '.join(names[:-1])} and {names[-1]}", amount


def _place(task: Task, activity: Activity, field: str, reservoir: str) -> Pointer:
    """The place at which an action names a reservoir in what it consumes or produces."""
    action = task.actions[int(activity.origin[1])]
    places: list[tuple[Action | Mode, Pointer]] = [(action, activity.origin)]
    places += [(m, (*activity.origin, "modes", k)) for k, m in enumerate(action.modes)]
    for part, at in places:
        for j, change in enumerate(getattr(part, field)):
            if change.resource == reservoir:
                return (*at, field, j)
    return activity.origin
