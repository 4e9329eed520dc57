"""Ranks: the order within an instant, once all times are known.

Every demand is a difference, rank(b) >= rank(a) + 0 or 1, between happenings of equal times, or
that are exactly a lag or a duration apart: by state, by hand-overs of resources, and by stock. The
least solution is taken, so a rank is 0 wherever nothing demands more. The history keeps its ranks.

**Ranks exist if the times were found by the same demands.** Each of these edges is also a
constraint on the times, and tight. So the weights of a cycle of them add up to 0 in time, and the
cycle is tight in *every* schedule that keeps the order, in that of the answer too, whose own
ranks satisfied it: a cycle that demands more than 0 would mean that the answer was none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from irc.problem import Problem, Ranks
from irc.problem.decisions import AnswerError, Placed
from irc.problem.temporal_network import Network, earliest
from irc.problem.time_points import PointMap, point_map
from irc.retiming.state import Happening, HappeningOrder
from irc.retiming.stock import Batches


def with_ranks(
    problem: Problem,
    placed: Sequence[Placed],
    orders: Sequence[HappeningOrder],
    batches: Sequence[Batches] = (),
) -> tuple[Placed, ...]:
    """The same times, with the least ranks that keep the orders, arcs and state precedences.

    `batches` are happenings that come no earlier than those of the previous batch. Every activity
    of the problem must be present, and its durations those of its mode. Raises `AnswerError` where
    no ranks exist.
    """
    strict = [
        *(order for order in orders if order.strict),
        *(
            HappeningOrder(Happening(a, True), Happening(b, False), True)
            for a, b in problem.state_precedences
        ),
    ]
    known = any(a.details.ranks or a.details.not_before for a in problem.activities)
    if not known and not any(_time(placed, o.before) == _time(placed, o.after) for o in strict):
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
    for own in batches:
        _add_batches(placed, points, network, own)
    _add_known(problem, points, network)
    ranks = earliest(network, _least_ranks(problem, placed, points, network.size))
    if ranks.cycles:
        owner = {points.start[i]: i for i in range(len(placed))}
        owner.update((points.end[i], i) for i in range(len(placed)))
        circle = dict.fromkeys(
            owner[point] for edge in ranks.cycles[0] if (point := network.src[edge]) in owner
        )
        names = ", ".join(repr(problem.activities[i].id) for i in circle)
        raise AnswerError(
            f"the answer has {names} come one after the other in a circle at one instant"
        )
    return tuple(
        replace(place, rank=ranks.t[points.start[i]], end_rank=ranks.t[points.end[i]])
        for i, place in enumerate(placed)
    )


def _add_batches(
    placed: Sequence[Placed], points: PointMap, network: Network, batches: Batches
) -> None:
    """Adds a point of its own between two batches that meet at one instant."""
    for before, after in pairwise(batches):
        last = max(_time(placed, happening) for happening in before)
        if last != min(_time(placed, happening) for happening in after):
            continue
        boundary = network.size
        network.size += 1
        for happening in before:
            if _time(placed, happening) == last:
                network.add(_point(points, happening), boundary, 0)
        for happening in after:
            if _time(placed, happening) == last:
                network.add(boundary, _point(points, happening), 0)


def _add_known(problem: Problem, points: PointMap, network: Network) -> None:
    """Adds known ranks, counted from a point of rank 0."""
    origin = network.size
    for i, activity in enumerate(problem.activities):
        ranks = activity.details.ranks or Ranks(None, None)
        for point, rank in ((points.start[i], ranks.start), (points.end[i], ranks.end)):
            if rank is not None and not ranks.at_least:
                network.size = origin + 1
                network.add(origin, point, rank)
                network.add(point, origin, -rank)


def _least_ranks(
    problem: Problem, placed: Sequence[Placed], points: PointMap, size: int
) -> list[int]:
    """The least rank of each point, as far as the history demands it."""
    floors = [0] * size
    for i, activity in enumerate(problem.activities):
        ranks, not_before = activity.details.ranks, activity.details.not_before
        if ranks is not None and ranks.start is not None:
            floors[points.start[i]] = ranks.start
        if not_before is not None and placed[i].start == not_before[0]:
            floors[points.start[i]] = max(floors[points.start[i]], not_before[1])
    return floors


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
        known = activity.details.ranks
        if start == end or (known is not None and None not in (known.start, known.end)):
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
