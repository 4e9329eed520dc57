"""Places activities with calendars or pauses on resources with set-ups, for list schedules."""

from __future__ import annotations

from itertools import islice, product
from typing import TYPE_CHECKING

from irc.passes.resource_profile import UNREACHABLE_TIME, Profile
from irc.passes.work_placing import MOST_CHOICES, spans
from irc.problem.work_times import WorkTimesOf

if TYPE_CHECKING:
    from irc.passes.setup_schedule import Choice, Fit, SetupSearch, Way


class WorkSpots:
    """Finds the first end of a way to carry out an activity, beside those that are placed."""

    def __init__(self, search: SetupSearch) -> None:
        self.search = search
        self.times = WorkTimesOf(search.problem)
        # What pauses keeps its units while there is no capacity.
        self.first_paused = [
            Profile(pool.never_away) if pool.windows else None
            for pool in search.problem.contention.pools
        ]
        self.clear()

    def clear(self) -> None:
        """Takes everything away that was placed."""
        from irc.passes.setup_schedule import copied

        self.paused = [None if p is None else copied(p) for p in self.first_paused]

    def take(self, r: int, start: int, end: int, amount: int) -> None:
        """Takes units of a pool for what pauses, too."""
        paused = self.paused[r]
        if paused is not None:
            paused.take(start, end, amount)

    def fit(self, i: int, way: Way, start: int) -> Fit | None:
        """The place with the first end from `start` on; None where there is none."""
        demands = way.demands if way.duration else []
        choices = islice(product(*(d.alternatives for d, _ in demands)), MOST_CHOICES)
        found = [spot for choice in choices if (spot := self._spot(i, way, start, choice))]
        if not found:
            return None
        best = min(found, key=lambda fit: (fit[1], fit[2], fit[0]))
        if demands:
            return best
        return *best[:3], tuple(demand.alternatives[0] for demand, _ in way.demands)

    def _spot(self, i: int, way: Way, start: int, choice: Choice) -> Fit | None:
        search, pools = self.search, self.search.problem.contention.pools
        if len({*choice}) < len(choice):
            return None
        activity = search.problem.activities[i]
        pauses = bool(activity.details.work)
        windowed = [pools[r].members[0] for r in choice if pools[r].windows] if pauses else ()
        times = self.times.of(activity, windowed)
        setup = 0
        for (demand, family), r in zip(way.demands, choice, strict=False):
            if demand.amount > pools[r].capacity:
                return None
            ready, own = search.after_setup(r, family, start)
            start, setup = max(start, ready), setup + own
        work = activity.details.work[way.mode or 0][0] if pauses else way.duration
        while (span := next(spans(times, activity, start, work), None)) is not None:
            begin, end = span
            blocked = self._blocked(way, choice, begin, end, pauses)
            if blocked is None:
                return begin, end, setup, choice
            if blocked >= UNREACHABLE_TIME:
                return None
            start = max(blocked, begin + 1)
        return None

    def _blocked(self, way: Way, choice: Choice, start: int, end: int, pauses: bool) -> int | None:
        waits = []
        for (demand, _), r in zip(way.demands, choice, strict=False):
            paused = self.paused[r] if pauses else None
            profile = self.search.profiles[r] if paused is None else paused
            waits.append(profile.blocked_until(start, end, demand.amount))
        return max((wait for wait in waits if wait is not None), default=None)
