"""An exchange among several searches for one problem while they run."""

from __future__ import annotations

from dataclasses import dataclass
from threading import Lock
from typing import Any


@dataclass(frozen=True, slots=True)
class Part:
    """The part of one search among several: its number, from 0, and how many there are."""

    number: int = 0
    count: int = 1


class Exchange:
    """The best value of the first objective, its list schedule and the best bound, of all searches.

    Values are whole numbers, times in ticks. A list schedule is one of `irc.local_search`, of the
    problem that all of the searches have. An engine offers what it finds and takes what is better
    than its own; code that carries it to other processes does the same. All of it may be called by
    any thread.
    """

    def __init__(self, part: Part | None = None) -> None:
        self.part = part or Part()
        self._lock = Lock()
        self._best: tuple[int, Any] | None = None
        self._bound = 0

    @property
    def best(self) -> tuple[int, Any] | None:
        """(value, list schedule) of the best that is known; None where there is none."""
        return self._best

    @property
    def bound(self) -> int:
        """The best proven bound on the first objective; 0 where none is known."""
        return self._bound

    def offer(self, value: int, found: Any) -> None:
        """Offers a list schedule, which counts where it is the best."""
        with self._lock:
            if self._best is None or value < self._best[0]:
                self._best = value, found

    def prove(self, bound: int) -> None:
        """Tells a proven bound on the first objective."""
        with self._lock:
            self._bound = max(self._bound, bound)
