"""Re-timing of problems with choices, state, stock or calendars.

First the times, the least that keep all orders weakly; then ranks, where times have become equal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

from irc.problem import Problem
from irc.problem.decisions import AnswerError, Decision, Placed, as_decision
from irc.problem.temporal_network import Network, earliest
from irc.problem.time_points import PointMap, timing_network
from irc.retiming.calendar import raise_floors
from irc.retiming.loads import add_loads
from irc.retiming.numbers import number_orders
from irc.retiming.ranks import with_ranks
from irc.retiming.resources import (
    add_setups,
    assign,
    long_enough,
    placed_at,
    resource_orders,
)
from irc.retiming.selection import select
from irc.retiming.state import Happening, HappeningOrder, is_one_happening, state_orders
from irc.retiming.stock import keep_stock
from irc.retiming.timed_changes import (
    ChangeActivity,
    change_orders,
    in_their_order,
    with_change_activities,
)

ROUNDS = 20
"""At most this many rounds of re-timing; nearly all cases need one."""


def retime_rich(
    problem: Problem, decisions: Sequence[Decision], tolerance: Fraction | int
) -> tuple[Placed, ...]:
    """Re-times decisions; see `irc.retiming.retime.retime`.

    Moved activities may no longer overlap, or have lost their length, and then allow an order that
    leaves more room. So the rounds go on until no activity moves any more.
    """
    selection = select(problem, decisions)
    whole, changes = with_change_activities(selection.problem)
    known = [*selection.decisions, *(Decision(change.at, change.at) for change in changes)]
    placed = _retime_once(whole, known, tolerance, changes)
    stays = not tolerance and all(_is_at(p, d) for p, d in zip(placed, known, strict=True))
    for _ in range(0 if stays else ROUNDS):
        again = _retime_once(whole, [as_decision(p) for p in placed], 0, changes)
        if again == placed:
            break
        placed = again
    return selection.spread(problem, placed[: len(placed) - len(changes)])


def _is_at(place: Placed, decision: Decision) -> bool:
    """Whether an activity is where it was decided to be, so that it asks for no further round."""
    times = place.start, place.end, place.rank, place.end_rank
    return times == (decision.start, decision.end, decision.rank, decision.end_rank)


def _retime_once(
    problem: Problem,
    decisions: Sequence[Decision],
    tolerance: Fraction | int,
    changes: Sequence[ChangeActivity],
) -> tuple[Placed, ...]:
    decisions = long_enough(problem, decisions)
    if changes:
        decisions = in_their_order(problem, decisions, changes, tolerance)
    count, moments = in_moments(decisions)
    chosen = assign(problem, moments, tolerance, count)
    timing = timing_network(problem)
    points, network, floors = timing.points, timing.network, timing.floors
    orders = state_orders(problem, decisions, tolerance)
    if problem.numbers:
        orders += number_orders(problem, decisions, tolerance)
    orders += [
        HappeningOrder(Happening(before, True), Happening(after, False), strict=False)
        for before, after in resource_orders(problem, moments, chosen, tolerance)
    ]
    for before, after in _occurrence_orders(problem, decisions):
        network.add(points.end[before], points.start[after], points.end_offset[before])
    orders += change_orders(problem, decisions, changes, points, network)
    _keep_lengths(problem, decisions, points, network, tolerance)
    _keep_orders(orders, points, network)
    add_setups(problem, moments, chosen, points, network, floors, tolerance)
    add_loads(problem, moments, chosen, points, network, tolerance)
    batches = keep_stock(problem, decisions, points, network, floors)
    raise_floors(problem, decisions, chosen, points.start, floors, tolerance)
    if problem.has_work:
        from irc.retiming.work import earliest_with_work

        times = earliest_with_work(problem, decisions, chosen, points, network, floors, tolerance)
    else:
        times = earliest(network, floors)
    if times.cycles:
        raise AnswerError("the order of the answer contradicts the lags of the task")
    return with_ranks(problem, placed_at(problem, times.t, points, chosen), orders, batches)


def in_moments(decisions: Sequence[Decision]) -> tuple[int, Sequence[Decision]]:
    """The number of moments in a tick, and the decisions in moments: time × moments + rank.

    A resource is held from moment to moment; an activity of no duration holds nothing.
    """
    count = 1 + max((max(d.rank, d.end_rank) for d in decisions), default=0)
    if count == 1:
        return 1, decisions
    return count, [
        replace(
            d,
            start=d.start * count + d.rank,
            end=d.end * count + d.end_rank if d.end > d.start else d.start * count + d.rank,
        )
        for d in decisions
    ]


def _keep_lengths(
    problem: Problem,
    decisions: Sequence[Decision],
    points: PointMap,
    network: Network,
    tolerance: Fraction | int,
) -> None:
    """Chosen to have no length: it must not grow into somebody else's time."""
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        if not activity.is_fixed and (
            decision.end - decision.start <= tolerance or is_one_happening(activity, decision)
        ):
            network.add(points.end[i], points.start[i], 0)


def _keep_orders(orders: Sequence[HappeningOrder], points: PointMap, network: Network) -> None:
    for (a, a_ends), (b, b_ends), _ in orders:
        before, offset = (points.end[a], points.end_offset[a]) if a_ends else (points.start[a], 0)
        after, back = (points.end[b], points.end_offset[b]) if b_ends else (points.start[b], 0)
        network.add(before, after, offset - back)


def _occurrence_orders(problem: Problem, decisions: Sequence[Decision]) -> list[tuple[int, int]]:
    """The orders of occurrences of one action, each with the next: they do not overlap.

    It does not matter which activity stands for which occurrence; they are numbered by start.
    """
    occurrences: dict[str, list[int]] = {}
    for i, activity in enumerate(problem.activities):
        occurrences.setdefault(activity.id, []).append(i)
    orders: list[tuple[int, int]] = []
    for same in occurrences.values():
        if len(same) > 1:
            orders += pairwise(sorted(same, key=lambda i: occurrence_key(decisions[i])))
    return orders


def occurrence_key(place: Decision | Placed) -> tuple[Fraction | int, ...]:
    """The sort key by which occurrences of one action are numbered."""
    return place.start, place.end, place.rank, place.end_rank
