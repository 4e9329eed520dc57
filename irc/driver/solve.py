"""Solves a task: compile, run an engine, re-time, validate."""

from __future__ import annotations

from dataclasses import replace

from irc.checks import Checked, run_checks
from irc.diagnostics import Code, Diagnostic
from irc.driver.asking import asked
from irc.driver.compile import lower_checked, notes_on, reporting_refusals
from irc.driver.judge import SHORTCUT_ENGINE, Answer, _approved, explained, finish, reasons_for
from irc.driver.progress import telling
from irc.model import Task
from irc.problem import Problem
from irc.retiming.limits import too_late
from irc.retiming.retime import earliest_schedule
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule, Status
from irc.targets import (
    Backend,
    Budget,
    Engine,
    Outcome,
    Program,
    SolveOptions,
    get_backend,
)
from irc.targets.interrupt import ended_by_interrupt, lost

CHECKS_ENGINE = "checks"
"""The engine named where the checks of the task already prove that it has no schedule."""

_CUT = Diagnostic(
    Code.NO_ANSWER,
    "the search was cut by the clock before its work was done: not repeatable",
    hint="a longer time limit, or a smaller work limit, makes the answer repeatable",
)

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
    engine = backend.engine(options.engine)
    if options.deterministic and not engine.is_repeatable:
        options.require_seconds_only(f"engine {engine.name!r} of target {backend.name!r}")
    planner = _planner_for(task, options, budget)
    if planner is None:
        return solve_by(task, backend, engine, options, budget)
    from irc.driver.beside import with_planner

    checked = run_checks(task, lint=False)

    def solve(part: Budget) -> Answer:
        return solve_by(task, backend, engine, options, part, checked)

    def plan(part: Budget) -> Answer:
        alone = replace(options, target=PLANNERS, on_progress=None, cancel=part.cancel)
        return solve_by(task, planner, planner.engine(), alone, part, checked)

    return with_planner(solve, plan, budget, backend.name)


PLANNERS = "pddl21"
"""The target whose engines are planners."""


def _planner_for(task: Task, options: SolveOptions, budget: Budget) -> Backend | None:
    """The backend of planners, if they are asked too: about a task from PDDL, where neither an
    engine nor endless time was asked for. Not in a deterministic call: planners have a clock.
    """
    if (
        "pddl" not in task.metadata
        or (options.target, options.engine) != ("cpsat", "auto")
        or not budget.is_limited
        or options.deterministic
    ):
        return None
    planner = get_backend(PLANNERS)
    return planner if planner.engine().missing() is None else None


def solve_by(
    task: Task,
    backend: Backend,
    engine: Engine,
    options: SolveOptions,
    budget: Budget,
    checked: Checked | None = None,
) -> Answer:
    """The answer of `solve_task` by a given backend and engine; `checked`: the task's checks."""
    if task.columns is not None:
        from irc.driver.uncontended import by_columns

        if (answer := by_columns(task, backend, options, budget)) is not None:
            return answer
    checked = checked or run_checks(task, lint=False)
    if checked.report.contradicts:
        outcome = Outcome(Status.INFEASIBLE, CHECKS_ENGINE, notes=checked.report.errors)
        return _answer(task, checked.problem, outcome, backend, options, budget)
    # (How busy the machine is must not decide which bounds a deterministic call looks for.)
    patient = Budget(cancel=budget.cancel) if options.deterministic else budget
    problem = lower_checked(checked, backend, patient)
    if options.shortcut and not problem.has_contention:
        outcome = _by_critical_path(problem)
    elif problem.deadline is not None and problem.bounds.makespan.value > problem.deadline:
        outcome = Outcome(Status.INFEASIBLE, SHORTCUT_ENGINE, notes=(_too_short(problem),))
    elif (stuck := _impossible_stock(problem)) is not None:
        outcome = Outcome(Status.INFEASIBLE, CHECK_ENGINE, notes=(stuck,))
    else:

        def approve(found: Outcome) -> Schedule:
            return _approved(task, finish(task, problem, found, backend.name, budget.elapsed))

        reporting = telling(options, budget, approve)
        with reporting_refusals(task):
            program = Program(backend, task, problem)
            outcome = asked(program, engine, reporting, budget, lambda s: _is_valid(task, s))
    return _answer(task, problem, outcome, backend, options, budget)


def _is_valid(task: Task, schedule: Schedule) -> bool:
    from irc.validation import validate

    return validate(task, schedule).valid


def _answer(
    task: Task,
    problem: Problem,
    outcome: Outcome,
    backend: Backend,
    options: SolveOptions,
    budget: Budget,
) -> Answer:
    """The answer with an outcome, approved by the validator."""
    schedule = finish(
        task,
        problem,
        outcome,
        backend.name,
        budget.elapsed,
        cancelled=budget.is_cancelled,
        deterministic=options.deterministic,
    )
    notes = (*reasons_for(task, outcome), *((_CUT,) if schedule.repeatable is False else ()))
    schedule = explained(_approved(task, schedule), notes)
    return Answer(schedule, problem, (*notes_on(task), *notes))


def _by_critical_path(problem: Problem) -> Outcome:
    """The outcome with all activities as early as possible; infeasible if one is too late then.

    (The checks report what lags alone make too late, but not what state does.)
    """
    placed = earliest_schedule(problem)
    for i, place in enumerate(placed):
        late = too_late(problem, i, place.start, place.end)
        if late is not None:
            note = Diagnostic(Code.TOO_LATE, late, problem.activities[i].origin)
            return Outcome(Status.INFEASIBLE, SHORTCUT_ENGINE, notes=(note,))
    schedule = schedule_of(problem, placed)
    return Outcome(Status.OPTIMAL, SHORTCUT_ENGINE, schedule, problem.bounds.makespan.value)


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
