"""Iterative deepening: models with more and more occurrences of the actions that repeat."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from typing import Any

from ortools.sat.python import cp_model

from irc.diagnostics import Code, Diagnostic
from irc.passes.unroll import unroll
from irc.problem import Problem
from irc.schedule import Status
from irc.targets import EngineFailed, Limits, OnProgress, Outcome, Progress
from irc_cpsat.encoding.builder import Builder, Model
from irc_cpsat.encoding.encode import write_model
from irc_cpsat.solving.depth import SLOTS_LIMIT, depths, enough, fits_a_model, within
from irc_cpsat.solving.levels import LexicographicResult, solve_levels
from irc_cpsat.solving.outcome import better, outcome_of

_DEPTH_SHARE = 0.4
"""The part of the time left that a depth may take before a greater one is tried."""

_STATE_WORKERS = 8
"""With state, which of CP-SAT's searches succeeds differs from task to task: with fewer workers
than this it leaves the better ones out, whatever the number of processors."""


class DeepeningSearch:
    """Solves one problem within one time limit, which begins when the search is made."""

    def __init__(
        self, engine: str, problem: Problem, limits: Limits, on_progress: OnProgress | None
    ) -> None:
        self.engine, self.problem = engine, problem
        self.limits, self.on_progress = limits, on_progress
        self._began = time.perf_counter()

    def run(self) -> Outcome:
        """The outcome at the first depth with a schedule, or at one that leaves nothing out."""
        best: Outcome | None = None
        depth = 0
        tried = list(depths(self.problem))
        for depth in tried:
            # To refute a depth can take for ever where the next one has an answer at once.
            best = self.solve_at(self.problem, depth, 1.0 if depth == tried[-1] else _DEPTH_SHARE)
            if best.schedule is not None or self._is_spent():
                break
        if best is None:
            notes = (_too_many_occurrences(),)
            return Outcome(Status.UNKNOWN, self.engine, seconds=self._seconds(), notes=notes)
        return self._completed(best, depth)

    def solve_at(self, problem: Problem, depth: int, share: float) -> Outcome:
        """The outcome at one depth, within a share of the time that is left."""
        unrolled = unroll(problem, depth)
        left = self._seconds_left()
        built = write_model(Builder(unrolled, self.limits.bounds, self.limits.hints))
        try:
            result = solve_levels(built, self._solve, None if left is None else share * left)
        except ValueError as error:
            raise EngineFailed(f"CP-SAT rejects the model: {error}") from None
        return self.outcome_of(unrolled, built, result)

    def outcome_of(self, problem: Problem, built: Model, result: LexicographicResult) -> Outcome:
        """The outcome of one depth's result, at this moment."""
        outcome = outcome_of(self.engine, problem, built, result)
        return replace(outcome, seconds=self._seconds())

    def _completed(self, best: Outcome, depth: int) -> Outcome:
        """The answer at a depth that leaves nothing out, or a note that this one may."""
        problem = self.problem
        if best.schedule is not None and problem.objectives[0] == "makespan":
            problem = within(problem, problem.whole_ticks(best.schedule.makespan))
        needed = enough(problem, problem.deadline)
        complete = needed is not None and needed <= depth
        proven = best.status in (Status.OPTIMAL, Status.INFEASIBLE)
        if complete and (proven or self._is_spent()):
            return best
        if needed is not None and fits_a_model(problem, needed) and not self._is_spent():
            deeper = self.solve_at(problem, max(needed, depth), 1.0)
            if deeper.schedule is not None:
                return better(best, deeper)
            if deeper.status is Status.INFEASIBLE and best.schedule is None:
                return deeper
        return best if complete else _unproven(best, depth)

    def _seconds(self) -> float:
        return time.perf_counter() - self._began

    def _seconds_left(self) -> float | None:
        return None if self.limits.seconds is None else self.limits.seconds - self._seconds()

    def _is_spent(self) -> bool:
        left = self._seconds_left()
        return left is not None and left <= 0

    def _solve(
        self, model: cp_model.CpModel, objective: str, seconds: float | None
    ) -> tuple[Any, cp_model.CpSolver]:
        solver = cp_model.CpSolver()
        parameters = solver.parameters
        parameters.random_seed = self.limits.seed
        if seconds is not None:
            parameters.max_time_in_seconds = max(0.01, seconds)
        if self.limits.memory_mb is not None:
            parameters.max_memory_in_mb = self.limits.memory_mb
        if self.limits.workers is not None:
            parameters.num_workers = self.limits.workers
        elif self.problem.variables:
            parameters.num_workers = max(_STATE_WORKERS, os.cpu_count() or 1)
        if self.on_progress is None or objective != "makespan":
            return solver.solve(model), solver
        return solver.solve(model, _ProgressReporter(self.engine, self.on_progress)), solver


class _ProgressReporter(cp_model.CpSolverSolutionCallback):
    """Passes each new solution's makespan and bound on."""

    def __init__(self, engine: str, on_progress: OnProgress) -> None:
        super().__init__()
        self._engine, self._on_progress = engine, on_progress

    def on_solution_callback(self) -> None:
        """Called by CP-SAT for each solution."""
        makespan, bound = int(self.objective_value), int(self.best_objective_bound)
        self._on_progress(Progress(self.wall_time, makespan, bound, self._engine))


def _unproven(best: Outcome, depth: int) -> Outcome:
    """The outcome without bounds: the proofs hold for this number of occurrences only."""
    levels = tuple(replace(level, bound=None) for level in best.levels)
    best = replace(best, bound=0, levels=levels)
    if best.status not in (Status.OPTIMAL, Status.INFEASIBLE):
        return best
    note = Diagnostic(
        Code.NO_ANSWER,
        f"at most {depth} occurrences of each repeated action were tried; "
        "more of them might do better",
        hint="a deadline of the task, or a 'max' for 'occurs', would make the answer certain",
    )
    status = Status.FEASIBLE if best.schedule is not None else Status.UNKNOWN
    return replace(best, status=status, notes=(*best.notes, note))


def _too_many_occurrences() -> Diagnostic:
    return Diagnostic(
        Code.NO_ANSWER,
        f"the repeated actions of this task have more than {SLOTS_LIMIT} occurrences, "
        "the most that a model is given",
        hint="a longer action that stands for several of them would do",
    )
