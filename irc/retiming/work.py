"""Re-timing of activities that pause, or have a calendar: ends as a function of starts.

The end of work grows with its start, and the start that an end needs grows with the end; so does
the first open time from a time on. So the least solution of all constraints exists; it is reached
from below, one point after another in the order of the answer.

A limit of the pause is no such function, for an earlier start may pause for longer: an activity
that has one stays in the open time in which it starts. There an earlier start pauses no longer.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from fractions import Fraction
from heapq import heapify, heappop, heappush
from typing import NamedTuple

from irc.problem import Problem
from irc.problem.decisions import AnswerError, Decision
from irc.problem.temporal_network import Network, Times, earliest
from irc.problem.time_points import PointMap
from irc.problem.work_times import WorkTimes, WorkTimesOf, work_range

MOST_RAISES = 100_000
"""A point is raised at most this often: none is raised above the answer's own times."""


class _Timed(NamedTuple):
    """The points of an activity, its open times, and its working time where it pauses."""

    start: int
    end: int
    offset: int
    times: WorkTimes
    work: tuple[int, int] | None


def earliest_with_work(
    problem: Problem,
    decisions: Sequence[Decision],
    chosen: Sequence[tuple[int, ...]],
    points: PointMap,
    network: Network,
    floors: list[int],
    tolerance: Fraction | int,
) -> Times:
    """The earliest times that keep a network, open times and pauses; `floors` are raised.

    Raises `AnswerError` where an activity does not start at an open time.
    """
    parts = []
    times_of = WorkTimesOf(problem)
    for i, activity in enumerate(problem.activities):
        details = activity.details
        if details.paused or (details.calendar is None and not details.work):
            continue
        decision, holds = decisions[i], chosen[i] if activity.details.work else ()
        if decision.end - decision.start <= tolerance:
            holds = ()
        times = times_of.of(activity, holds)
        start = points.start[i]
        opened = _segment(activity.id, times, decision, tolerance)
        if details.max_pause is not None:
            floors[start] = max(floors[start], opened)
        work = work_range(activity, None) if details.work else None
        parts.append(_Timed(start, points.end[i], points.end_offset[i], times, work))
    found = earliest(network, floors)
    if found.cycles or not parts:
        return found
    # (A network may have points beside those of the activities, for the order of stock.)
    order = _order(decisions, points)
    order += [0] * (len(found.t) - len(order))
    floors[:] = _at_earliest(network, found.t, parts, order)
    return earliest(network, floors)


def _order(decisions: Sequence[Decision], points: PointMap) -> list[Fraction | int]:
    """The time of each point in the answer."""
    order: list[Fraction | int] = [0] * points.size
    for start, end, decision in zip(points.start, points.end, decisions, strict=True):
        order[end] = decision.end
        order[start] = decision.start
    return order


def _at_earliest(
    network: Network, t: list[int], parts: Sequence[_Timed], order: Sequence[Fraction | int]
) -> list[int]:
    """The least times from `t` on that keep a network and all open times."""
    after: list[list[tuple[int, int]]] = [[] for _ in t]
    for src, dst, weight in zip(network.src, network.dst, network.weight, strict=True):
        after[src].append((dst, weight))
    own = {point: part for part in parts for point in (part.start, part.end)}
    t, raises = list(t), [0] * len(t)
    queue = [(order[part.start], part.start) for part in parts]
    heapify(queue)
    while queue:
        _, point = heappop(queue)
        needed = [(dst, t[point] + weight) for dst, weight in after[point]]
        if point in own:
            part = own[point]
            start, end = _needed(part, t[part.start], t[part.end])
            needed += [(part.start, start), (part.end, end)]
        for other, time in needed:
            if time > t[other]:
                t[other] = time
                raises[other] += 1
                heappush(queue, (order[other], other))
        if raises[point] > MOST_RAISES:
            raise AnswerError("the work of the answer does not fit into its open times")
    return t


def _segment(name: str, times: WorkTimes, decision: Decision, tolerance: Fraction | int) -> int:
    """The beginning of the open time in which an activity starts."""
    for time in (decision.start, decision.start + tolerance):
        place = times.place(int(time // 1))
        if place is not None:
            return times.starts[place]
    raise AnswerError(f"{name!r} starts at a closed time")


def _needed(part: _Timed, start: int, end: int) -> tuple[int, int]:
    """The least times of an activity's points in its open times, no earlier than these."""
    opened = part.times.start_from(start)
    if opened is None:
        raise AnswerError("a start of the answer comes after all open times")
    if part.work is not None:
        return _working(part.times, part.work, opened, end)
    return _fitting(part, opened, end), end


def _fitting(part: _Timed, start: int, end: int) -> int:
    """The least start of what must end in its open time, no earlier than an open `start`."""
    end = start + part.offset if part.start == part.end else max(start, end)
    k = bisect_left(part.times.ends, end)
    if k == len(part.times.ends):
        raise AnswerError("an end of the answer comes after all open times")
    return max(start, part.times.starts[k])


def _working(times: WorkTimes, work: tuple[int, int], start: int, end: int) -> tuple[int, int]:
    """The least start and end of work that pauses, no earlier than an open `start` and an end."""
    least, most = work
    soonest = times.end(start, least)
    if soonest is None:
        raise AnswerError("the work of the answer does not fit into its open times")
    end = max(end, soonest)
    if end == start:
        return start, end
    allowed = times.next_end(end)
    if allowed is None:
        raise AnswerError("an end of the answer comes after all open times")
    return max(start, times.last_start(times.work_before(allowed) - most)), allowed
