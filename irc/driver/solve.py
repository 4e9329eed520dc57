"""Solves a task: compile, run an engine, re-time, validate."""

from __future__ import annotations

import time

from irc.diagnostics import Code, Diagnostic
from irc.driver.compile import later_events, lower_for, reporting_refusals
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
"""The name of the engine in a schedule that needed no solver."""


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

    The task is planned as of t = 0, without its events; a note says so. Raises `InputError`,
    `UnknownTarget`, `EngineMissing` or `EngineFailed`. An answer without a schedule has no entries;
    its status says why.
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
    else:
        reason = runner.missing()
        if reason is not None:
            raise EngineMissing(reason)
        with reporting_refusals(task):
            outcome = runner.solve(Program(backend, task, problem), limits or Limits(), on_progress)
    schedule = finish(task, problem, outcome, target, time.perf_counter() - began)
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
