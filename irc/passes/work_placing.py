"""Places activities with calendars or pauses for serial schedule generation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice, product

from irc.passes.resource_profile import UNREACHABLE_TIME, Profile
from irc.problem import Activity, Problem
from irc.problem.work_times import WorkTimes, WorkTimesOf, work_range

MOST_CHOICES = 16
"""At most this many choices of resources are tried for one activity."""

Spot = tuple[int, int, tuple[int, ...]]
"""The start, the end and the pool of each open demand."""


class WorkPlacer:
    """Finds the first end of activities with a calendar or pauses beside those that are placed."""

    def __init__(self, problem: Problem, profiles: Sequence[Profile]) -> None:
        self.problem, self.profiles = problem, profiles
        self.times = WorkTimesOf(problem)
        # What pauses keeps its units while there is no capacity.
        self.paused = [
            Profile(pool.never_away) if pool.windows else profile
            for pool, profile in zip(problem.contention.pools, profiles, strict=True)
        ]

    def place(self, activity: Activity, start: int) -> Spot | None:
        """The place with the first end, from a start on; None where there is none."""
        demands = activity.open_demands if activity.duration_min else ()
        choices = islice(product(*(d.alternatives for d in demands)), MOST_CHOICES)
        spots = (self._spot(activity, start, choice) for choice in choices)
        found = [spot for spot in spots if spot is not None]
        if activity.start is not None and activity.details.paused:
            end = activity.start + activity.duration_min
            found = [(activity.start, end, tuple(d.alternatives[0] for d in demands))]
        if not found:
            return None
        best = min(found, key=lambda spot: (spot[1], spot[0]))
        self.take(activity, best)
        if not demands:
            best = (*best[:2], tuple(d.alternatives[0] for d in activity.open_demands))
        return best

    def take(self, activity: Activity, spot: Spot) -> None:
        """Takes the units of an activity at its place."""
        start, end, choice = spot
        for demand, r in zip(activity.open_demands, choice, strict=False):
            self.profiles[r].take(start, end, demand.amount)
            if self.paused[r] is not self.profiles[r]:
                self.paused[r].take(start, end, demand.amount)

    def _spot(self, activity: Activity, start: int, choice: tuple[int, ...]) -> Spot | None:
        pools = self.problem.contention.pools
        pauses = bool(activity.details.work)
        windowed = [pools[r].members[0] for r in choice if pools[r].windows] if pauses else ()
        times = self.times.of(activity, windowed)
        amounts: dict[int, int] = {}
        least = work_range(activity, None)[0]
        for demand, r in zip(activity.open_demands, choice, strict=False):
            amounts[r] = amounts.get(r, 0) + demand.amount
        if any(amount > pools[r].capacity for r, amount in amounts.items()):
            return None
        while (span := next(spans(times, activity, start, least), None)) is not None:
            begin, end = span
            blocked = self._blocked(amounts, begin, end, pauses)
            if blocked is None:
                return begin, end, choice
            if blocked >= UNREACHABLE_TIME:
                return None
            start = max(blocked, begin + 1)
        return None

    def _blocked(self, amounts: dict[int, int], start: int, end: int, pauses: bool) -> int | None:
        profiles = self.paused if pauses else self.profiles
        waits = (profiles[r].blocked_until(start, end, n) for r, n in amounts.items())
        return max((wait for wait in waits if wait is not None), default=None)


def spans(
    times: WorkTimes, activity: Activity, start: int, least: int
) -> Iterator[tuple[int, int]]:
    """The starts, from a time on, that open times allow for `least` of working time, each with its
    end; the soonest first."""
    limit = activity.details.max_pause if activity.details.work else 0
    at: int | None = times.start_from(start)
    while at is not None:
        end = times.end(at, least)
        if end is None:
            return
        if limit is None or end - at - least <= limit:
            yield at, end
        place = times.place(at)
        at = None if place is None else times.start_from(times.ends[place])
