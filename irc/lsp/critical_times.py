"""The critical-path times of each action, without a solver: its earliest start and its slack.

Durations, lags, releases, fixed starts, deadlines and state precedences count, resources do not. If
resources make the makespan longer than the critical path, the slack of a schedule
(`irc.retiming.slack`) is different.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from irc.passes import order_from_state
from irc.passes.mandatory import mandatory_part
from irc.problem import Problem
from irc.problem.temporal_network import earliest
from irc.problem.time_points import latest_times, timing_network


@dataclass(frozen=True, slots=True)
class StartTimes:
    """The earliest and latest start of an action, in ticks. After a start later than `latest`, the
    makespan is longer than the critical path, or a deadline is missed."""

    earliest: int
    latest: int

    @property
    def slack(self) -> int:
        """The time between the two."""
        return self.latest - self.earliest


@dataclass(frozen=True)
class CriticalTimes:
    """The length of the critical path, and the times of all actions in every schedule."""

    length: int
    times: Mapping[str, StartTimes]


def critical_times(problem: Problem) -> CriticalTimes | None:
    """The critical-path times of a problem; None if its times contradict each other."""
    core, way = mandatory_part(order_from_state(problem))
    timing = timing_network(core)
    points = timing.points
    forward = earliest(timing.network, timing.floors)
    if forward.cycles:
        return None
    ends = zip(points.end, points.end_offset, strict=True)
    length = max((forward.t[point] + offset for point, offset in ends), default=0)
    latest = latest_times(core, points, timing.network, length)
    if latest is None:
        return None
    times = {}
    for i, place in way.activities.new.items():
        point = points.start[place]
        found = StartTimes(forward.t[point], latest[point])
        if found.slack < 0:
            return None
        times[problem.activities[i].id] = found
    return CriticalTimes(length, times)
