"""Re-timing of activities that pause, or have a calendar: ends as a function of starts.

An activity stays in the open time in which it starts. From there the end of its work grows with its
start, and the start that an end needs grows with the end. So the least solution of all constraints
exists; it is reached from below, by turns: the temporal network, then these functions as floors.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from irc.problem import Problem
from irc.problem.decisions import AnswerError, Decision
from irc.problem.temporal_network import Network, Times, earliest
from irc.problem.time_points import PointMap
from irc.problem.work_times import WorkTimes, WorkTimesOf, work_range

ROUNDS = 100_000
"""At most this many turns; each raises a floor, and none is raised above the answer's own times."""


class _Working(NamedTuple):
    start: int
    end: int
    times: WorkTimes
    work: tuple[int, int]


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
    pausing = []
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
        floors[start] = max(floors[start], _segment(activity.id, times, decision, tolerance))
        if activity.details.work:
            work = work_range(activity, None)
            pausing.append(_Working(start, points.end[i], times, work))
    for _ in range(ROUNDS):
        found = earliest(network, floors)
        if found.cycles:
            return found
        raised = [_raise(found, part, floors) for part in pausing]
        if not any(raised):
            return found
    raise AnswerError("the work of the answer does not fit into its open times")


def _segment(name: str, times: WorkTimes, decision: Decision, tolerance: Fraction | int) -> int:
    """The beginning of the open time in which an activity starts."""
    for time in (decision.start, decision.start + tolerance):
        place = times.place(int(time // 1))
        if place is not None:
            return times.starts[place]
    raise AnswerError(f"{name!r} starts at a closed time")


def _raise(found: Times, part: _Working, floors: list[int]) -> bool:
    """Raises the floors of one activity to what its work needs; whether any was raised."""
    start, end = found.t[part.start], found.t[part.end]
    times, (least, most) = part.times, part.work
    soonest = times.end(start, least)
    if soonest is None:
        raise AnswerError("the work of the answer does not fit into its open times")
    end = max(end, soonest)
    if end > start:
        allowed = times.next_end(end)
        if allowed is None:
            raise AnswerError("an end of the answer comes after all open times")
        end = allowed
        needed = times.last_start(times.work_before(end) - most)
    else:
        needed = start
    raised = (end > floors[part.end] and end > found.t[part.end]) or needed > start
    floors[part.end] = max(floors[part.end], end)
    floors[part.start] = max(floors[part.start], needed)
    return raised
