"""A local search in a thread of its own, which takes and gives schedules while it runs."""

from __future__ import annotations

from threading import Event, Thread

from irc.local_search.listing import least_value
from irc.local_search.search import LocalSearch, search_of
from irc.local_search.ways import Found, NotApplicable
from irc.problem import Problem
from irc.targets import Budget

_LOOK_SECONDS = 0.02
_PATIENCE_SECONDS = 0.5
"""A step that takes longer (a first one that still compiles) is not waited for at the end."""


class Improving:
    """A local search of a problem. `value` is that of `found`, the best schedule so far, for the
    first objective.

    It finds none where the problem has something that it does not know about. Schedules that end
    after the deadline or the horizon do not count. An exception of the search is
    raised by `check`.
    """

    def __init__(self, problem: Problem, seed: int, *, steady: bool = False) -> None:
        self.value: int | None = None
        self.found: Found | None = None
        self.problem, self._seed, self._steady = problem, seed, steady
        self._given: Found | None = None
        self._error: BaseException | None = None
        self._ended = Event()
        self._thread: Thread | None = None
        self._search: LocalSearch | None = None
        self._least = least_value(problem)

    @property
    def _limits(self) -> list[int]:
        """The times by which a schedule must end to be one.

        A search for other objectives than the makespan sees to them itself.
        """
        if self.problem.objectives[0] != "makespan":
            return []
        known = self.problem.deadline, self.problem.horizon
        return [limit for limit in known if limit is not None]

    @property
    def has_begun(self) -> bool:
        """Whether the search runs, or has run."""
        return self._thread is not None

    @property
    def is_met(self) -> bool:
        """Whether no schedule can be better."""
        return self.value is not None and self.value <= self._least

    def start(self) -> None:
        """Lets the search run beside the caller until it is ended, or has met the bound."""
        self._thread = Thread(target=self._run, name="irc-local-search", daemon=True)
        self._thread.start()

    def wait(self, budget: Budget) -> None:
        """Waits until the search has met the bound, or the budget is over."""
        assert self._thread is not None
        while self._thread.is_alive() and not budget.is_over:
            self._thread.join(_LOOK_SECONDS)
        self.check()

    def give(self, found: Found, value: int) -> None:
        """Gives a schedule that the search may go on from, where it has no better one."""
        if self.value is None or value < self.value:
            self._given = found

    def take(self, found: Found, value: int) -> None:
        """Takes a schedule of another process as if it had been found here."""
        if self.value is None or value < self.value:
            self._given = found
            self.found, self.value = found, value

    def end(self) -> None:
        """Ends the search."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join(_PATIENCE_SECONDS)

    def check(self) -> None:
        """Raises what the search has raised."""
        if self._error is not None:
            raise self._error

    def begin(self) -> bool:
        """Reads the problem; False where it has something that the search does not know about."""
        try:
            self._search = search_of(self.problem, self._seed, steady=self._steady)
        except NotApplicable:
            return False
        return True

    def step(self) -> bool:
        """Searches on for a little while, in the caller's thread; False: the bound is met."""
        assert self._search is not None
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
        return value > self._least

    def _run(self) -> None:
        try:
            going = self.begin()
            while going and not self._ended.is_set():
                going = self.step()
        except BaseException as error:  # noqa: BLE001 - `check` raises it where the call waits
            self._error = error
