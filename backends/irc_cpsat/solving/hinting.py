"""Completes the hint of a model, so that CP-SAT has a schedule before it looks for one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ortools.sat.python import cp_model

from irc.targets import Budget
from irc_cpsat.encoding.builder import Model
from irc_cpsat.solving.asking import asked, solver_for

SHARE = 0.05
"""The part of the time that a hint may take to be completed."""


def complete_hint(built: Model, budget: Budget) -> None:
    """Adds to a hint that says when everything happens what follows from it for all variables.

    CP-SAT takes a hint for a solution only where it names every variable. One that turns out to be
    no solution stays as it is.
    """
    proto: Any = built.model.proto
    if built.hint is None or len(proto.solution_hint.vars) == len(proto.variables):
        return
    solver = solver_for(built.problem, 0)
    solver.parameters.fix_variables_to_their_hinted_value = True
    solver.parameters.stop_after_first_solution = True
    solver.parameters.num_workers = 1
    status = asked(solver, built.model, budget.share(SHARE))
    if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        hint_all(built, list(solver.response_proto.solution))


def hint_all(built: Model, solution: Sequence[int]) -> None:
    """Makes a solution, a value for each variable, the hint of the model."""
    model: Any = built.model  # (This method of ortools has no types.)
    model.clear_hints()
    hint = built.model.proto.solution_hint
    hint.vars.extend(range(len(solution)))
    hint.values.extend(solution)
