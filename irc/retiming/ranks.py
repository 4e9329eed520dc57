"""Ranks: the order within an instant, once all times are known.

Every demand is a difference, rank(b) >= rank(a) + 0 or 1, between happenings of equal times, or
that are exactly a lag or a duration apart. The least solution is taken, so a rank is 0 wherever
nothing needs more.

**Ranks exist if the times were found by the same demands.** Each of these edges is also a
constraint on the times, and tight. So the weights of a cycle of them add up to 0 in time, and the
cycle is tight in *every* schedule that keeps the order, in that of the answer too, whose own
ranks satisfied it: a cycle that demands more than 0 would mean that the answer was none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from irc.problem import Problem
from irc.problem.decisions import AnswerError, Placed
from irc.problem.temporal_network import Network, earliest
from irc.problem.time_points import PointMap, point_map
from irc.retiming.state import Happening, Order


def with_ranks(
    problem: Problem, placed: Sequence[Placed], orders: Sequence[Order]
) -> tuple[Placed, ...]:
    """The same times with the least ranks that keep the orders, the arcs and the state
    precedences.

    Every activity of the problem must be present, and its durations those of its mode. Raises
    `AnswerError` where no ranks exist.
    """
    strict = [
        *(order for order in orders if order.strict),
        *(
            Order(Happening(a, True), Happening(b, False), True)
            for a, b in problem.state_precedences
        ),
    ]
    if not any(_time(placed, o.before) == _time(placed, o.after) for o in strict):
        return tuple(placed)
    points = point_map(problem)
    network = Network(points.size)
    for order in (*strict, *(order for order in orders if not order.strict)):
        if _time(placed, order.before) == _time(placed, order.after):
            network.add(
                _point(points, order.before), _point(points, order.after), int(order.strict)
            )
    _add_lags(problem, placed, points, network)
    _add_durations(problem, placed, points, network)
    ranks = earliest(network, [0] * points.size)
    if ranks.cycles:
        owner = {points.start[i]: i for i in range(len(placed))}
        owner.update((points.end[i], i) for i in range(len(placed)))
        circle = dict.fromkeys(owner[network.src[edge]] for edge in ranks.cycles[0])
        names = ", ".join(repr(problem.activities[i].id) for i in circle)
        raise AnswerError(
            f"the answer has {names} come one after the other in a circle at one instant"
        )
    return tuple(
        replace(place, rank=ranks.t[points.start[i]], end_rank=ranks.t[points.end[i]])
        for i, place in enumerate(placed)
    )


def _add_lags(
    problem: Problem, placed: Sequence[Placed], points: PointMap, network: Network
) -> None:
    for arc in problem.arcs:
        before, after = Happening(arc.before, arc.from_end), Happening(arc.after, arc.to_end)
        if _time(placed, before) + arc.min_lag == _time(placed, after):
            a, b = _point(points, before), _point(points, after)
            if a != b:
                network.add(a, b, 0)


def _add_durations(
    problem: Problem, placed: Sequence[Placed], points: PointMap, network: Network
) -> None:
    for i, (activity, place) in enumerate(zip(problem.activities, placed, strict=True)):
        start, end = points.start[i], points.end[i]
        if start == end:
            continue
        if place.end - place.start == activity.duration_min:
            network.add(start, end, 0)
        if place.end - place.start == activity.duration_max:
            network.add(end, start, 0)


def _time(placed: Sequence[Placed], happening: Happening) -> int:
    place = placed[happening.activity]
    return place.end if happening.at_end else place.start


def _point(points: PointMap, happening: Happening) -> int:
    return (points.end if happening.at_end else points.start)[happening.activity]
