"""CP-SAT and local search in rounds of counted work, so that all can be repeated.

Where no clock decides, the two exchange at fixed points: at the end of a round, when both have done
all of its work. CP-SAT has the first round for itself; each further one has twice its predecessor's
work. In a round neither sees the other, so it does not matter whether they run at the same time.
"""

from __future__ import annotations

from concurrent.futures import Future
from threading import Thread
from typing import Any

from ortools.sat.python import cp_model

from irc_cpsat.solving.beside import Beside
from irc_cpsat.solving.solution import Reached

FIRST_ROUND = 0.1
"""The units of work of the first round."""

UNIT_STEPS = 200
"""The steps of local search that go with a unit of CP-SAT's work: both then take about as long."""

_ENDED = (cp_model.OPTIMAL, cp_model.INFEASIBLE, cp_model.MODEL_INVALID)


class Rounds(Beside):
    """Solves a model for its first objective by both, within a budget of work."""

    def run(self) -> tuple[Any, Reached]:
        """The status, and the best schedule with the best bound."""
        units, steps = FIRST_ROUND, 0
        knows = True
        while True:
            status = self._worked(units, steps)
            if status in _ENDED:
                return self._proven(status)
            if self._is_met or self.budget.is_over:
                return self._reached()
            knows = knows and (steps > 0 or self.improving.begin())
            self._begin_from_best()
            # (Where local search knows nothing of the problem, CP-SAT has nothing to wait for.)
            units = 2 * units if knows else self.budget.left
            steps = max(1, round(UNIT_STEPS * min(units, self.budget.left))) if knows else 0

    def _worked(self, units: float, steps: int) -> Any:
        """The status of CP-SAT after a round."""
        reporter = self._reporter()
        part = self.budget.at_most(units)
        if not steps:
            status = self._ask(1, part, reporter, lambda: False)
        elif self.workers == 1:
            self._step(steps)
            status = self._ask(1, part, reporter, lambda: False)
        else:
            searched: Future[None] = Future()
            arguments = (steps, searched)
            Thread(target=self._searched, args=arguments, name="irc-local", daemon=True).start()
            try:
                status = self._ask(1, part, reporter, lambda: False)
            finally:
                searched.result()
        self._take(reporter)
        if self.improving.value is not None:
            self._tell(reporter, self.improving.value)
        return status

    def _searched(self, steps: int, searched: Future[None]) -> None:
        try:
            self._step(steps)
            searched.set_result(None)
        except BaseException as error:  # noqa: BLE001 - it is raised where the round is waited for
            searched.set_exception(error)

    def _step(self, steps: int) -> None:
        """Local search for a number of steps, or until the bound is met or the clock ends all."""
        for _ in range(steps):
            if self.budget.is_cancelled or not self.improving.step():
                return
