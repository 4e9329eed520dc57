"""Results of passes: contended pools, choices fixed without loss, lower bounds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from irc.problem.resources import Window, capacity_levels


@dataclass(frozen=True, slots=True)
class ContendedPool:
    """A contended pool, as encoders see it: one resource, or several interchangeable ones.

    Decoding an answer assigns the `members` (indexes into `Problem.resources`) again. A pool of
    several has no `windows`. For a single resource, `capacity` is its greatest capacity, and `base`
    its capacity outside of its windows.
    """

    id: str
    capacity: int
    members: tuple[int, ...]
    base: int | None = None
    windows: tuple[Window, ...] = ()

    @property
    def least_capacity(self) -> int:
        """The capacity that the pool has at every instant."""
        return min((self._outside, *(w.capacity for w in self.windows)))

    @property
    def never_away(self) -> ContendedPool:
        """The pool with all of its capacity where it has none."""
        return replace(
            self,
            base=self._outside or self.capacity,
            windows=tuple(
                window if window.capacity else window._replace(capacity=self.capacity)
                for window in self.windows
            ),
        )

    def levels(self) -> Iterator[tuple[int, int]]:
        """(From when on, capacity), in order of time; the last level stays."""
        return capacity_levels(self._outside, self.windows)

    @property
    def _outside(self) -> int:
        """The capacity outside of the windows."""
        return self.capacity if self.base is None else self.base


class Bound(NamedTuple):
    """A proven lower bound on the makespan, in ticks, and the reason for it."""

    value: int
    reason: str


NO_BOUND = Bound(0, "no schedule ends before it starts")


@dataclass(frozen=True, slots=True)
class Contention:
    """The open choices of resources, and the choices that passes fixed without loss.

    Open demands of activities refer to the `pools`. `fixed_choices` are (activity, use) → resource.
    """

    pools: tuple[ContendedPool, ...] = ()
    fixed_choices: Mapping[tuple[int, int], int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Bounds:
    """Proven lower bounds, in ticks.

    `heads[i]` is the earliest start of activity i, `tails[i]` the least time between its end and
    the end of the schedule. Both follow from precedence, lags and releases alone. They are empty
    until a pass has found them.
    """

    heads: tuple[int, ...] = ()
    tails: tuple[int, ...] = ()
    makespan: Bound = NO_BOUND


NO_CONTENTION = Contention()
NO_BOUNDS = Bounds()
