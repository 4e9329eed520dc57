"""Solves a task: compile, run an engine, re-time, validate."""

from __future__ import annotations

from dataclasses import replace

from irc.checks import run_checks
from irc.diagnostics import Code, Diagnostic
from irc.driver.compile import lower_checked, notes_on, reporting_refusals
from irc.driver.judge import Answer, _approved, explained, finish, reasons_for
from irc.driver.progress import telling
from irc.driver.quick import quick_outcome
from irc.model import Task
from irc.problem import Problem
from irc.retiming.retime import earliest_schedule
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule, Status
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
from irc.targets.interrupt import ended_by_interrupt, lost

SHORTCUT_ENGINE = "critical-path"
"""The name of the engine in a schedule that needed no solver."""

CHECKS_ENGINE = "checks"
"""The engine named where the checks of the task already prove that it has no schedule."""
AFTERWARDS_SHARE = 0.05
"""The part of a time limit that is kept for re-timing, the validator and the output, at most."""

CHECK_ENGINE = "stock-order"
"""The engine named where stock alone rules every schedule out."""


def solve_task(
    task: Task, options: SolveOptions | None = None, budget: Budget | None = None
) -> Answer:
    """Compiles, runs an engine, re-times and returns the answer.

    The task is planned as of t = 0, without its events; a note says so. If this is a part of a
    longer call, `budget` replaces the time limit and the cancellation of the options. Raises
    `InputError`, `UnknownTarget`, `EngineMissing` or `EngineFailed`, and `KeyboardInterrupt` where
    ^C comes before there is any answer. An answer without a schedule has no entries; its status
    says why.
    """
    options = options or SolveOptions()
    if budget is not None:
        return _solved(task, options, budget)
    with ended_by_interrupt(options.cancel) as cancel:
        answer = _solved(task, options, replace(options, cancel=cancel).budget())
        if answer.schedule.status is Status.UNKNOWN:
            lost(cancel)
    return answer


def _solved(task: Task, options: SolveOptions, budget: Budget) -> Answer:
    backend = get_backend(options.target)
    return solve_by(task, backend, backend.engine(options.engine), options, budget)


def solve_by(
    task: Task, backend: Backend, engine: Engine, options: SolveOptions, budget: Budget
) -> Answer:
    """The answer of `solve_task` by a given backend and engine."""
    checked = run_checks(task, lint=False)
    if checked.report.contradicts:
        outcome = Outcome(Status.INFEASIBLE, CHECKS_ENGINE, notes=checked.report.errors)
        return _answer(task, checked.problem, outcome, backend, budget)
    problem = lower_checked(checked, backend, budget)
    if options.shortcut and not problem.has_contention:
        schedule = schedule_of(problem, earliest_schedule(problem))
        outcome = Outcome(Status.OPTIMAL, SHORTCUT_ENGINE, schedule, problem.bounds.makespan.value)
    elif problem.deadline is not None and problem.bounds.makespan.value > problem.deadline:
        outcome = Outcome(Status.INFEASIBLE, SHORTCUT_ENGINE, notes=(_too_short(problem),))
    elif (stuck := _impossible_stock(problem)) is not None:
        outcome = Outcome(Status.INFEASIBLE, CHECK_ENGINE, notes=(stuck,))
    else:

        def approve(found: Outcome) -> Schedule:
            return _approved(task, finish(task, problem, found, backend.name, budget.elapsed))

        told = telling(options, budget, approve)
        with reporting_refusals(task):
            outcome = _asked(Program(backend, task, problem), engine, told, budget)
    return _answer(task, problem, outcome, backend, budget)


def _answer(
    task: Task, problem: Problem, outcome: Outcome, backend: Backend, budget: Budget
) -> Answer:
    """The answer with an outcome, approved by the validator."""
    schedule = finish(
        task, problem, outcome, backend.name, budget.elapsed, cancelled=budget.is_cancelled
    )
    notes = reasons_for(task, outcome)
    schedule = explained(_approved(task, schedule), notes)
    return Answer(schedule, problem, (*notes_on(task), *notes))


def _asked(program: Program, engine: Engine, options: SolveOptions, budget: Budget) -> Outcome:
    """The engine's outcome; the compiler's own schedule where there was no time for an engine."""
    reason = engine.missing()
    if reason is not None:
        raise EngineMissing(reason)
    if not budget.is_cancelled:
        import irc.validation  # noqa: F401 - now, while there is time: a search may be cut short
    hurried = budget.is_cancelled or budget.left < engine.loading_seconds * budget.slowness
    quick = quick_outcome(program.problem) if hurried else None
    if quick is not None:
        return quick
    if budget.is_cancelled:
        return Outcome(Status.UNKNOWN, engine.name)
    # What follows takes about as long as what came before: reading and checking.
    after = min(budget.elapsed, AFTERWARDS_SHARE * budget.limit)
    outcome = engine.solve(program, options, budget.at_most(budget.left - after))
    if outcome.status is Status.UNKNOWN and budget.is_cancelled:
        quick = quick_outcome(program.problem)
    return outcome if quick is None else replace(quick, notes=outcome.notes)


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
