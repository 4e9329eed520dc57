"""What time alone says of each action, without a solver: its earliest start, and its slack.

Durations, lags, releases, fixed starts, deadlines and what state orders count; who waits for a
resource does not: where resources make the whole longer than the critical path, the slack of a
schedule (`irc.retiming.slack`) is another.
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
class Times:
    """In ticks: no start is earlier than `earliest`; a start later than `latest` makes the whole
    take longer than the critical path, or misses a deadline."""

    earliest: int
    latest: int

    @property
    def slack(self) -> int:
        """How far the two are apart."""
        return self.latest - self.earliest


@dataclass(frozen=True)
class Outlook:
    """The critical path's length and, by action id, the times of what every schedule contains."""

    length: int
    times: Mapping[str, Times]


def outlook(problem: Problem) -> Outlook | None:
    """The outlook of a problem without errors; None where its times contradict each other."""
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
        found = Times(forward.t[point], latest[point])
        if found.slack < 0:
            return None
        times[problem.activities[i].id] = found
    return Outlook(length, times)
