"""ortools' CP-SAT, in this process."""

from __future__ import annotations

import time
from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, ClassVar

from irc.backend import Engine, EngineFailed, Limits, OnProgress, Outcome, Program, Progress
from irc.compiler import schedule_of
from irc.problem import Problem
from irc.retime import Decision, retime
from irc.schedule import Schedule, Status

if TYPE_CHECKING:
    from irc_cpsat.encode import Hint, Model


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
        """Minimises the makespan; `optimal` and `infeasible` are CP-SAT's own proofs."""
        from ortools.sat.python import cp_model

        from irc_cpsat.encode import build_model

        began = time.perf_counter()
        built = build_model(program.problem, bounds=limits.bounds, hints=limits.hints)
        solver = cp_model.CpSolver()
        _set_limits(solver, limits, time.perf_counter() - began)
        if on_progress is None:
            status = solver.solve(built.model)
        else:
            status = solver.solve(built.model, _reporter(self.name, built, on_progress))
        seconds = time.perf_counter() - began
        verdicts = {
            cp_model.OPTIMAL: Status.OPTIMAL,
            cp_model.FEASIBLE: Status.FEASIBLE,
            cp_model.INFEASIBLE: Status.INFEASIBLE,
        }
        if status == cp_model.MODEL_INVALID:
            raise EngineFailed(f"CP-SAT rejects the model: {built.model.validate()}")
        verdict = verdicts.get(status, Status.UNKNOWN)
        if verdict not in (Status.OPTIMAL, Status.FEASIBLE):
            if verdict is Status.UNKNOWN and built.hint is not None:
                # Nothing within the limits, but the hint is a schedule.
                schedule = _listed(program.problem, built.hint)
                return Outcome(Status.FEASIBLE, self.name, schedule, 0, seconds)
            return Outcome(verdict, self.name, seconds=seconds)
        # The bound is an integer of ticks; the tolerance only undoes its way through a double.
        bound = int(-(-(solver.best_objective_bound - 1e-6) // 1))
        return Outcome(
            verdict, self.name, schedule_from(program.problem, built, solver), bound, seconds
        )


def _set_limits(solver: Any, limits: Limits, spent: float) -> None:
    parameters = solver.parameters
    parameters.random_seed = limits.seed
    if limits.seconds is not None:
        parameters.max_time_in_seconds = max(0.01, limits.seconds - spent)
    if limits.memory_mb is not None:
        parameters.max_memory_in_mb = limits.memory_mb
    if limits.workers is not None:
        parameters.num_workers = limits.workers


def _reporter(engine: str, built: Model, on_progress: OnProgress) -> Any:
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
    decisions, choices = hint
    chosen = [
        replace(decision, chosen=_members(problem, i, choices[i]))
        for i, decision in enumerate(decisions)
    ]
    return schedule_of(problem, retime(problem, chosen))


def _members(problem: Problem, i: int, taken: tuple[int, ...]) -> tuple[int | None, ...]:
    """The resource of each use, where the shared resource taken is not a pool."""
    activity = problem.activities[i]
    chosen: list[int | None] = [None] * len(activity.uses)
    for claim, r in zip(activity.claims, taken, strict=True):
        members = problem.shared[r].members
        chosen[claim.use] = members[0] if len(members) == 1 else None
    return tuple(chosen)


def schedule_from(problem: Problem, built: Model, solver: Any) -> Schedule:
    """The exact schedule behind the values a solver gave to a model's variables."""
    decisions = []
    for i, activity in enumerate(problem.activities):
        start = solver.value(built.starts[i])
        end_var = built.ends[i]
        end = start + activity.duration_min if end_var is None else solver.value(end_var)
        taken = tuple(
            next((r for r, literal in literals if solver.value(literal)), claim.alternatives[0])
            for claim, literals in zip(activity.claims, built.literals[i], strict=True)
        )
        decisions.append(Decision(start, end, _members(problem, i, taken)))
    return schedule_of(problem, retime(problem, decisions))
