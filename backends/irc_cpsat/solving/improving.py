"""A local search in a thread of its own, which takes and gives schedules while it runs."""

from __future__ import annotations

from threading import Event, Thread

from irc.local_search.search import LocalSearch, search_with
from irc.local_search.ways import Found, Ways
from irc.problem import Problem

_PATIENCE_SECONDS = 0.5
"""A step that takes longer (a first one that still compiles) is not waited for at the end."""


class Improving:
    """A local search of a problem. `value` is the makespan of `found`, the best schedule so far.

    Schedules that end after the deadline or the horizon do not count. An exception of the search is
    raised by `check`.
    """

    def __init__(self, ways: Ways, seed: int) -> None:
        self.value: int | None = None
        self.found: Found | None = None
        self._ways, self._seed = ways, seed
        self._given: Found | None = None
        self._error: BaseException | None = None
        self._ended = Event()
        self._thread: Thread | None = None
        self._search: LocalSearch | None = None

    @property
    def problem(self) -> Problem:
        """The problem that is searched."""
        return self._ways.problem

    @property
    def _limits(self) -> list[int]:
        """The times by which a schedule must end to be one."""
        known = self.problem.deadline, self.problem.horizon
        return [limit for limit in known if limit is not None]

    @property
    def has_begun(self) -> bool:
        """Whether the search runs, or has run."""
        return self._thread is not None

    def start(self) -> None:
        """Lets the search run beside the caller until it is ended, or has met the bound."""
        self._thread = Thread(target=self._run, name="irc-local-search", daemon=True)
        self._thread.start()

    def give(self, found: Found, value: int) -> None:
        """Gives a schedule that the search may go on from, where it has no better one."""
        if self.value is None or value < self.value:
            self._given = found

    def end(self) -> None:
        """Ends the search."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join(_PATIENCE_SECONDS)

    def check(self) -> None:
        """Raises what the search has raised."""
        if self._error is not None:
            raise self._error

    def step(self) -> bool:
        """Searches on for a little while, in the caller's thread; False: the bound is met."""
        if self._search is None:
            self._search = search_with(self._ways, self._seed)
        if (given := self._given) is not None:
            self._given = None
            self._search.give(given)
        self._search.step()
        value = self._search.value
        if value is None or any(value > limit for limit in self._limits):
            return True
        if self.value is None or value < self.value:
            self.found = self._search.found()
            self.value = value
        return value > self.problem.bounds.makespan.value

    def _run(self) -> None:
        try:
            while not self._ended.is_set() and self.step():
                pass
        except BaseException as error:  # noqa: BLE001 - `check` raises it where the call waits
            self._error = error
