"""The whole road from a task to an answer: compile, run, re-time, validate."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from irc.backend import (
    MANIFEST_VERSION,
    EngineFailed,
    EngineMissing,
    Limits,
    OnProgress,
    Outcome,
    Program,
    get_backend,
)
from irc.canonical import task_sha256
from irc.checks import run_checks
from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.model import Task
from irc.pipeline import check_task, compile_task, later_events, lower_for, refusals_told
from irc.problem import Problem
from irc.retime import AnswerError, Placed, earliest_schedule
from irc.schedule import Entry, ObjectiveValue, Schedule, Status
from irc.source import Source
from irc.times import Number
from irc.worth import worth

if TYPE_CHECKING:
    from irc.validation import Verdict

__all__ = [
    "Answer",
    "check_task",
    "compile_task",
    "extract_answer",
    "finish",
    "lower_for",
    "schedule_of",
    "solve_task",
    "validate_schedule",
]

SHORTCUT_ENGINE = "critical-path"
"""What is named as engine where no solver was needed."""


@dataclass(frozen=True)
class Answer:
    """A schedule with what was found on the way, and the problem it answers."""

    schedule: Schedule
    problem: Problem
    notes: tuple[Diagnostic, ...] = ()


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
        outcome = Outcome(Status.OPTIMAL, SHORTCUT_ENGINE, schedule, problem.bound.value)
    elif problem.deadline is not None and problem.bound.value > problem.deadline:
        outcome = Outcome(Status.INFEASIBLE, SHORTCUT_ENGINE, notes=(_too_short(problem),))
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
        f"no schedule ends before {problem.time_text(problem.bound.value)} "
        f"({problem.bound.reason})",
        ("deadline",),
        "a later deadline or more capacity would be needed",
    )


def extract_answer(
    manifest: Mapping[str, Any],
    answer: str,
    *,
    manifest_source: Source | None = None,
    answer_name: str = "<answer>",
) -> Answer:
    """A raw answer to a program, long after it was compiled: decoded, re-timed, validated.

    Raises `InputError` where the manifest is not one of ours or the answer has no valid schedule;
    it shows the place in the manifest's text (if its source is given) or in the answer.
    """
    began = time.perf_counter()
    task, target, names = _read_manifest(manifest, manifest_source)
    backend = get_backend(target)
    problem = lower_for(task, backend)
    try:
        schedule = backend.decode(problem, names, answer)
    except AnswerError as error:
        raise _bad_answer(str(error), answer, answer_name, error.line) from None
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, ZeroDivisionError):
        message = "the manifest's 'names' do not fit its task; another version may have written it"
        diagnostic = Diagnostic(Code.BAD_ANSWER, message, ("names",))
        raise InputError(Report((diagnostic,), manifest_source)) from None
    outcome = Outcome(Status.FEASIBLE, "extract", schedule)
    schedule = finish(task, problem, outcome, target, time.perf_counter() - began)
    try:
        approved = _approved(task, replace(schedule, engine=None))
        return Answer(approved, problem, later_events(task))
    except EngineFailed as error:
        raise _bad_answer(str(error), answer, answer_name) from None


def _bad_answer(message: str, answer: str, name: str, line: int | None = None) -> InputError:
    """What is wrong with an answer, shown at a line of it (where none is known, at its start)."""
    offset = sum(len(text) + 1 for text in answer.split("\n")[: (line or 1) - 1])
    diagnostic = Diagnostic(
        Code.BAD_ANSWER,
        message,
        hint="give all that the engine printed about the program of this manifest",
        offset=min(offset, len(answer)),
    )
    return InputError(Report((diagnostic,), Source(name, answer)))


def _read_manifest(
    manifest: Mapping[str, Any], source: Source | None
) -> tuple[Task, str, Mapping[str, Any]]:
    findings = Findings()
    if manifest.get("irc_manifest") != MANIFEST_VERSION:
        findings.add(
            Code.BAD_ANSWER,
            f"this is not a manifest of this version: 'irc_manifest' must be {MANIFEST_VERSION!r}",
            ("irc_manifest",),
            hint="give the manifest.json that `irc compile -o` wrote",
        )
        raise InputError(Report(tuple(findings.items), source))
    raw, target, names = (manifest.get(key) for key in ("task", "target", "names"))
    if (
        not isinstance(raw, Mapping)
        or not isinstance(target, str)
        or not isinstance(names, Mapping)
    ):
        findings.add(
            Code.BAD_ANSWER,
            "the manifest lacks 'task', 'target' or 'names'",
            hint="give the manifest.json that `irc compile -o` wrote",
        )
        raise InputError(Report(tuple(findings.items), source))
    from irc.frontends.shape import to_task

    task = to_task(raw, findings)
    if task is None:
        raise InputError(Report(tuple(findings.items), source))
    if task_sha256(task) != manifest.get("task_sha256"):
        findings.add(
            Code.BAD_ANSWER,
            "the manifest was changed: its task has another hash",
            ("task_sha256",),
            hint="compile the task again; the answer may be to the program of before",
        )
        raise InputError(Report(tuple(findings.items), source))
    return task, target, names


def _approved(task: Task, schedule: Schedule) -> Schedule:
    """The schedule, once the validator has found nothing against it.

    Raises `EngineFailed` with the validator's reasons otherwise: nothing invalid is reported.
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
    """The independent verdict on a schedule, once the task itself has been checked.

    `at`, in the task's unit: what began before is history, and what it alone causes is carried.
    Raises `InputError` for a faulty task, or a schedule (read from `source`, if it was) that
    says it is of another task.
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


def schedule_of(problem: Problem, placed: Sequence[Placed]) -> Schedule:
    """What is present of the placed activities, in the task's time unit, by start, end and name.

    Occurrences of one action are numbered by start, whichever activities stand for them.
    """
    order = sorted(
        (i for i, place in enumerate(placed) if place.present),
        key=lambda i: (placed[i].start, placed[i].end, problem.activities[i].id, placed[i].rank),
    )
    entries = tuple(_entry(problem, i, placed[i]) for i in order)
    if len({entry.id for entry in entries}) < len(entries):
        entries = _numbered(entries)
    return Schedule(entries, task=problem.name)


def _numbered(entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """Entries in order of time, the k-th of each action as its k-th occurrence."""
    counts: Counter[str] = Counter()
    numbered = []
    for entry in entries:
        counts[entry.id] += 1
        numbered.append(replace(entry, occurrence=counts[entry.id]))
    return tuple(numbered)


def _entry(problem: Problem, index: int, placed: Placed) -> Entry:
    activity = problem.activities[index]
    held: dict[str, int] = {}
    for use, r in zip(activity.uses, placed.resources, strict=True):
        if r is not None:
            name = problem.resources[r].id
            held[name] = held.get(name, 0) + use.amount
    return Entry(
        activity.id,
        problem.to_units(placed.start),
        problem.to_units(placed.end),
        held,
        mode=None if placed.mode is None else activity.details.modes[placed.mode].id,
        rank=placed.rank,
        end_rank=None if placed.end_rank == placed.rank else placed.end_rank,
    )


def finish(task: Task, problem: Problem, outcome: Outcome, target: str, seconds: float) -> Schedule:
    """The outcome as the schedule that is reported: status, objective and bounds filled in."""
    schedule = outcome.schedule or Schedule(())
    status = outcome.status
    objective: tuple[ObjectiveValue, ...] = ()
    if outcome.schedule is not None:
        status, objective = _judged(problem, outcome, schedule)
    return replace(
        schedule,
        status=status,
        objective=objective,
        task=task.name,
        task_sha256=task_sha256(task),
        target=target,
        engine=outcome.engine,
        seconds=round(seconds, 3),
        time_unit=task.time_unit,
    )


def _judged(
    problem: Problem, outcome: Outcome, schedule: Schedule
) -> tuple[Status, tuple[ObjectiveValue, ...]]:
    """What each objective came to, and whether all of them meet proven bounds."""
    values = worth(problem, schedule)
    known = {level.name: level.bound for level in outcome.levels}
    if problem.objectives[0] == "makespan":
        ours = problem.to_units(max(outcome.bound, problem.bound.value))
        known["makespan"] = max(ours, known.get("makespan") or 0)
    if outcome.status is Status.OPTIMAL:
        known.update((name, values[name]) for name in problem.objectives)
    objective = tuple(
        ObjectiveValue(name, values[name], known.get(name)) for name in problem.levels
    )
    # (Changes that only choose among equals do not count.)
    own = objective[: len(problem.objectives)]
    if all(o.bound is not None and o.value == o.bound for o in own):
        return Status.OPTIMAL, objective
    return outcome.status, objective
