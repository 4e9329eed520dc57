"""A problem's time points and the constraints between them, as a network.

An activity of fixed duration is one point, its start; where the duration is a range its end is a
point of its own. Resources are not part of it.
"""

from __future__ import annotations

from typing import NamedTuple

from irc.problem.problem import Problem
from irc.problem.temporal_network import Network, earliest

DURATION = -1
"""Marks an edge that comes from an activity's own duration, not from an arc."""


class PointMap(NamedTuple):
    """The points of each activity's two ends: a point number and an offset to it in ticks."""

    start: list[int]
    end: list[int]
    end_offset: list[int]
    size: int


class TimingNetwork(NamedTuple):
    """The network of a problem. `labels[e]` is (arc index or `DURATION`, whether a maximum)."""

    points: PointMap
    network: Network
    floors: list[int]
    labels: list[tuple[int, bool]]
    owner: list[int]


def point_map(problem: Problem) -> PointMap:
    """The points of a problem: one for each start, and one for each end that can move by itself."""
    start, end, offset = [], [], []
    size = 0
    for activity in problem.activities:
        start.append(size)
        if activity.duration_min == activity.duration_max:
            end.append(size)
            offset.append(activity.duration_min)
        else:
            size += 1
            end.append(size)
            offset.append(0)
        size += 1
    return PointMap(start, end, offset, size)


def timing_network(problem: Problem, *, maxima: bool = True) -> TimingNetwork:
    """The network of durations and the lags of every arc; releases and so on are its floors.

    `maxima=False` leaves out maximum lags and greatest durations. The remaining constraints only
    push points later, as lower bounds need.
    """
    points = point_map(problem)
    network = Network(points.size)
    floors = [0] * points.size
    labels: list[tuple[int, bool]] = []
    owner = [0] * points.size
    for i, activity in enumerate(problem.activities):
        s, e = points.start[i], points.end[i]
        owner[s] = owner[e] = i
        floors[s] = (
            activity.release if activity.start is None else max(activity.release, activity.start)
        )
        if activity.earliest_end is not None:
            floors[e] = max(floors[e], activity.earliest_end - points.end_offset[i])
        if s != e:
            network.add(s, e, activity.duration_min)
            labels.append((DURATION, False))
            if maxima:
                network.add(e, s, -activity.duration_max)
                labels.append((DURATION, True))
    src, dst, weight = network.src, network.dst, network.weight
    starts, ends, offsets = points.start, points.end, points.end_offset
    for k, arc in enumerate(problem.arcs):
        before, after, from_end, to_end, min_lag, max_lag, _ = arc
        if from_end:
            u, from_offset = ends[before], offsets[before]
        else:
            u, from_offset = starts[before], 0
        if to_end:
            v, to_offset = ends[after], offsets[after]
        else:
            v, to_offset = starts[after], 0
        src.append(u)
        dst.append(v)
        weight.append(from_offset - to_offset + min_lag)
        labels.append((k, False))
        if max_lag is not None and maxima:
            network.add(v, u, to_offset - from_offset - max_lag)
            labels.append((k, True))
    return TimingNetwork(points, network, floors, labels, owner)


def least_times_to_end(points: PointMap, network: Network) -> list[int]:
    """The least time from each point to the end of the schedule, in ticks."""
    floors = [0] * points.size
    for end, offset in zip(points.end, points.end_offset, strict=True):
        floors[end] = offset
    return earliest(network.reversed(), floors).t


def latest_times(
    problem: Problem, points: PointMap, network: Network, limit: int
) -> list[int] | None:
    """The latest time of each point in schedules that end by `limit`, in ticks.

    Deadlines, fixed and latest starts count. None where the constraints contradict each other. A
    point whose latest time is before its earliest shows that there is no such schedule. (Latest
    times of a simple temporal network: Dechter, Meiri, Pearl 1991.)
    """
    tails = earliest(network.reversed(), _least_tails(problem, points, limit))
    return None if tails.cycles else [limit - tail for tail in tails.t]


def _least_tails(problem: Problem, points: PointMap, limit: int) -> list[int]:
    """The least time from each point to `limit`, by its own limits alone."""
    least = [0] * points.size
    for i, activity in enumerate(problem.activities):
        deadline = problem.effective_deadline(i)
        end = limit if deadline is None else min(deadline, limit)
        point = points.end[i]
        least[point] = max(least[point], limit - end + points.end_offset[i])
        point = points.start[i]
        for latest in (activity.start, activity.latest_start):
            if latest is not None:
                least[point] = max(least[point], limit - latest)
    return least
