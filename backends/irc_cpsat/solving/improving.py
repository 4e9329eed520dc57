"""Local searches in threads of their own, which take and give schedules while they run."""

from __future__ import annotations

from threading import Event, Lock, Thread

from irc.local_search.listing import least_value
from irc.local_search.search import LocalSearch, search_of
from irc.local_search.ways import Found, NotApplicable
from irc.problem import Problem
from irc.targets import Budget

_LOOK_SECONDS = 0.02
_PATIENCE_SECONDS = 0.5
"""Steps that take longer (first ones that still compile) are not waited for at the end."""

SMALL = 64
SMALL_SHOP = 100
"""Activities, and operations on machines that do one at a time, up to which CP-SAT often proves a
schedule within seconds, with all workers.
"""

_REST_AFTER_SECONDS = 1.0
"""The time without a better schedule after which a small problem's search rests."""


class Improving:
    """A local search of a problem. `value` is that of `found`, the best schedule so far, for the
    first objective, and `least` a lower bound on it.

    Several searches, with other seeds, can run at once; each gets what another has found. They find
    nothing where the problem has something that they do not know about. Schedules that end after
    the deadline or the horizon do not count. The search of a small problem rests when it finds
    nothing better for a while, until it is given something. An exception of a search is raised by
    `check`.
    """

    def __init__(self, problem: Problem, seed: int, *, steady: bool = False) -> None:
        self.value: int | None = None
        self.found: Found | None = None
        self.problem, self._seed, self._steady = problem, seed, steady
        self._given: dict[int, Found] = {}
        self._error: BaseException | None = None
        self._ended = Event()
        self._given_one = Event()
        self._found_one = Lock()
        self._threads: list[Thread] = []
        self._searches: dict[int, LocalSearch] = {}
        self.least = least_value(problem)

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
    def rests(self) -> bool:
        """Whether the search takes little of the time, so that CP-SAT can keep all workers."""
        is_shop = all(pool.capacity == 1 for pool in self.problem.contention.pools)
        return len(self.problem.activities) <= (SMALL_SHOP if is_shop else SMALL)

    @property
    def has_begun(self) -> bool:
        """Whether the search runs, or has run."""
        return bool(self._threads)

    @property
    def is_met(self) -> bool:
        """Whether no schedule can be better."""
        return self.value is not None and self.value <= self.least

    def start(self, count: int = 1) -> None:
        """Lets the search run beside the caller until it is ended, or has met the bound.

        Where it runs already, others join it until there are `count`.
        """
        for number in range(len(self._threads), count):
            thread = Thread(
                target=self._run, args=(number,), name=f"irc-local-search-{number}", daemon=True
            )
            self._threads.append(thread)
            thread.start()

    def wait(self, budget: Budget) -> None:
        """Waits until the search has met the bound, or the budget is over."""
        while not budget.is_over and (alive := [t for t in self._threads if t.is_alive()]):
            alive[0].join(_LOOK_SECONDS)
        self.check()

    def give(self, found: Found, value: int) -> None:
        """Gives a schedule that the search may go on from, where it has no better one."""
        if self.value is None or value < self.value:
            self._give_all(found)

    def take(self, found: Found, value: int) -> None:
        """Takes a schedule of another process as if it had been found here."""
        with self._found_one:
            if self.value is None or value < self.value:
                self._give_all(found)
                self.found, self.value = found, value

    def end(self) -> None:
        """Ends the search, the first time that it is called."""
        if self._ended.is_set():
            return
        self._ended.set()
        self._given_one.set()
        patience = Budget(_PATIENCE_SECONDS)
        for thread in self._threads:
            thread.join(patience.left)

    def check(self) -> None:
        """Raises what the search has raised."""
        if self._error is not None:
            raise self._error

    def begin(self, seconds: float | None = None) -> bool:
        """Reads the problem; False where it has something that the search does not know about.

        Also False where the search is not compiled within some seconds.
        """
        return self._begin(0, seconds)

    def step(self) -> bool:
        """Searches on for a little while, in the caller's thread; False: the bound is met."""
        return self._step(0)

    def _begin(self, number: int, seconds: float | None = None) -> bool:
        try:
            seed = self._seed + number
            self._searches[number] = search_of(
                self.problem, seed, steady=self._steady, seconds=seconds
            )
        except NotApplicable:
            return False
        return True

    def _step(self, number: int) -> bool:
        search = self._searches[number]
        if (given := self._given.pop(number, None)) is not None:
            search.give(given)
        search.step()
        value = search.value
        if value is None or any(value > limit for limit in self._limits):
            return True
        with self._found_one:
            if self.value is None or value < self.value:
                self.found = search.found()
                self.value = value
                assert self.found is not None
                self._give_all(self.found, but=number)
        return not self.is_met

    def _give_all(self, found: Found, but: int | None = None) -> None:
        """Gives a schedule to all searches (but one, whose own it is)."""
        for number in {*range(max(1, len(self._threads)))} - {but}:
            self._given[number] = found
        self._given_one.set()

    def _run(self, number: int) -> None:
        try:
            going = self._begin(number)
            value, patience = self.value, Budget(_REST_AFTER_SECONDS)
            while going and not self._ended.is_set():
                going = self._step(number)
                if self.value != value:
                    value, patience = self.value, Budget(_REST_AFTER_SECONDS)
                elif self.rests and patience.is_over:
                    self._given_one.wait()
                    self._given_one.clear()
                    patience = Budget(_REST_AFTER_SECONDS)
        except BaseException as error:  # noqa: BLE001 - `check` raises it where the call waits
            self._error = error
