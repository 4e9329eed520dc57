"""The resource profile: the amount of a pool that is in use, over time."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import Self

from irc.problem import NO_FAMILY, ContendedPool

UNREACHABLE_TIME = 1 << 62
"""Later than any time: an activity that waits for it finds no place."""


class Profile:
    """The amount of one pool that is in use or not available: a step function of time."""

    def __init__(self, pool: ContendedPool) -> None:
        self.capacity = pool.capacity
        base = pool.capacity if pool.base is None else pool.base
        self.times = [0]
        self.used = [pool.capacity - base]
        for window in pool.windows:
            self.take(window.start, window.end, base - window.capacity)

    def copy(self) -> Self:
        """Another profile with the same contents."""
        other = object.__new__(type(self))
        other.capacity, other.times, other.used = self.capacity, [*self.times], [*self.used]
        return other

    def blocked_until(
        self, start: int, end: int, amount: int, family: int = NO_FAMILY
    ) -> int | None:
        """None if `amount` more fits throughout [start, end), else the next time worth trying.

        The `family` matters for loads only.
        """
        k = bisect_right(self.times, start) - 1
        limit = self.capacity - amount
        while k < len(self.times) and self.times[k] < end:
            if self.used[k] > limit:
                while k < len(self.times) and self.used[k] > limit:
                    k += 1
                return self.times[k] if k < len(self.times) else UNREACHABLE_TIME
            k += 1
        return None

    def first_room(
        self, start: int, duration: int, amount: int, family: int = NO_FAMILY
    ) -> int | None:
        """The first time from `start` on at which `amount` more fits for a duration above 0.

        None where there is none.
        """
        times, used, limit = self.times, self.used, self.capacity - amount
        count = len(times)
        k = bisect_right(times, start) - 1
        while k < count:
            if used[k] > limit:
                k += 1
                continue
            start = max(start, times[k])
            end = start + duration
            while k < count and times[k] < end and used[k] <= limit:
                k += 1
            if k == count or times[k] >= end:
                return start
        return None

    def first_without(self, start: int, end: int, amount: int) -> int | None:
        """The first time in [start, end) at which `amount` more does not fit; None: it fits."""
        limit = self.capacity - amount
        for k in range(bisect_right(self.times, start) - 1, bisect_left(self.times, end)):
            if self.used[k] > limit:
                return max(start, self.times[k])
        return None

    def room_between(self, start: int, end: int) -> int:
        """The amount that is free over [start, end), times the duration for which it is."""
        total = 0
        for k, used in enumerate(self.used):
            until = self.times[k + 1] if k + 1 < len(self.times) else end
            length = min(until, end) - max(self.times[k], start)
            total += max(0, length) * max(0, self.capacity - used)
        return total

    def take(self, start: int, end: int, amount: int, family: int = NO_FAMILY) -> None:
        """Adds `amount` over [start, end)."""
        first, last = self._split(start), self._split(end)
        for k in range(first, last):
            self.used[k] += amount

    def _split(self, time: int) -> int:
        k = bisect_right(self.times, time) - 1
        if self.times[k] != time:
            k += 1
            self.times.insert(k, time)
            self.used.insert(k, self.used[k - 1])
        return k
