"""Reads CP-SAT's values as decisions, and re-times them as the exact schedule."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from ortools.sat.python import cp_model, cp_model_helper

from irc.problem import Problem
from irc.problem.choices import members_taken
from irc.problem.decisions import ABSENT, Decision
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule
from irc_cpsat.encoding.builder import Hint, Model


class Values(Protocol):
    """The values of a model's variables: those of a solver, or of a solution that it found."""

    def value(self, expression: Any) -> int:
        """The value of a variable, a literal or a linear expression."""


class FoundSolution:
    """A solution that a solver found on its way, apart from that solver."""

    def __init__(self, response: Any) -> None:
        self._response = response

    def value(self, expression: Any) -> int:
        """The value of a variable, a literal or a linear expression."""
        return int(cp_model_helper.ResponseHelper.value(self._response, expression))

    @property
    def all_values(self) -> list[int]:
        """The values of all variables, in their order."""
        return list(self._response.solution)


class Reached:
    """The best schedule and the best bound that several searches together have reached.

    `solution` is that of a model; without one, a list schedule is known alone, and its value for
    the first objective.
    """

    def __init__(
        self,
        bound: int,
        solution: FoundSolution | None = None,
        decisions: Sequence[Decision] = (),
        reached: int = 0,
    ) -> None:
        self.best_objective_bound = float(bound)
        self.solution, self.decisions, self.reached = solution, [*decisions], reached

    def value(self, expression: Any) -> int:
        """The value of an expression of the solution; without one, of the first objective."""
        return self.reached if self.solution is None else self.solution.value(expression)


Answer = cp_model.CpSolver | Reached
"""The values that a search has reached, and its `best_objective_bound`."""


def all_values(answer: Answer) -> list[int]:
    """The values of all variables, in their order; none where a list schedule is known alone."""
    if isinstance(answer, cp_model.CpSolver):
        return list(answer.response_proto.solution)
    return [] if answer.solution is None else answer.solution.all_values


def found_of(built: Model, solution: Values) -> Hint:
    """A solution as a list schedule: its decisions, and the pool of each open demand."""
    pools = [
        tuple(
            next((r for r, literal in literals if solution.value(literal)), demand.alternatives[0])
            for demand, literals in zip(activity.open_demands, built.literals[i], strict=True)
        )
        for i, activity in enumerate(built.problem.activities)
    ]
    return decisions_of(built, solution), pools


def decisions_of(built: Model, solver: Values) -> list[Decision]:
    """The decision of a solution about each activity."""
    if isinstance(solver, Reached) and solver.solution is None:
        return solver.decisions
    return [_decision(built, solver, i) for i in range(len(built.problem.activities))]


def schedule_from(problem: Problem, built: Model, solver: Values) -> Schedule:
    """The exact schedule behind the values a solver gave to a model's variables."""
    return schedule_of(problem, retime(problem, decisions_of(built, solver)))


def _decision(built: Model, solver: Values, i: int) -> Decision:
    problem, activity = built.problem, built.problem.activities[i]
    present = built.present[i]
    if present is not None and not solver.value(present):
        return ABSENT
    start = solver.value(built.starts[i])
    end = built.ends[i]
    mode = next((m for m, chosen in enumerate(built.modes[i]) if solver.value(chosen)), None)
    ranks = built.ranks[i] if built.ranks else None
    taken = tuple(
        next((r for r, literal in literals if solver.value(literal)), demand.alternatives[0])
        for demand, literals in zip(activity.open_demands, built.literals[i], strict=True)
    )
    return Decision(
        start,
        start + activity.duration_min if end is None else solver.value(end),
        members_taken(problem, activity, taken),
        mode=mode,
        rank=0 if ranks is None else solver.value(ranks[0]),
        end_rank=0 if ranks is None else solver.value(ranks[1]),
    )
