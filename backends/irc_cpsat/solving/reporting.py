"""Tells what CP-SAT finds while it searches: each better answer, and each better bound."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ortools.sat.python import cp_model

from irc.problem.decisions import AnswerError
from irc.problem.objective_values import in_units
from irc.retiming.listed import listed_schedule
from irc.schedule import Schedule
from irc.targets import Budget, ObjectiveLevel, OnProgress, Progress
from irc_cpsat.encoding.builder import Hint, Model
from irc_cpsat.solving.asking import asked
from irc_cpsat.solving.levels import LevelResult, bound_of
from irc_cpsat.solving.solution import FoundSolution, schedule_from


class Reporter(cp_model.CpSolverSolutionCallback):
    """Passes on what the search for one objective finds; `earlier` are the objectives before it.
    Without `proves` the bounds hold for this model only, and are not reported. Without
    `on_progress` nothing is reported; `solution` and `bound` have the last ones in any case.

    An exception of the receiver ends the search and is kept, because CP-SAT calls from threads of
    its own.
    """

    def __init__(
        self,
        engine: str,
        built: Model,
        objective: str,
        earlier: Sequence[LevelResult],
        budget: Budget,
        on_progress: OnProgress | None,
    ) -> None:
        super().__init__()
        self.engine, self.built, self.objective = engine, built, objective
        self.earlier = {level.name: level for level in earlier}
        self.budget, self.on_progress = budget, on_progress
        self.proves = True
        self.error: BaseException | None = None
        self.solution: FoundSolution | None = None
        self.bound: int | None = None
        self._solver: cp_model.CpSolver | None = None

    def asked(
        self,
        solver: cp_model.CpSolver,
        budget: Budget,
        ended: Callable[[], bool] = lambda: False,
    ) -> Any:
        """The status of a search that tells what it finds. Raises what the receiver raised."""
        solver.best_bound_callback = self.on_bound
        self._solver = solver
        status = asked(solver, self.built.model, budget, self, ended)
        if self.error is not None:
            raise self.error
        return status

    def on_solution_callback(self) -> None:
        """Called by CP-SAT for each solution."""
        self.solution = FoundSolution(self.response_proto)
        self.bound = bound_of(self.objective, self.best_objective_bound)
        self._tell()

    def on_bound(self, bound: float) -> None:
        """Called by CP-SAT for each better bound."""
        self.bound = bound_of(self.objective, bound)
        self._tell()

    def _tell(self) -> None:
        solution = self.solution
        if solution is None or self.error is not None or self.on_progress is None:
            return
        built, problem = self.built, self.built.problem

        def found() -> Schedule:
            return schedule_from(problem, built, solution)

        # (The variables of later objectives need not be as small as the schedule would allow.)
        optimised = problem.levels[: problem.levels.index(self.objective) + 1]
        levels = tuple(
            ObjectiveLevel(
                name,
                in_units(problem, name, solution.value(built.values[name])),
                None if (bound := self._bound_on(name)) is None else in_units(problem, name, bound),
            )
            for name in optimised
        )
        seconds = self.budget.elapsed
        try:
            self.on_progress(Progress(seconds, self.engine, self.objective, levels, found))
        except BaseException as error:  # noqa: BLE001 - it is raised where the call waits
            self.error = error
            if self._solver is not None:
                self._solver.stop_search()

    def tell_found(self, found: Hint, value: int, bound: int) -> None:
        """Tells a list schedule that was found elsewhere, and what is proven."""
        problem = self.built.problem
        if self.on_progress is None:
            return
        name = self.objective
        in_unit = in_units(problem, name, bound) if self.proves else None
        level = ObjectiveLevel(name, in_units(problem, name, value), in_unit)

        def schedule() -> Schedule:
            return listed_schedule(problem, found)

        seconds = self.budget.elapsed
        self.on_progress(Progress(seconds, self.engine, self.objective, (level,), schedule))

    def _bound_on(self, name: str) -> int | None:
        if not self.proves:
            return None
        if name == self.objective:
            return self.bound
        return self.earlier[name].bound if name in self.earlier else None


def tell_hint(engine: str, built: Model, budget: Budget, on_progress: OnProgress) -> None:
    """Tells the list schedule from which the search begins, where the makespan comes first."""
    problem, hint = built.problem, built.hint
    if hint is None or problem.objectives[0] != "makespan":
        return
    try:
        schedule = listed_schedule(problem, hint)
    except AnswerError:
        return  # It is only a hint: CP-SAT finds a schedule that can be.
    bound = problem.to_units(problem.bounds.makespan.value)
    level = ObjectiveLevel("makespan", schedule.makespan, bound)
    on_progress(Progress(budget.elapsed, engine, "makespan", (level,), lambda: schedule))
