"""Lexicographic optimisation: the objectives in order, each among the best of those before."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from ortools.sat.python import cp_model

from irc.problem.decisions import Decision
from irc.schedule import Status
from irc.targets import Budget
from irc_cpsat.encoding.builder import Model
from irc_cpsat.encoding.objectives import set_objective
from irc_cpsat.solving.hinting import hint_all
from irc_cpsat.solving.solution import Answer, all_values, decisions_of

TIE_BREAK_SECONDS = 0.5
"""The least time that is spent on moving less among answers that are equally good."""

TIE_BREAK_SHARE = 0.05
"""The part of the time limit that is spent on it at least."""

_TOLERANCE = 1e-6
"""Bounds are whole numbers; this only undoes their way through a double."""


@dataclass(frozen=True, slots=True)
class LevelResult:
    """The value reached for one objective, and a proven bound on it."""

    name: str
    value: int
    bound: int
    proven: bool


Solve = Callable[[Model, str, Sequence[LevelResult], Budget], tuple[Any, Answer]]
"""(model, objective, the levels before it, budget) → status, what was reached."""


@dataclass
class LexicographicResult:
    """The best decisions found, and the levels that were reached."""

    status: Status
    decisions: list[Decision] = field(default_factory=list)
    levels: list[LevelResult] = field(default_factory=list)


def solve_levels(built: Model, solve: Solve, budget: Budget) -> LexicographicResult:
    """One level after another within one budget; the best so far is kept.

    Raises `ValueError` where CP-SAT rejects the model.
    """
    result = LexicographicResult(Status.UNKNOWN)
    names, objectives = built.problem.levels, built.problem.objectives
    for k, name in enumerate(names):
        if k:
            _aim(built, name)
        if k and budget.is_over:
            break
        part = budget if k < len(objectives) else budget.at_most(_tie_break_seconds(budget))
        status, solver = solve(built, name, result.levels, part)
        if status == cp_model.MODEL_INVALID:
            raise ValueError(built.model.validate())
        if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            if not k and status == cp_model.INFEASIBLE:
                result.status = Status.INFEASIBLE
            break
        level = _level(name, built.values[name], status, solver)
        result.levels.append(level)
        result.decisions = decisions_of(built, solver)
        result.status = Status.FEASIBLE
        if not level.proven:
            break
        if k + 1 < len(names):
            _keep(built, level, _given_up(built, level, names[k + 1]), solver)
    if _is_optimal(built, result):
        result.status = Status.OPTIMAL
    return result


def _is_optimal(built: Model, result: LexicographicResult) -> bool:
    own = len(built.problem.objectives)
    proven = [level.proven for level in result.levels[:own]]
    return len(proven) == own and all(proven) and not built.problem.previous.stability


def _tie_break_seconds(budget: Budget) -> float:
    """The time for a choice among equals, which must not take much longer than to find them."""
    share = TIE_BREAK_SHARE * budget.limit if budget.is_limited else 0.0
    return max(TIE_BREAK_SECONDS, budget.elapsed, share)


def _aim(built: Model, name: str) -> None:
    model: Any = built.model  # (This method of ortools has no types.)
    model.clear_objective()
    set_objective(built.model, name, built.values[name])


def _given_up(built: Model, level: LevelResult, following: str) -> int:
    """The part of a level's value that may be lost to make fewer changes."""
    share = built.problem.previous.stability if following == "changes" else Fraction(0)
    return int(abs(level.value) * share)


def _keep(built: Model, level: LevelResult, given_up: int, answer: Answer) -> None:
    """Keeps a level's value, less `given_up`; the solution becomes the next hint."""
    value = built.values[level.name]
    if not isinstance(value, int):
        if level.name == "reward":
            built.model.add(value >= level.value - given_up)
        else:
            built.model.add(value <= level.value + given_up)
    solution = all_values(answer)
    if solution:  # Otherwise its hint is in the model already.
        hint_all(built, solution)


def _level(name: str, value: Any, status: Any, solver: Answer) -> LevelResult:
    reached = value if isinstance(value, int) else solver.value(value)
    if status == cp_model.OPTIMAL or isinstance(value, int):
        return LevelResult(name, reached, reached, True)
    return LevelResult(name, reached, bound_of(name, solver.best_objective_bound), False)


def bound_of(name: str, bound: float) -> int:
    """The bound on an objective, as a whole number."""
    if name == "reward":
        return int((bound + _TOLERANCE) // 1)
    return int(-(-(bound - _TOLERANCE) // 1))
