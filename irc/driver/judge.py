"""Answers: their objective values and status, and the validator's approval."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from irc.checks import run_checks
from irc.diagnostics import Code, Diagnostic, InputError, Report, Severity
from irc.diagnostics.source import Source
from irc.model import Task
from irc.model.canonical import task_sha256
from irc.model.garbage import without_garbage
from irc.model.quantities import Number
from irc.problem import Problem
from irc.problem.objective_values import schedule_values
from irc.schedule import ObjectiveValue, Schedule, Status
from irc.targets import (
    EngineFailed,
    Outcome,
)

if TYPE_CHECKING:
    from irc.problem.precedence_times import PrecedenceTimes
    from irc.validation import Verdict


SHORTCUT_ENGINE = "critical-path"
"""The name of the engine in a schedule that needed no solver."""


@dataclass(frozen=True)
class Answer:
    """A schedule with the notes about it, and the problem that it solves.

    `lowered` is the problem, or a function that makes it for those who ask. `times` are the
    earliest times by precedences alone, where the task is kept as columns.
    """

    schedule: Schedule
    lowered: Problem | Callable[[], Problem]
    notes: tuple[Diagnostic, ...] = ()
    times: PrecedenceTimes | None = None

    @cached_property
    def problem(self) -> Problem:
        """The problem that the schedule solves."""
        return self.lowered if isinstance(self.lowered, Problem) else self.lowered()


def explained(schedule: Schedule, notes: Iterable[Diagnostic]) -> Schedule:
    """The schedule with the diagnostics that say why there is none, if there is none.

    Of the notes on an answer these are the errors, and what engines say of an unknown one.
    """
    if schedule.answered:
        return schedule
    why = (d for d in notes if d.severity is Severity.ERROR or d.code is Code.NO_ANSWER)
    return replace(schedule, reasons=tuple(why))


def reasons_for(task: Task, outcome: Outcome) -> tuple[Diagnostic, ...]:
    """The notes of an outcome, placed in the task's text; without an answer, at least one."""
    return tuple(_placed(note, task.source) for note in _with_reason(outcome))


def _placed(note: Diagnostic, source: Source | None) -> Diagnostic:
    """A diagnostic that carries its place in the task's text, if it is about a part of it."""
    if not note.pointer or note.within is not None or source is None:
        return note
    (placed,) = Report((note,), source).located()
    return placed if placed.within or placed.line is None else replace(placed, within=source)


def _with_reason(outcome: Outcome) -> tuple[Diagnostic, ...]:
    if outcome.status is Status.INFEASIBLE and not any(
        note.severity is Severity.ERROR for note in outcome.notes
    ):
        proved = f"no schedule exists: proved by {outcome.engine}"
        hint = "`irc explain` shows which statements cannot hold together"
        return (*outcome.notes, Diagnostic(Code.NO_SCHEDULE, proved, hint=hint))
    if outcome.status is Status.UNKNOWN and not any(
        note.code is Code.NO_ANSWER for note in outcome.notes
    ):
        unknown = f"{outcome.engine} found no schedule within the limits, and no proof of none"
        hint = "give it more time, or more memory"
        return (*outcome.notes, Diagnostic(Code.NO_ANSWER, unknown, hint=hint))
    return outcome.notes


def _approved(task: Task, schedule: Schedule) -> Schedule:
    """The schedule, if the validator finds no violation.

    Otherwise raises `EngineFailed` with the violations: no invalid schedule is reported.
    """
    if schedule.status not in (Status.OPTIMAL, Status.FEASIBLE):
        return schedule
    from irc.validation import validate

    verdict = validate(task, schedule)
    if not verdict.valid:
        reasons = "; ".join(v.message for v in verdict.violations[:3])
        raise EngineFailed(f"the answer was rejected by the validator: {reasons}")
    return schedule


def validate_schedule(
    task: Task, schedule: Schedule, source: Source | None = None, *, at: Number | None = None
) -> Verdict:
    """The validator's verdict on a schedule, after a check of the task itself.

    `at` is in the task's unit: actions that began before are history, and violations that the
    history alone causes are carried. Raises `InputError` for a faulty task, and for a schedule
    (read from `source`, if given) of another task.
    """
    report = run_checks(task, lint=False).report
    structural = [d for d in report.errors if not d.code.id.startswith("IRC3")]
    if structural:
        raise InputError(report)
    if schedule.task_sha256 is not None and schedule.task_sha256 != task_sha256(task):
        diagnostic = Diagnostic(
            Code.BAD_SCHEDULE,
            "this schedule was made for another task, or the task has changed since",
            ("task_sha256",),
            "remove 'task_sha256' from the schedule to judge it all the same",
        )
        raise InputError(Report((diagnostic,), source))
    from irc.validation import validate

    return validate(task, schedule, at)


@without_garbage()
def finish(
    task: Task,
    problem: Problem,
    outcome: Outcome,
    target: str,
    seconds: float,
    *,
    cancelled: bool = False,
    deterministic: bool = False,
) -> Schedule:
    """The schedule of an outcome, with its status, objective values and bounds.

    It is interrupted where the call was cancelled before the answer was certain, and repeatable
    where a deterministic call was not cut by the clock.
    """
    schedule = outcome.schedule or Schedule(())
    status = outcome.status
    objective: tuple[ObjectiveValue, ...] = ()
    if outcome.schedule is not None:
        status, objective = _judged(problem, outcome, schedule)
    return replace(
        schedule.of(task),
        status=status,
        objective=objective,
        task=task.name,
        task_sha256=task_sha256(task),
        target=target,
        engine=outcome.engine,
        seconds=round(seconds, 3),
        time_unit=task.time_unit,
        interrupted=cancelled and status in (Status.FEASIBLE, Status.UNKNOWN),
        repeatable=not outcome.is_cut if deterministic else None,
    )


def _judged(
    problem: Problem, outcome: Outcome, schedule: Schedule
) -> tuple[Status, tuple[ObjectiveValue, ...]]:
    """(the status, the objective values with their bounds): optimal if all meet their bounds."""
    values = schedule_values(problem, schedule)
    known = {level.name: level.bound for level in outcome.levels}
    if problem.objectives[0] == "makespan":
        ours = problem.to_units(max(outcome.bound, problem.bounds.makespan.value))
        known["makespan"] = max(ours, known.get("makespan") or 0)
    if outcome.status is Status.OPTIMAL:
        known.update((name, values[name]) for name in problem.objectives)
    objective = tuple(
        ObjectiveValue(name, values[name], known.get(name)) for name in problem.levels
    )
    # (The level `changes` that only chooses among equal schedules does not count.)
    own = objective[: len(problem.objectives)]
    if all(o.bound is not None and o.value == o.bound for o in own):
        return Status.OPTIMAL, objective
    return outcome.status, objective
