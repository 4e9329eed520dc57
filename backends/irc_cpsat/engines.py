"""ortools' CP-SAT, in this process."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, ClassVar

from irc.diagnostics import Code, Diagnostic
from irc.model.quantities import Number
from irc.passes.unroll import unroll
from irc.problem import Problem
from irc.problem.objective_values import in_units, worth
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule, Status
from irc.targets import (
    Engine,
    EngineFailed,
    Limits,
    ObjectiveLevel,
    OnProgress,
    Outcome,
    Program,
    Progress,
)
from irc_cpsat.depth import SLOTS_LIMIT, depths, enough, fits_a_model, within

if TYPE_CHECKING:
    from irc_cpsat.builder import Hint, Model
    from irc_cpsat.levels import Answer

_SHARE = 0.4
"""The part of the time left that a number of occurrences may take before a greater one is tried."""

_STATE_WORKERS = 8
"""With state, which of CP-SAT's searches succeeds differs from task to task: with fewer workers
than this it leaves the better ones out, whatever the number of processors."""


class OrTools(Engine):
    """CP-SAT through ortools' Python package."""

    name: ClassVar[str] = "ortools"

    def missing(self) -> str | None:
        """Why ortools cannot be imported, if it cannot."""
        if find_spec("ortools") is None:
            return "the engine 'ortools' is not installed: pip install ortools"
        return None

    def solve(
        self, program: Program, limits: Limits, on_progress: OnProgress | None = None
    ) -> Outcome:
        """The objectives in their order; `optimal` and `infeasible` are CP-SAT's own proofs.

        Where actions repeat, the model is deepened until there is a schedule, and then to the
        depth that leaves nothing out, if there is one.
        """
        return _Run(self.name, program.problem, limits, on_progress).run()


class _Run:
    def __init__(
        self, engine: str, problem: Problem, limits: Limits, on_progress: OnProgress | None
    ) -> None:
        self.engine, self.problem = engine, problem
        self.limits, self.on_progress = limits, on_progress
        self.began = time.perf_counter()

    def run(self) -> Outcome:
        best: Outcome | None = None
        depth = 0
        tried = list(depths(self.problem))
        for depth in tried:
            # To refute a depth can take for ever where the next one has an answer at once.
            best = self._at(self.problem, depth, 1.0 if depth == tried[-1] else _SHARE)
            if best.schedule is not None or self._spent():
                break
        if best is None:
            return Outcome(
                Status.UNKNOWN, self.engine, seconds=self._seconds(), notes=(_too_many(),)
            )
        return self._completed(best, depth)

    def _completed(self, best: Outcome, depth: int) -> Outcome:
        """The answer at a depth that leaves nothing out, or the word that this one may."""
        problem = self.problem
        if best.schedule is not None and problem.objectives[0] == "makespan":
            problem = within(problem, int(best.schedule.makespan / problem.tick))
        needed = enough(problem, problem.deadline)
        whole = needed is not None and needed <= depth
        if whole and (best.status in (Status.OPTIMAL, Status.INFEASIBLE) or self._spent()):
            return best
        if needed is not None and fits_a_model(problem, needed) and not self._spent():
            deeper = self._at(problem, max(needed, depth), 1.0)
            if deeper.schedule is not None:
                return _better(best, deeper)
            if deeper.status is Status.INFEASIBLE and best.schedule is None:
                return deeper
        return best if whole else self._unproven(best, depth)

    def _unproven(self, best: Outcome, depth: int) -> Outcome:
        """Without bounds: what was proven holds for so many occurrences only."""
        levels = tuple(replace(level, bound=None) for level in best.levels)
        best = replace(best, bound=0, levels=levels)
        if best.status not in (Status.OPTIMAL, Status.INFEASIBLE):
            return best
        told = Diagnostic(
            Code.NO_ANSWER,
            f"at most {depth} occurrences of each repeated action were tried; "
            "more of them might do better",
            hint="a deadline of the task, or a 'max' for 'occurs', would make the answer certain",
        )
        status = Status.FEASIBLE if best.schedule is not None else Status.UNKNOWN
        return replace(best, status=status, notes=(*best.notes, told))

    def _seconds(self) -> float:
        return time.perf_counter() - self.began

    def _left(self) -> float | None:
        return None if self.limits.seconds is None else self.limits.seconds - self._seconds()

    def _spent(self) -> bool:
        left = self._left()
        return left is not None and left <= 0

    def _at(self, whole: Problem, depth: int, share: float) -> Outcome:
        """The answer with so many occurrences, within a share of the time that is left."""
        from irc_cpsat.builder import Builder
        from irc_cpsat.levels import solve_levels

        problem = unroll(whole, depth)
        left = self._left()
        built = Builder(problem, self.limits.bounds, self.limits.hints).build()
        try:
            answer = solve_levels(built, self._solve, None if left is None else share * left)
        except ValueError as error:
            raise EngineFailed(f"CP-SAT rejects the model: {error}") from None
        return self._outcome(problem, built, answer)

    def _solve(self, model: Any, objective: str, seconds: float | None) -> tuple[Any, Any]:
        from ortools.sat.python import cp_model

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
        return solver.solve(model, _reporter(self.engine, self.on_progress)), solver

    def _outcome(self, problem: Problem, built: Model, answer: Answer) -> Outcome:
        if answer.status in (Status.INFEASIBLE, Status.UNKNOWN):
            if answer.status is Status.UNKNOWN and built.hint is not None:
                # Nothing within the limits, but the hint is a schedule.
                schedule = _listed(problem, built.hint)
                return Outcome(Status.FEASIBLE, self.engine, schedule, 0, self._seconds())
            if answer.status is Status.UNKNOWN and problem.start_from:
                schedule = schedule_of(problem, problem.start_from)
                return Outcome(Status.FEASIBLE, self.engine, schedule, 0, self._seconds())
            return Outcome(answer.status, self.engine, seconds=self._seconds())
        placed = retime(problem, answer.decisions)
        schedule = schedule_of(problem, placed)
        first = answer.levels[0]
        return Outcome(
            answer.status,
            self.engine,
            schedule,
            first.bound if first.name == "makespan" else 0,
            self._seconds(),
            levels=_levels(problem, answer, schedule),
        )


def _too_many() -> Diagnostic:
    return Diagnostic(
        Code.NO_ANSWER,
        f"the repeated actions of this task have more than {SLOTS_LIMIT} occurrences, "
        "the most that a model is given",
        hint="a longer action that stands for several of them would do",
    )


def _better(shallow: Outcome, deep: Outcome) -> Outcome:
    """The better of two answers, with the bounds of the one that leaves nothing out.

    Out of time, a deep model can have come less far than a shallow one before it.
    """
    if shallow.schedule is None or deep.schedule is None or _vector(deep) <= _vector(shallow):
        return deep
    bounds = deep.levels[0].bound, *(None for _ in deep.levels[1:])
    levels = tuple(
        replace(level, bound=bound) for level, bound in zip(shallow.levels, bounds, strict=True)
    )
    return replace(shallow, status=Status.FEASIBLE, bound=deep.bound, levels=levels)


def _vector(outcome: Outcome) -> tuple[Number, ...]:
    """The objectives in their order; less is better."""
    return tuple(-o.value if o.name == "reward" else o.value for o in outcome.levels)


def _levels(problem: Problem, answer: Answer, schedule: Schedule) -> tuple[ObjectiveLevel, ...]:
    """Each objective with the bound among the best of those before it; none behind a gap."""
    values = worth(problem, schedule)
    reached = {level.name: level for level in answer.levels}
    found = []
    certain = True
    for name in problem.levels:
        level = reached.get(name) if certain else None
        bound = None if level is None else in_units(problem, name, level.bound)
        found.append(ObjectiveLevel(name, values[name], bound))
        certain = level is not None and level.proven
    return tuple(found)


def _reporter(engine: str, on_progress: OnProgress) -> Any:
    from ortools.sat.python import cp_model

    class Reporter(cp_model.CpSolverSolutionCallback):
        def on_solution_callback(self) -> None:
            on_progress(
                Progress(
                    self.wall_time,
                    int(self.objective_value),
                    int(self.best_objective_bound),
                    engine,
                )
            )

    return Reporter()


def _listed(problem: Problem, hint: Hint) -> Schedule:
    """The list schedule that the model was given as a hint."""
    from irc_cpsat.levels import members_taken

    decisions, choices = hint
    chosen = [
        replace(decision, chosen=members_taken(problem, i, choices[i]))
        for i, decision in enumerate(decisions)
    ]
    return schedule_of(problem, retime(problem, chosen))


def schedule_from(problem: Problem, built: Model, solver: Any) -> Schedule:
    """The exact schedule behind the values a solver gave to a model's variables."""
    from irc_cpsat.levels import decisions_of

    return schedule_of(problem, retime(problem, decisions_of(built, solver)))
