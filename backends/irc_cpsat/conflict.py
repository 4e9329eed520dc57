"""Why not: CP-SAT as the solver behind `irc explain`.

The statements of a task are assumptions over the model of a problem that states nothing. Times
are posted as differences of time points, each enforced by its statement; a claim's interval is
present only under the statement of its use and those of the capacities it takes from. Everything
else is the encoding of `irc_cpsat.encode`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ortools.sat.python import cp_model

from irc.problem import Claim, Problem
from irc.problem.decisions import AnswerError
from irc.problem.statements import ORIGIN, Statement
from irc.schedule import Status
from irc.targets import EngineFailed
from irc.targets.refuter import Assumptions
from irc_cpsat.encode import Builder
from irc_cpsat.engines import schedule_from

_STEPS = 20.0
"""The limit of a decision in CP-SAT's own deterministic measure of work (about a second each),
which does not depend on the machine: the same task gets the same answer."""

_CORE_STEPS = 0.5
"""The limit for a core. Without one the search for a conflict starts from all statements, which
takes little longer; where a core is hard to find it would be large, too."""


class CpSatRefuter:
    """One worker, a fixed seed, and no objective."""

    def core(self, assumptions: Assumptions, seconds: float) -> frozenset[Statement] | None:
        """What CP-SAT says is enough for infeasibility; to be checked (google/or-tools#5141)."""
        builder = _AssumptionBuilder(assumptions)
        model = builder.assumed()
        solver = _solver(seconds, _CORE_STEPS)
        if solver.solve(model) != cp_model.INFEASIBLE:
            return None
        found = solver.sufficient_assumptions_for_infeasibility()
        by_index = {literal.index: statement for statement, literal in builder.literals.items()}
        return frozenset(by_index[index] for index in found)

    def decide(self, problem: Problem, horizon: int, seconds: float) -> Status:
        """Solves for any schedule, and re-times the one that is found."""
        built = Builder(problem, bounds=False, hints=False, horizon=horizon).build(objective=False)
        solver = _solver(seconds, _STEPS)
        status = solver.solve(built.model)
        if status == cp_model.INFEASIBLE:
            return Status.INFEASIBLE
        if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            try:
                schedule_from(problem, built, solver)
            except AnswerError as error:
                raise EngineFailed(f"CP-SAT's answer is no schedule: {error}") from None
            return Status.FEASIBLE
        return Status.UNKNOWN


def _solver(seconds: float, steps: float) -> cp_model.CpSolver:
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 0
    solver.parameters.max_time_in_seconds = seconds
    solver.parameters.max_deterministic_time = steps
    return solver


class _AssumptionBuilder(Builder):
    def __init__(self, assumptions: Assumptions) -> None:
        super().__init__(
            assumptions.problem, bounds=False, hints=False, horizon=assumptions.horizon
        )
        self.assumptions = assumptions
        self.literals: dict[Statement, cp_model.IntVar] = {}

    def assumed(self) -> cp_model.CpModel:
        self.build(objective=False)
        for src, dst, weight, statement in self.assumptions.differences:
            # What reaches beyond the horizon never binds, and may be beyond 64 bits.
            if weight > -self.horizon and statement is not None:
                apart = self.model.add(self._moment(dst) - self._moment(src) >= weight)
                apart.only_enforce_if(self._literal(statement))
        self.model.add_assumptions(list(self.literals.values()))
        return self.model

    def _literal(self, statement: Statement) -> cp_model.IntVar:
        if statement not in self.literals:
            self.literals[statement] = self.model.new_bool_var(str(statement))
        return self.literals[statement]

    def _moment(self, point: int) -> Any:
        if point == ORIGIN:
            return 0
        activity, is_end = divmod(point - 1, 2)
        return self.end(activity) if is_end else self.starts[activity]

    def _all_of(
        self, i: int, claim: Claim, r: int, *literals: cp_model.IntVar | None
    ) -> cp_model.IntVar | None:
        capacities: Mapping[int, Statement] = self.assumptions.capacities
        stated = [
            self.assumptions.uses[i, claim.use],
            *(capacities[member] for member in self.problem.shared[r].members),
        ]
        return super()._all_of(i, claim, r, *literals, *map(self._literal, stated))
