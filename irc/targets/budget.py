"""The time that a call may take: one clock, read here and nowhere else.

A call makes one `Budget` when it begins and hands it, or parts of it, to all that works for it:
engines, the levels of an objective, repair, explanation. A part never outlives the whole.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from time import perf_counter
from typing import Self


class Cancellation:
    """Ends a call early, with the best answer so far.

    A call is given one (`irc.SolveOptions.cancel`), and `cancel` may be called at any time, by any
    thread or by a signal handler. All that works under the call's budget then has no time left. A
    copy in another process is not reached.
    """

    __slots__ = ("_kept", "_noticed", "_outer", "_wanted")

    def __init__(self, outer: Cancellation | None = None) -> None:
        """Not cancelled yet; `outer`, where there is one, cancels it too."""
        self._wanted = False
        self._noticed = False
        self._kept = False
        self._outer = outer

    def __repr__(self) -> str:
        return f"<Cancellation: {'cancelled' if self.is_cancelled else 'not cancelled'}>"

    def __eq__(self, other: object) -> bool:
        """Whether both are cancelled, or neither is."""
        if not isinstance(other, Cancellation):
            return NotImplemented
        return self.is_cancelled == other.is_cancelled

    def __hash__(self) -> int:
        return hash(Cancellation)

    def __copy__(self) -> Self:
        """Itself: a copy of what was given it is ended with it."""
        return self

    def __deepcopy__(self, _memo: object) -> Self:
        return self

    def cancel(self) -> None:
        """Ends what was given this; nothing takes it back."""
        self._wanted = True

    @property
    def is_cancelled(self) -> bool:
        """Whether it was cancelled."""
        if self._wanted or (self._outer is not None and self._outer.is_cancelled):
            self._noticed = True
        return self._noticed

    def keep(self) -> None:
        """Says that there is an answer already, which must not be lost."""
        self._kept = True
        if self._outer is not None:
            self._outer.keep()

    @property
    def will_answer(self) -> bool:
        """Whether there is an answer, or the call has noticed, so that one is near."""
        return self._noticed or self._kept


MOST_SLOWNESS = 8.0
_ENOUGH_SECONDS = 0.05
"""Less than this was not computed: of a short while nothing is known about the machine."""

Clock = Callable[[], float]
"""Seconds since some moment; only differences count."""


class Budget:
    """Seconds of wall-clock time that run from when it is made; without a number, no limit.

    `spent` are seconds that have gone by before. After `cancel` no time is left, of no part either.

    >>> budget = Budget(10)
    >>> budget.share(0.5).limit <= 5
    True
    >>> budget.at_most(60).left <= 10
    True
    """

    __slots__ = ("_began", "_cancel", "_clock", "_computed", "_end")

    def __init__(
        self,
        seconds: float | None = None,
        *,
        spent: float = 0.0,
        cancel: Cancellation | None = None,
        clock: Clock = perf_counter,
    ) -> None:
        self._clock = clock
        self._cancel = cancel
        self._began = clock() - spent
        self._computed = 0.0 if spent else time.process_time()
        self._end = math.inf if seconds is None else self._began + seconds

    def __repr__(self) -> str:
        return f"Budget({self.limit if self.is_limited else None})"

    def __reduce__(self) -> tuple[Callable[..., Budget], tuple[object, ...]]:
        """Elsewhere it goes on where it was: clocks of two processes have nothing in common."""
        limit = self.limit if self.is_limited else None
        return _resumed, (type(self), limit, self.elapsed, self._clock, self._cancel)

    @property
    def limit(self) -> float:
        """The seconds from its beginning to its end; infinite where there is no limit."""
        return self._end - self._began

    @property
    def slowness(self) -> float:
        """How many seconds pass for a second of computing: more than 1 on a busy machine.

        It is estimated from what this process has computed since the beginning, and at most
        `MOST_SLOWNESS`.
        """
        computed = max(_ENOUGH_SECONDS, time.process_time() - self._computed)
        return min(MOST_SLOWNESS, max(1.0, self.elapsed / computed))

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
        return 0.0 if self.is_cancelled else max(0.0, self._end - self._clock())

    @property
    def is_over(self) -> bool:
        """Whether no time is left."""
        return self.is_cancelled or self._clock() >= self._end

    @property
    def is_cancelled(self) -> bool:
        """Whether it was ended from outside: then nothing more is begun, however short."""
        return self._cancel is not None and self._cancel.is_cancelled

    @property
    def cancel(self) -> Cancellation | None:
        """The cancellation that ends it, for what has a clock of its own."""
        return self._cancel

    @property
    def work(self) -> Work | None:
        """The work that it counts instead of seconds; None: it counts seconds."""
        return self._cancel if isinstance(self._cancel, Work) else None

    def share(self, fraction: float) -> Self:
        """A part of what is left, from now on; of no limit there is no smaller part."""
        now = self._clock()
        left = max(0.0, self._end - now)
        return self._part(now, left * fraction if self.is_limited else math.inf)

    def limited(self, seconds: float | None, cancel: Cancellation | None) -> Self:
        """A budget with this limit and cancellation that began when this one did."""
        other = type(self).__new__(type(self))
        other._clock, other._cancel, other._began = self._clock, cancel, self._began
        other._computed = self._computed
        other._end = math.inf if seconds is None else self._began + seconds
        return other

    def at_least(self, seconds: float) -> Self:
        """`seconds` from now on, or all that is left if that is more: a part that may outlive it.

        Such a part too has no time left after `cancel`.
        """
        now = self._clock()
        part = self._part(now, math.inf)
        part._end = max(part._end, now + seconds)
        return part

    def at_most(self, seconds: float) -> Self:
        """`seconds` from now on, or what is left if that is less."""
        return self._part(self._clock(), seconds)

    def ended_by(self, cancel: Cancellation) -> Self:
        """All that is left, which `cancel` ends too; its outer must be this budget's own."""
        part = self._part(self._clock(), math.inf)
        part._cancel = cancel
        return part

    def _part(self, now: float, seconds: float) -> Self:
        part = type(self).__new__(type(self))
        part._clock, part._cancel, part._began = self._clock, self._cancel, now
        part._computed = time.process_time()
        part._end = max(now, min(self._end, now + seconds))
        return part


class Work(Cancellation):
    """Work that is counted instead of time, so that a search ends at the same point every time.

    A budget of it (`of`) has the work that is `done` as its clock. The wall-clock time of `guard`
    ends it too, or the cancellation of that; `is_cut` says so. One unit is CP-SAT's unit of
    deterministic time, a few seconds of a processor.
    """

    __slots__ = ("_guard", "done")

    def __init__(self, guard: Budget) -> None:
        """No work is done yet."""
        super().__init__(guard.cancel)
        self._guard = guard
        self.done = 0.0

    def of(self, units: float) -> Budget:
        """A budget of some units, from now on."""
        return Budget(units, cancel=self, clock=lambda: self.done)

    def add(self, units: float) -> None:
        """Counts units that have been done."""
        self.done += units

    @property
    def is_cancelled(self) -> bool:
        """Whether the clock or a cancellation has ended it."""
        if self._guard.is_over:
            self._noticed = True
        return self._noticed

    @property
    def is_cut(self) -> bool:
        """Whether it was ended, and the search saw it."""
        return self._noticed


def seconds_since_start(*, waited: bool = False) -> float:
    """The seconds since this process began, with the start of Python itself.

    If it has `waited` for others (for its input), only what it has computed counts.
    """
    if waited:
        return time.process_time()
    try:
        with open("/proc/self/stat", "rb") as file:
            ticks = int(file.read().rpartition(b")")[2].split()[19])
        return max(0.0, time.clock_gettime(time.CLOCK_BOOTTIME) - ticks / os.sysconf("SC_CLK_TCK"))
    except (OSError, ValueError, IndexError, AttributeError):
        return time.process_time()  # Not Linux: while a program starts it does little but compute.


def _resumed(
    kind: type[Budget],
    seconds: float | None,
    elapsed: float,
    clock: Clock,
    cancel: Cancellation | None,
) -> Budget:
    """A budget of which some seconds have gone by."""
    return kind(seconds, spent=elapsed, cancel=cancel, clock=clock)
