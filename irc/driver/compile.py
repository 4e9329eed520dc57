"""From a task to a program: check, lower, encode. `irc.driver.solve` does the rest."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from irc.checks import Checked, run_checks
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.model import Task
from irc.model.garbage import without_garbage
from irc.passes import run_passes
from irc.problem import Problem
from irc.targets import Backend, Budget, Program, Refusal, get_backend, require_support


def check_task(task: Task, earlier: Iterable[Diagnostic] = ()) -> Report:
    """All diagnostics of a task, after the `earlier` ones about its text."""
    return run_checks(task, earlier).report


HURRIED_SHARE = 0.3
"""Of the time limit: once it is spent, only the quick bounds on the makespan are sought."""


def lower_for(task: Task, backend: Backend) -> Problem:
    """Checks a task against itself and a backend's ledger, lowers it and runs the passes.

    Raises `InputError` if the task is faulty or the target does not support it.
    """
    return lower_checked(run_checks(task, lint=False), backend)


@without_garbage()
def lower_checked(checked: Checked, backend: Backend, budget: Budget | None = None) -> Problem:
    """The same for a task that has been checked.

    If much of the budget is spent, only quick bounds on the makespan are sought.
    """
    if not checked.report.ok:
        raise InputError(checked.report)
    require_support(checked.task, backend)
    return run_passes(checked.problem, hurried=lambda: is_hurried(budget))


def is_hurried(budget: Budget | None) -> bool:
    """Whether much of a budget is spent already."""
    if budget is None:
        return False
    return budget.is_cancelled or budget.elapsed > HURRIED_SHARE * budget.limit


def compile_task(task: Task, target: str) -> Program:
    """The task as a program of `target`.

    Raises `InputError` (the task is faulty or refused) or `UnknownTarget`.
    """
    backend = get_backend(target)
    program = Program(backend, task, lower_for(task, backend), notes_on(task))
    with reporting_refusals(task):
        program.files  # noqa: B018 - encodes now, so that a refusal is raised here
    return program


def notes_on(task: Task) -> tuple[Diagnostic, ...]:
    """Notes on how a task is planned: its times that are rounded, its events that are not used."""
    rounded: tuple[Diagnostic, ...] = ()
    if task.clock.resolution is not None:
        from irc.checks.resolution import rounding_note

        rounded = tuple(placed(note, task) for note in rounding_note(task))
    return (*rounded, *later_events(task))


def placed(note: Diagnostic, task: Task) -> Diagnostic:
    """The note with its own source, so that it can be shown without the report of the task."""
    (found,) = Report((note,), task.source).located()
    return found if found.within else replace(found, within=task.source)


def later_events(task: Task) -> tuple[Diagnostic, ...]:
    """A note that the plan does not use the task's events, if it has any.

    A plan as of t = 0 uses no event, not even one at t = 0: events become known while the task
    runs. The note carries its own source, so that it can be shown without the report of the task.
    """
    if not task.events:
        return ()
    count = len(task.events)
    events = f"{count} events" if count > 1 else "event"
    note = Diagnostic(
        Code.LATER_EVENTS,
        f"planned as of t = 0, without the task's {events}",
        ("events", 0),
        "`irc simulate` runs the task with its events and plans the rest again at each of them",
    )
    return (placed(note, task),)


@contextmanager
def reporting_refusals(task: Task) -> Iterator[None]:
    """Turns a backend's refusal into the `InputError` that names its place."""
    try:
        yield
    except Refusal as refusal:
        found = refusal.diagnostic
        if not found.pointer:
            from irc.checks.resolution import times_far_apart

            found = times_far_apart(task, found)
        raise InputError(Report((found,), task.source)) from None
