"""The time that a call may take: one clock, read here and nowhere else.

A call makes one `Budget` when it begins and hands it, or parts of it, to all that works for it:
engines, the levels of an objective, repair, explanation. A part never outlives the whole.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from time import perf_counter
from typing import Self

Clock = Callable[[], float]
"""Seconds since some moment; only differences count."""


class Budget:
    """Seconds of wall-clock time that run from when it is made; without a number, no limit.

    >>> budget = Budget(10)
    >>> budget.share(0.5).limit <= 5
    True
    >>> budget.at_most(60).left <= 10
    True
    """

    __slots__ = ("_began", "_clock", "_end")

    def __init__(self, seconds: float | None = None, *, clock: Clock = perf_counter) -> None:
        self._clock = clock
        self._began = clock()
        self._end = math.inf if seconds is None else self._began + seconds

    def __repr__(self) -> str:
        return f"Budget({self.limit if self.is_limited else None})"

    def __reduce__(self) -> tuple[Callable[..., Budget], tuple[object, ...]]:
        """Elsewhere it goes on where it was: clocks of two processes have nothing in common."""
        limit = self.limit if self.is_limited else None
        return _resumed, (type(self), limit, self.elapsed, self._clock)

    @property
    def limit(self) -> float:
        """The seconds from its beginning to its end; infinite where there is no limit."""
        return self._end - self._began

    @property
    def is_limited(self) -> bool:
        """Whether it ever ends."""
        return self._end < math.inf

    @property
    def elapsed(self) -> float:
        """The seconds since it was made."""
        return self._clock() - self._began

    @property
    def left(self) -> float:
        """The seconds until it ends, never less than 0; infinite where there is no limit."""
        return max(0.0, self._end - self._clock())

    @property
    def is_over(self) -> bool:
        """Whether no time is left."""
        return self._clock() >= self._end

    def share(self, fraction: float) -> Self:
        """A part of what is left, from now on; of no limit there is no smaller part."""
        now = self._clock()
        left = max(0.0, self._end - now)
        return self._part(now, left * fraction if self.is_limited else math.inf)

    def at_most(self, seconds: float) -> Self:
        """`seconds` from now on, or what is left if that is less."""
        return self._part(self._clock(), seconds)

    def _part(self, now: float, seconds: float) -> Self:
        part = type(self).__new__(type(self))
        part._clock, part._began = self._clock, now
        part._end = max(now, min(self._end, now + seconds))
        return part


def _resumed(kind: type[Budget], seconds: float | None, elapsed: float, clock: Clock) -> Budget:
    """A budget of which some seconds have gone by."""
    budget = kind.__new__(kind)
    budget._clock, budget._began = clock, clock() - elapsed
    budget._end = math.inf if seconds is None else budget._began + seconds
    return budget
