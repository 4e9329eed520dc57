"""The whole road from a task to an answer: compile, run, re-time, validate."""

from __future__ import annotations

import time

from irc.diagnostics import Code, Diagnostic
from irc.driver.compile import later_events, lower_for, refusals_told
from irc.driver.judge import Answer, _approved, finish
from irc.model import Task
from irc.problem import Problem
from irc.retiming.retime import earliest_schedule
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Status
from irc.targets import (
    EngineMissing,
    Limits,
    OnProgress,
    Outcome,
    Program,
    get_backend,
)

SHORTCUT_ENGINE = "critical-path"
"""What is named as engine where no solver was needed."""

CHECK_ENGINE = "stock-order"
"""The engine named where stock alone rules every schedule out."""


def solve_task(
    task: Task,
    target: str = "cpsat",
    engine: str = "auto",
    limits: Limits | None = None,
    *,
    shortcut: bool = True,
    on_progress: OnProgress | None = None,
) -> Answer:
    """Compiles, runs an engine, re-times and returns the answer.

    The task is planned as of t = 0: of its events there is only a note. Raises `InputError`,
    `UnknownTarget`, `EngineMissing` or `EngineFailed`. An answer without a schedule has no entries
    and says why in its status.
    """
    began = time.perf_counter()
    backend = get_backend(target)
    runner = backend.engine(engine)
    problem = lower_for(task, backend)
    if shortcut and not problem.has_contention:
        schedule = schedule_of(problem, earliest_schedule(problem))
        outcome = Outcome(Status.OPTIMAL, SHORTCUT_ENGINE, schedule, problem.bounds.makespan.value)
    elif problem.deadline is not None and problem.bounds.makespan.value > problem.deadline:
        outcome = Outcome(Status.INFEASIBLE, SHORTCUT_ENGINE, notes=(_too_short(problem),))
    elif (stuck := _impossible_stock(problem)) is not None:
        outcome = Outcome(Status.INFEASIBLE, CHECK_ENGINE, notes=(stuck,))
    else:
        reason = runner.missing()
        if reason is not None:
            raise EngineMissing(reason)
        with refusals_told(task):
            outcome = runner.solve(Program(backend, task, problem), limits or Limits(), on_progress)
    schedule = finish(task, problem, outcome, target, time.perf_counter() - began)
    return Answer(_approved(task, schedule), problem, (*later_events(task), *outcome.notes))


def _too_short(problem: Problem) -> Diagnostic:
    """Why no schedule meets the task's deadline, where a bound of ours says so."""
    return Diagnostic(
        Code.TOO_LATE,
        f"no schedule ends before {problem.time_text(problem.bounds.makespan.value)} "
        f"({problem.bounds.makespan.reason})",
        ("deadline",),
        "a later deadline or more capacity would be needed",
    )


def _impossible_stock(problem: Problem) -> Diagnostic | None:
    """Why stock keeps something required from ever happening; loaded for tasks with stock."""
    if not problem.reservoirs:
        return None
    from irc.checks.stock_order import impossible_stock

    return impossible_stock(problem)
