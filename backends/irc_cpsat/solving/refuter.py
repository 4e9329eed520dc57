"""Conflicts: CP-SAT as the solver behind `irc explain`.

The statements of a task are assumptions over the model of a problem that states nothing. Times
are posted as differences of time points, each enforced by its statement; the interval of an open
demand is present only under the statement of its use and those of the capacities it takes from.
Everything else is the encoding of `irc_cpsat.encoding`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ortools.sat.python import cp_model

from irc.problem import OpenDemand, Problem
from irc.problem.decisions import AnswerError
from irc.problem.statements import ORIGIN, Statement
from irc.schedule import Status
from irc.targets import Budget, EngineFailed
from irc.targets.refuter import Assumptions
from irc_cpsat.encoding.builder import Builder
from irc_cpsat.encoding.encode import write_model
from irc_cpsat.solving.asking import asked, solver_for
from irc_cpsat.solving.solution import schedule_from

_DECISION_WORK = 20.0
"""The limit of a decision in CP-SAT's own deterministic measure of work (about a second each),
which does not depend on the machine: the same task gets the same answer."""

_LEAST_SECONDS = 0.05
"""A solver that is asked at all is given at least this."""

_CORE_WORK = 0.5
"""The limit for a core. Without one the search for a conflict starts from all statements, which
takes little longer; a core that is hard to find would be large, too."""


class CpSatRefuter:
    """One worker, a fixed seed, and no objective."""

    def core(self, assumptions: Assumptions, budget: Budget) -> frozenset[Statement] | None:
        """The statements that CP-SAT calls sufficient for infeasibility.

        To be checked: google/or-tools#5141.
        """
        builder = _AssumptionBuilder(assumptions)
        model = builder.assumed()
        solver = _solver(assumptions.problem, _CORE_WORK)
        if asked(solver, model, budget.at_least(_LEAST_SECONDS)) != cp_model.INFEASIBLE:
            return None
        found = solver.sufficient_assumptions_for_infeasibility()
        by_index = {literal.index: statement for statement, literal in builder.literals.items()}
        return frozenset(by_index[index] for index in found)

    def decide(self, problem: Problem, horizon: int, budget: Budget) -> Status:
        """Solves for any schedule, and re-times the one that is found."""
        builder = Builder(problem, bounds=False, hints=False, horizon=horizon)
        built = write_model(builder, objective=False)
        solver = _solver(problem, _DECISION_WORK)
        status = asked(solver, built.model, budget.at_least(_LEAST_SECONDS))
        if status == cp_model.INFEASIBLE:
            return Status.INFEASIBLE
        if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            try:
                schedule_from(problem, built, solver)
            except AnswerError as error:
                raise EngineFailed(f"CP-SAT's answer is no schedule: {error}") from None
            return Status.FEASIBLE
        return Status.UNKNOWN


def _solver(problem: Problem, work: float) -> cp_model.CpSolver:
    solver = solver_for(problem, seed=0)
    solver.parameters.num_workers = 1
    solver.parameters.max_deterministic_time = work
    return solver


class _AssumptionBuilder(Builder):
    """A builder whose times, uses and capacities hold under assumptions."""

    def __init__(self, assumptions: Assumptions) -> None:
        super().__init__(
            assumptions.problem, bounds=False, hints=False, horizon=assumptions.horizon
        )
        self.assumptions = assumptions
        self.literals: dict[Statement, cp_model.IntVar] = {}

    def assumed(self) -> cp_model.CpModel:
        """The model in which every statement is an assumption."""
        write_model(self, objective=False)
        for src, dst, weight, statement in self.assumptions.differences:
            # A difference beyond the horizon never binds, and may be beyond 64 bits.
            if weight > -self.horizon and statement is not None:
                apart = self.model.add(self._time(dst) - self._time(src) >= weight)
                apart.only_enforce_if(self._literal(statement))
        self.model.add_assumptions(list(self.literals.values()))
        return self.model

    def _literal(self, statement: Statement) -> cp_model.IntVar:
        if statement not in self.literals:
            self.literals[statement] = self.model.new_bool_var(str(statement))
        return self.literals[statement]

    def _time(self, point: int) -> Any:
        if point == ORIGIN:
            return 0
        activity, is_end = divmod(point - 1, 2)
        return self.end(activity) if is_end else self.starts[activity]

    def taking(
        self, i: int, demand: OpenDemand, r: int, *literals: cp_model.IntVar | None
    ) -> cp_model.IntVar | None:
        """As without statements, and only if the use and the capacities are stated."""
        capacities: Mapping[int, Statement] = self.assumptions.capacities
        stated = [
            self.assumptions.uses[i, demand.use],
            *(capacities[member] for member in self.problem.contention.pools[r].members),
        ]
        return super().taking(i, demand, r, *literals, *map(self._literal, stated))
