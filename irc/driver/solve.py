"""Solves a task: compile, run an engine, re-time, validate."""

from __future__ import annotations

from irc.diagnostics import Code, Diagnostic
from irc.driver.compile import later_events, lower_for, reporting_refusals
from irc.driver.judge import Answer, _approved, finish
from irc.model import Task
from irc.problem import Problem
from irc.retiming.retime import earliest_schedule
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Status
from irc.targets import (
    Backend,
    Budget,
    Engine,
    EngineMissing,
    Outcome,
    Program,
    SolveOptions,
    get_backend,
)

SHORTCUT_ENGINE = "critical-path"
"""The name of the engine in a schedule that needed no solver."""

CHECK_ENGINE = "stock-order"
"""The engine named where stock alone rules every schedule out."""


def solve_task(
    task: Task, options: SolveOptions | None = None, budget: Budget | None = None
) -> Answer:
    """Compiles, runs an engine, re-times and returns the answer.

    The task is planned as of t = 0, without its events; a note says so. If this is a part of a
    longer call, `budget` replaces the time limit of the options. Raises `InputError`,
    `UnknownTarget`, `EngineMissing` or `EngineFailed`. An answer without a schedule has no entries;
    its status says why.
    """
    options = options or SolveOptions()
    budget = Budget(options.time_limit) if budget is None else budget.share(1)
    backend = get_backend(options.target)
    engine = backend.engine(options.engine)
    if not _may_ask_a_planner(task, options, budget):
        return solve_by(task, backend, engine, options, budget)
    answer = solve_by(task, backend, engine, options, budget.share(FIRST_SHARE))
    planner = get_backend(PLANNERS)
    if answer.schedule.status is not Status.UNKNOWN or planner.engine().missing() is not None:
        return answer
    note = Diagnostic(
        Code.NO_ANSWER,
        f"{backend.name!r} found no schedule of this task from PDDL within {budget.elapsed:.1f} s,"
        f" so {PLANNERS!r} was asked",
        hint="name the target with --target to ask it at once",
    )
    found = solve_by(task, planner, planner.engine(), options, budget)
    return Answer(found.schedule, found.problem, (*found.notes, note))


FIRST_SHARE = 0.5
"""The share of the time after which a planner is asked about a task from PDDL."""

PLANNERS = "pddl21"
"""The target whose engines are planners."""


def _may_ask_a_planner(task: Task, options: SolveOptions, budget: Budget) -> bool:
    """Whether a task came from PDDL, and neither an engine nor endless time is asked for."""
    return (
        "pddl" in task.metadata
        and (options.target, options.engine) == ("cpsat", "auto")
        and budget.is_limited
    )


def solve_by(
    task: Task, backend: Backend, engine: Engine, options: SolveOptions, budget: Budget
) -> Answer:
    """The answer of `solve_task` by a given backend and engine."""
    problem = lower_for(task, backend)
    if options.shortcut and not problem.has_contention:
        schedule = schedule_of(problem, earliest_schedule(problem))
        outcome = Outcome(Status.OPTIMAL, SHORTCUT_ENGINE, schedule, problem.bounds.makespan.value)
    elif problem.deadline is not None and problem.bounds.makespan.value > problem.deadline:
        outcome = Outcome(Status.INFEASIBLE, SHORTCUT_ENGINE, notes=(_too_short(problem),))
    elif (stuck := _impossible_stock(problem)) is not None:
        outcome = Outcome(Status.INFEASIBLE, CHECK_ENGINE, notes=(stuck,))
    else:
        reason = engine.missing()
        if reason is not None:
            raise EngineMissing(reason)
        with reporting_refusals(task):
            outcome = engine.solve(Program(backend, task, problem), options, budget)
    schedule = finish(task, problem, outcome, backend.name, budget.elapsed)
    return Answer(_approved(task, schedule), problem, (*later_events(task), *outcome.notes))


def _too_short(problem: Problem) -> Diagnostic:
    """The note that the lower bound on the makespan is above the task's deadline."""
    return Diagnostic(
        Code.TOO_LATE,
        f"no schedule ends before {problem.time_text(problem.bounds.makespan.value)} "
        f"({problem.bounds.makespan.reason})",
        ("deadline",),
        "a later deadline or more capacity is needed",
    )


def _impossible_stock(problem: Problem) -> Diagnostic | None:
    """Why stock keeps something required from ever happening; loaded for tasks with stock."""
    if not problem.reservoirs:
        return None
    from irc.checks.stock_order import impossible_stock

    return impossible_stock(problem)
