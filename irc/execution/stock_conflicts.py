"""Lends stock that the history has overdrawn, or overfilled, until the history restores it.

Say flour was used before it was milled, and the level fell to -1, below its minimum of 0. Open
activities must neither suffer nor profit from that: 1 is lent at that instant, and given back when
the history itself, such as a mill that still runs, restores it. With `H` the level that
history alone gives, `lent(t) = max(0, min - H(t))` makes "the level with the loan is at least the
minimum" say just "the level is at least the minimum, or no worse than history makes it".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import NamedTuple

from irc.execution.executed import ExecutedActivity
from irc.execution.fresh_names import fresh_name
from irc.problem import Activity, Problem, StockChange

_Loans = list[int]
"""The amount lent after each of the changes that executed activities make."""

_NO_LEAST = -(1 << 50)
"""The bound of a reservoir without a least level: sums with it still fit 64 bits."""


class _Happened(NamedTuple):
    """A change of a reservoir that an executed activity makes.

    What starts at the event's instant is `behind` what has ended there: the past comes first.
    """

    time: int
    behind: bool
    activity: int
    at_end: bool
    amount: int


def with_stock_lent(
    problem: Problem, executed: Mapping[int, ExecutedActivity], now: int, *, hopes: bool
) -> tuple[Problem, bool]:
    """The problem in which the history keeps the bounds of every reservoir.

    For a bound that breaks only after `now`, with `hopes` it lends only what open activities cannot
    supply. Returns also whether anything is not lent for that reason.
    """
    hoped = False
    for k in range(len(problem.reservoirs)):
        happened = sorted(_happened(problem, executed, k, now))
        supply, demand = _open_changes(problem, executed, k) if hopes else (0, 0)
        reservoir = problem.reservoirs[k]
        room = reservoir.initial - reservoir.least
        lent = _loans(happened, room, now, supply)
        hoped = hoped or lent != _loans(happened, room, now, 0)
        excess = [0 for _ in lent]
        if reservoir.greatest is not None:
            negated = [h._replace(amount=-h.amount) for h in happened]
            above = reservoir.greatest - reservoir.initial
            excess = _loans(negated, above, now, demand)
            hoped = hoped or excess != _loans(negated, above, now, 0)
        if not any(lent) and not any(excess):
            continue
        if reservoir.greatest is not None:
            problem, twin = _with_twin(problem, k)
            problem = _lend(problem, executed, twin, happened, [-loan for loan in excess])
        problem = _lend(problem, executed, k, happened, lent)
    return problem, hoped


def _happened(
    problem: Problem, executed: Mapping[int, ExecutedActivity], k: int, now: int
) -> Iterator[_Happened]:
    for i, past in executed.items():
        for change in problem.activities[i].details.stock:
            if change.reservoir == k:
                time = past.end if change.at_end else past.start
                behind = past.start == time == now
                yield _Happened(time, behind, i, change.at_end, change.amount)


def _open_changes(
    problem: Problem, executed: Mapping[int, ExecutedActivity], k: int
) -> tuple[int | None, int | None]:
    """The greatest amounts that open activities can put in and take out; None: no limit."""
    open_details = [
        activity.details
        for i, activity in enumerate(problem.activities)
        if i not in executed and not _is_too_late(activity)
    ]

    def most(sign: int) -> int | None:
        total = 0
        for details in open_details:
            amount = max(
                sum(max(0, sign * c.amount) for c in way.stock if c.reservoir == k)
                for way in details.ways
            )
            times = 1 if details.repeats is None else details.repeats[1]
            if amount and times is None:
                return None
            total += amount * (times or 0)
        return total

    return most(1), most(-1)


def _is_too_late(activity: Activity) -> bool:
    deadline, latest = activity.deadline, activity.latest_start
    if latest is not None and latest < activity.release:
        return True
    return deadline is not None and deadline < activity.release + activity.duration_min


def _loans(happened: Sequence[_Happened], room: int, now: int, supply: int | None) -> _Loans:
    """The amount lent after each change, given the room between the level and its bound at first.

    Only the last change of an instant lends, by the net of all; at the event's instant so does the
    last of the past.
    """
    loans: _Loans = []
    loan, level = 0, room
    for (time, _), changes in groupby(happened, key=lambda h: (h.time, h.behind)):
        its = [h.amount for h in changes]
        level += sum(its)
        lacking = max(0, -level)
        if time <= now:
            after = lacking
        else:
            after = min(loan, lacking)
            if supply is not None:
                after = max(after, lacking - supply)
        loans += [loan] * (len(its) - 1) + [after]
        loan = after
    return loans


def _with_twin(problem: Problem, k: int) -> tuple[Problem, int]:
    """The problem with a reservoir split in two, one for each bound; and the upper one."""
    reservoir, twin = problem.reservoirs[k], len(problem.reservoirs)
    name = fresh_name(f"{reservoir.id} at most", {r.id for r in problem.reservoirs})

    def doubled(activity: Activity) -> Activity:
        details = activity.details
        if all(c.reservoir != k for c in details.all_stock):
            return activity
        modes = tuple(m._replace(stock=m.stock + again(m.stock)) for m in details.modes)
        details = replace(details, stock=details.stock + again(details.stock), modes=modes)
        return replace(activity, details=details)

    def again(stock: tuple[StockChange, ...]) -> tuple[StockChange, ...]:
        return tuple(c._replace(reservoir=twin) for c in stock if c.reservoir == k)

    reservoirs = list(problem.reservoirs)
    reservoirs[k] = replace(reservoir, greatest=None)
    reservoirs.append(replace(reservoir, id=name, least=_NO_LEAST))
    activities = tuple(doubled(a) for a in problem.activities)
    return replace(problem, activities=activities, reservoirs=tuple(reservoirs)), twin


def _lend(
    problem: Problem,
    executed: Mapping[int, ExecutedActivity],
    k: int,
    happened: Sequence[_Happened],
    loans: _Loans,
) -> Problem:
    """The problem in which executed activities also lend stock of reservoir k, and take it back."""
    activities = list(problem.activities)
    extra: dict[tuple[int, bool], int] = {}
    for change, before, after in zip(happened, (0, *loans), loans, strict=False):
        key = change.activity, change.at_end
        extra[key] = extra.get(key, 0) + after - before
    for (i, at_end), amount in extra.items():
        if amount:
            lent = StockChange(k, amount, at_end)
            activities[i] = _with_stock(activities[i], (*activities[i].details.stock, lent))
    if loans[-1:] != [0]:
        _pay_back(activities, executed, k, loans[-1])
    return replace(problem, activities=tuple(activities))


def _pay_back(
    activities: list[Activity], executed: Mapping[int, ExecutedActivity], k: int, loan: int
) -> None:
    """The only open supplier pays back the loan that the history never restores."""
    suppliers = {
        i
        for i, activity in enumerate(activities)
        if i not in executed
        for change in activity.details.all_stock
        if change.reservoir == k and change.amount * loan > 0
    }
    if len(suppliers) != 1:
        return
    (i,) = suppliers
    stock = activities[i].details.stock
    if stock != activities[i].details.all_stock:
        return  # Which of its modes would pay is open.
    brought = sum(c.amount for c in stock if c.reservoir == k)
    place = next(n for n, c in enumerate(stock) if c.reservoir == k and c.amount * loan > 0)
    if activities[i].details.repeats is None and abs(brought) >= abs(loan):
        paid = stock[place]._replace(amount=stock[place].amount - loan)
        activities[i] = _with_stock(activities[i], (*stock[:place], paid, *stock[place + 1 :]))


def _with_stock(activity: Activity, stock: tuple[StockChange, ...]) -> Activity:
    return replace(activity, details=replace(activity.details, stock=stock))
