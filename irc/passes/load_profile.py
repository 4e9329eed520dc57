"""The profile of a batch resource in list schedules: its loads, and its capacity over time."""

from __future__ import annotations

from irc.passes.resource_profile import UNREACHABLE_TIME, Profile
from irc.problem import NO_FAMILY, ContendedPool


class LoadProfile(Profile):
    """The loads of one batch resource: what joins one has its times and its family."""

    def __init__(self, pool: ContendedPool) -> None:
        self.loads: dict[tuple[int, int], int] = {}
        """The family of each load, by its start and end."""
        super().__init__(pool)
        self.loads.clear()  # (Windows are no loads.)

    def blocked_until(
        self, start: int, end: int, amount: int, family: int = NO_FAMILY
    ) -> int | None:
        """None if `amount` more can be a load of its own, or join one, over [start, end).

        Else the next time worth trying: the start of a load that it may join, or the end of one.
        """
        blocked = super().blocked_until(start, end, amount)
        over = [span for span in self.loads if span[0] < end and start < span[1]]
        if not over or (over == [(start, end)] and self.loads[start, end] == family):
            if blocked is None:
                return None
            later = [blocked]
        else:
            later = [span[1] for span in over]
        length = end - start
        later += [
            begin
            for (begin, until), of in self.loads.items()
            if begin > start and until - begin == length and of == family
        ]
        return min((time for time in later if time > start), default=UNREACHABLE_TIME)

    def first_room(
        self, start: int, duration: int, amount: int, family: int = NO_FAMILY
    ) -> int | None:
        """The first time from `start` on at which `amount` more can be in a load of its family."""
        while (wait := self.blocked_until(start, start + duration, amount, family)) is not None:
            if wait == UNREACHABLE_TIME:
                return None
            start = wait
        return start

    def take(self, start: int, end: int, amount: int, family: int = NO_FAMILY) -> None:
        """Adds `amount` to the load over [start, end)."""
        super().take(start, end, amount)
        self.loads[start, end] = family
