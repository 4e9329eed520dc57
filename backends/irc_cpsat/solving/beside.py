"""Runs local search beside CP-SAT on the first objective, each from what the other has found.

CP-SAT begins alone: most tasks it proves at once. Then local search takes one of the workers. On a
large shop it has one from the beginning, and after a while most of them; on a small task it takes
none, but rests when it finds nothing better. While both run, each better schedule of CP-SAT goes to
the local search. At times that double, CP-SAT begins again where local search has a better
schedule: with that as its hint, and with its value as an upper bound. A schedule that meets a
proven bound, of the compiler or of CP-SAT, ends both.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from ortools.sat.python import cp_model

from irc.local_search.ways import knows
from irc.problem import Problem
from irc.targets import Budget, EngineFailed, Exchange
from irc_cpsat.encoding.builder import Builder, Model
from irc_cpsat.encoding.hints import hint_at
from irc_cpsat.solving.hinting import complete_hint
from irc_cpsat.solving.improving import Improving
from irc_cpsat.solving.reporting import Reporter
from irc_cpsat.solving.solution import FoundSolution, Reached, found_of
from irc_cpsat.solving.variations import search_limits

ALONE_SECONDS = 0.5
ALONE_SHARE = 0.1
MOST_ALONE_SECONDS = 1.5
"""CP-SAT is alone for a share of the time limit, within these bounds. On a busy machine it is alone
for longer: to load what local search needs takes longer than to prove many a task.
"""

LEAST_SECONDS = 1.5
"""With less time, it is alone throughout."""

EXCHANGE_SECONDS = 1.5
EXCHANGE_FACTOR = 2.0
"""When CP-SAT first begins again, and by how much later each further time."""

LARGE_SHOP = 300
"""Operations of a shop from which CP-SAT in general neither proves a schedule within seconds nor
finds the better ones (docs/benchmarks.md).
"""

FAIR_SHARE = 0.25
FAIR_SECONDS = 60.0
NEAR = Fraction(1, 100)
"""The part of the time limit, and the most, after which local search takes over a large shop. It
does not where the bound is as near as this to the best schedule.
"""

KEPT = 4
"""CP-SAT keeps one worker of this many then."""

_LOOK_SECONDS = 0.03
"""Between two looks at the local search where CP-SAT has no worker."""

Ask = Callable[[int, Budget, Reporter, Callable[[], bool]], Any]
"""(workers, budget, callback, whether to end now) → status of a search of the model."""


class Beside:
    """Solves a model for its first objective by CP-SAT and local search."""

    def __init__(
        self,
        builder: Builder,
        built: Model,
        improving: Improving,
        workers: int,
        budget: Budget,
        reporter: Callable[[], Reporter],
        ask: Ask,
        exchange: Exchange | None = None,
    ) -> None:
        self.builder, self.built, self.workers, self.budget = builder, built, workers, budget
        self.improving = improving
        self._reporter, self._ask, self._exchanged = reporter, ask, exchange
        self._search_share, self._most_search, self._searches_first = search_limits(
            None if exchange is None else exchange.part
        )
        self._exchange_at = EXCHANGE_SECONDS
        share = min(MOST_ALONE_SECONDS, ALONE_SHARE * budget.limit)
        self._alone = max(ALONE_SECONDS, share)
        self._is_large_shop = workers > 1 and is_large_shop(improving.problem)
        self._fair = min(FAIR_SECONDS, FAIR_SHARE * budget.limit)
        self._has_taken_over = False
        self._aim = built.values[built.problem.objectives[0]]
        self._bound = improving.least
        self._best: FoundSolution | None = None
        self._best_value: int | None = None
        self._told: int | None = None
        self._ended = False
        self._may_search = workers == 1 and self._search_share > 0
        self._is_to_search = False

    def run(self) -> tuple[Any, Reached]:
        """The status, and the best schedule with the best bound."""
        if self._is_large_shop:
            self.improving.start()
        try:
            if self._searches_first and self._begins_to_search():
                self._exchange()
                if self._is_met or self.budget.is_over:
                    return self._reached()
            while True:
                status = self._round()
                if status in (cp_model.OPTIMAL, cp_model.INFEASIBLE, cp_model.MODEL_INVALID):
                    return self._proven(status)
                if not self._ended or self._is_met or self.budget.is_over:
                    return self._reached()
                self._exchange()
        finally:
            self.improving.end()

    @property
    def _is_met(self) -> bool:
        values = [v for v in (self._best_value, self.improving.value) if v is not None]
        return bool(values) and min(values) <= self._bound

    def _round(self) -> Any:
        """One search of CP-SAT, until it ends or something makes it begin again."""
        reporter = self._reporter()
        workers = self._solver_workers
        self._ended = False
        if workers:
            status = self._ask(workers, self.budget, reporter, lambda: self._ends(reporter))
        else:
            status = self._wait(reporter)
        self._take(reporter)
        self._share()
        return status

    @property
    def _solver_workers(self) -> int:
        """The workers of CP-SAT in the next round."""
        if self._has_taken_over:
            return self.workers // KEPT
        shares = self.improving.has_begun and not self.improving.rests
        return max(1, self.workers - 1) if shares else self.workers

    def _wait(self, reporter: Reporter) -> Any:
        """Lets local search run alone until the time is over or a bound is met."""
        while not self.budget.is_over and not self._ends(reporter):
            self.improving.wait(self.budget.at_most(_LOOK_SECONDS))
        return cp_model.UNKNOWN

    def _ends(self, reporter: Reporter) -> bool:
        """Whether this round is to end: CP-SAT, which takes a while to, asks again meanwhile."""
        self._ended = self._ended or self._looks(reporter)
        return self._ended

    def _looks(self, reporter: Reporter) -> bool:
        """Passes on what is new; whether CP-SAT is to end now."""
        self.improving.check()
        self._take(reporter)
        self._share()
        elapsed = self.budget.elapsed
        if not self.improving.has_begun and elapsed >= self._alone * self.budget.slowness:
            if self.workers > 1:
                self.improving.start()
            elif self._begins_to_search():
                return True
        value = self.improving.value
        if value is None:
            return False
        self._tell(reporter, value)
        if value <= self._bound:
            return True
        if self._best_value is not None and value >= self._best_value:
            return False
        if self._is_time_to_take_over(value):
            self._has_taken_over = True
            self.improving.start(self.workers - self._solver_workers)
            return True
        return self._solver_workers > 0 and elapsed >= self._exchange_at

    def _is_time_to_take_over(self, value: int) -> bool:
        """Whether local search, whose schedule is the better one, gets most workers from now on."""
        from irc.local_search import compiled

        return (
            self._is_large_shop
            and compiled.IS_COMPILED
            and not self._has_taken_over
            and self.budget.elapsed >= self._fair
            and value - self._bound > NEAR * value
        )

    def _tell(self, reporter: Reporter, value: int) -> None:
        """Reports a better schedule of the local search."""
        better = self._best_value is None or value < self._best_value
        if better and (self._told is None or value < self._told) and self.improving.found:
            self._told = value
            reporter.tell_found(self.improving.found, value, self._bound)

    def _take(self, reporter: Reporter) -> None:
        """Takes what CP-SAT has found since."""
        if reporter.bound is not None:
            self._bound = max(self._bound, reporter.bound)
        solution = reporter.solution
        if solution is None or solution is self._best:
            return
        value = solution.value(self._aim)
        if self._best_value is None or value < self._best_value:
            self._best, self._best_value = solution, value
            self.improving.give(found_of(self.built, solution), value)

    def _share(self) -> None:
        """Exchanges the best schedule and bound with the searches of other processes."""
        others = self._exchanged
        if others is None:
            return
        others.prove(self._bound)
        self._bound = max(self._bound, others.bound)
        own, value, found = self._best_value, self.improving.value, self.improving.found
        if own is not None and self._best is not None and (value is None or own < value):
            if others.best is None or own < others.best[0]:
                others.offer(own, found_of(self.built, self._best))
        elif value is not None and found is not None:
            others.offer(value, found)
        if others.best is not None:
            self.improving.take(others.best[1], others.best[0])

    def _exchange(self) -> None:
        """Makes CP-SAT begin from the best schedule; with one worker, searches for it now."""
        if self._is_to_search:
            self._is_to_search = False
            self._search_alone()
        while self._exchange_at <= self.budget.elapsed:
            # (Of a small task what CP-SAT has learned may be close to a proof.)
            self._exchange_at *= math.inf if self.improving.rests else EXCHANGE_FACTOR
        self._begin_from_best()

    def _begin_from_best(self) -> None:
        """Makes the model begin from the best schedule, and leaves out what cannot be better."""
        value, found = self.improving.value, self.improving.found
        model, aim = self.built.model, self._aim
        if not isinstance(aim, int):
            model.add(aim >= self._bound)
        if value is None or found is None:
            return
        if self._best_value is None or value < self._best_value:
            if not isinstance(aim, int):
                model.add(aim <= value)
            hint_at(self.builder, self.built, found)
            if not knows(self.built.problem):
                complete_hint(self.built, self.budget)

    def _begins_to_search(self) -> bool:
        """With one worker, whether local search is to take its place now: once, where it can."""
        if self._may_search:
            self._may_search = False
            self._is_to_search = self.improving.begin(self.budget.left)
        return self._is_to_search

    def _search_alone(self) -> None:
        """Local search in this thread, for a part of the time."""
        part = self.budget.share(self._search_share).at_most(self._most_search)
        reporter = self._reporter()
        while not part.is_over and self.improving.step():
            self._share()
            if self.improving.value is not None:
                self._tell(reporter, self.improving.value)
            if self._is_met:
                break

    def _proven(self, status: Any) -> tuple[Any, Reached]:
        if status == cp_model.INFEASIBLE and self.improving.found is not None:
            raise EngineFailed("CP-SAT refutes a schedule that local search has found")
        if status != cp_model.OPTIMAL or self._best_value is None:
            return status, Reached(self._bound)
        return status, Reached(self._best_value, self._best)

    def _reached(self) -> tuple[Any, Reached]:
        """The best schedule of either, proven if it meets the bound."""
        own, value, found = self._best_value, self.improving.value, self.improving.found
        best = own
        if value is not None and found is not None and (own is None or value < own):
            hint_at(self.builder, self.built, found)
            best = value
            answer = Reached(self._bound, None, found[0], value)
        else:
            answer = Reached(self._bound, self._best)
        if best is None:
            return cp_model.UNKNOWN, answer
        return (cp_model.OPTIMAL if best <= self._bound else cp_model.FEASIBLE), answer


def is_large_shop(problem: Problem) -> bool:
    """Whether a problem has LARGE_SHOP or more operations, machines of capacity 1, and no more."""
    return (
        len(problem.activities) >= LARGE_SHOP
        and all(pool.capacity == 1 for pool in problem.contention.pools)
        and knows(problem)
    )
