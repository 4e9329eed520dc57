"""Solving a model for its objectives in order, each among the best of those before it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from ortools.sat.python import cp_model

from irc.problem import Problem
from irc.problem.decisions import ABSENT, Decision
from irc.schedule import Status
from irc_cpsat.builder import Model

TIE_BREAK_SECONDS = 0.5
"""So long, at least, is spent on moving less among answers that are equally good."""

TIE_BREAK_SHARE = 0.05
"""And this part of the time limit."""

_TOLERANCE = 1e-6
"""Bounds are whole numbers; this only undoes their way through a double."""

Solve = Callable[[cp_model.CpModel, str, float | None], tuple[Any, cp_model.CpSolver]]
"""(model, objective, seconds left) → status, solver."""


@dataclass(frozen=True, slots=True)
class Level:
    """How far one objective came: its value, and a proven bound on it."""

    name: str
    value: int
    bound: int
    proven: bool


@dataclass
class Answer:
    """The best decisions found, and the levels that were reached."""

    status: Status
    decisions: list[Decision] = field(default_factory=list)
    levels: list[Level] = field(default_factory=list)


def solve_levels(built: Model, solve: Solve, seconds: float | None) -> Answer:
    """One level after another within one time limit; the best so far is kept."""
    began = time.perf_counter()
    answer = Answer(Status.UNKNOWN)
    names = built.problem.levels
    own = len(built.problem.objectives)
    for k, name in enumerate(names):
        value = built.values[name]
        if k:
            _aim(built, name, value)
        spent = time.perf_counter() - began
        left = None if seconds is None else seconds - spent
        if k and left is not None and left <= 0:
            break
        if k == own:
            # It only chooses among equals, and must not take much longer than to find them.
            patience = max(TIE_BREAK_SECONDS, spent, TIE_BREAK_SHARE * (seconds or 0))
            left = patience if left is None else min(left, patience)
        status, solver = solve(built.model, name, left)
        if status == cp_model.MODEL_INVALID:
            raise ValueError(built.model.validate())
        if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            if not k:
                answer.status = (
                    Status.INFEASIBLE if status == cp_model.INFEASIBLE else Status.UNKNOWN
                )
            break
        level = _level(name, value, status, solver)
        answer.levels.append(level)
        answer.decisions = decisions_of(built, solver)
        answer.status = Status.FEASIBLE
        if not level.proven:
            break
        if k + 1 < len(names):
            slack = built.problem.stability if names[k + 1] == "changes" else Fraction(0)
            _keep(built, name, level.value, slack, solver)
    proven = [level.proven for level in answer.levels[:own]]
    if len(proven) == own and all(proven) and not built.problem.stability:
        answer.status = Status.OPTIMAL
    return answer


def _aim(built: Model, name: str, value: Any) -> None:
    built.model.clear_objective()  # type: ignore[no-untyped-call]
    if name == "reward":
        built.model.maximize(value)
    else:
        built.model.minimize(value)


def _keep(built: Model, name: str, best: int, slack: Fraction, solver: cp_model.CpSolver) -> None:
    """What was reached stays, but for the slack; the next search starts from the solution."""
    value = built.values[name]
    if not isinstance(value, int):
        given_up = int(abs(best) * slack)
        if name == "reward":
            built.model.add(value >= best - given_up)
        else:
            built.model.add(value <= best + given_up)
    solution = list(solver.response_proto.solution)
    built.model.clear_hints()  # type: ignore[no-untyped-call]
    hint = built.model.proto.solution_hint
    hint.vars.extend(range(len(solution)))
    hint.values.extend(solution)


def _level(name: str, value: Any, status: Any, solver: cp_model.CpSolver) -> Level:
    reached = value if isinstance(value, int) else solver.value(value)
    if status == cp_model.OPTIMAL or isinstance(value, int):
        return Level(name, reached, reached, True)
    bound = solver.best_objective_bound
    if name == "reward":
        return Level(name, reached, int((bound + _TOLERANCE) // 1), False)
    return Level(name, reached, int(-(-(bound - _TOLERANCE) // 1)), False)


def decisions_of(built: Model, solver: cp_model.CpSolver) -> list[Decision]:
    """What a solution decides about each activity."""
    return [_decision(built, solver, i) for i in range(len(built.problem.activities))]


def _decision(built: Model, solver: cp_model.CpSolver, i: int) -> Decision:
    problem, activity = built.problem, built.problem.activities[i]
    present = built.present[i]
    if present is not None and not solver.value(present):
        return ABSENT
    start = solver.value(built.starts[i])
    end = built.ends[i]
    mode = next((m for m, chosen in enumerate(built.modes[i]) if solver.value(chosen)), None)
    ranks = built.ranks[i] if built.ranks else None
    taken = tuple(
        next((r for r, literal in literals if solver.value(literal)), claim.alternatives[0])
        for claim, literals in zip(activity.claims, built.literals[i], strict=True)
    )
    return Decision(
        start,
        start + activity.duration_min if end is None else solver.value(end),
        members_taken(problem, i, taken),
        mode=mode,
        rank=0 if ranks is None else solver.value(ranks[0]),
        end_rank=0 if ranks is None else solver.value(ranks[1]),
    )


def members_taken(problem: Problem, i: int, taken: tuple[int, ...]) -> tuple[int | None, ...]:
    """The resource of each use, where the shared resource taken is not a pool."""
    activity = problem.activities[i]
    chosen: list[int | None] = [None] * len(activity.uses)
    for claim, r in zip(activity.claims, taken, strict=True):
        members = problem.shared[r].members
        chosen[claim.use] = members[0] if len(members) == 1 else None
    return tuple(chosen)
