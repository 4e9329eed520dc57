"""The Python API: `irc.load`, `check`, `compile`, `solve`, `explain`, `extract`, `validate`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irc.diagnostics import Findings, InputError, Report
from irc.driver.compile import check_task, compile_task
from irc.driver.extract import extract_answer
from irc.driver.judge import validate_schedule
from irc.driver.solve import solve_task
from irc.frontends.files import parse_task, read_task
from irc.model import Task
from irc.model.from_document import to_task
from irc.model.quantities import Number
from irc.model.times import parse_instant
from irc.schedule import Schedule
from irc.targets import Limits, OnProgress, Program
from irc.validation import Verdict

if TYPE_CHECKING:
    from irc.explanation import Explanation

__all__ = ["check", "compile", "explain", "extract", "load", "loads", "solve", "validate"]


def load(path: str | Path) -> Task:
    """The task in a file ("-": standard input).

    Raises `InputError`, whose `report` names every fault of syntax and shape with its place.
    """
    return read_task(path).task


def loads(text: str) -> Task:
    """The task in a text; a language model's answer is read as it stands."""
    return parse_task(text).task


def _task(task: Task | str | Path | Mapping[str, Any]) -> Task:
    if isinstance(task, Task):
        return task
    return _from_mapping(task) if isinstance(task, Mapping) else load(task)


def _from_mapping(document: Mapping[str, Any]) -> Task:
    findings = Findings()
    task = to_task(document, findings)
    if task is None:
        raise InputError(Report(tuple(findings.items)))
    return task


def check(task: Task | str | Path | Mapping[str, Any]) -> Report:
    """All diagnostics of a task or a file: errors, warnings and notes, in one run."""
    if isinstance(task, (str, Path)):
        try:
            reading = read_task(task)
        except InputError as error:
            return error.report
        return check_task(reading.task, reading.notes)
    try:
        return check_task(_task(task))
    except InputError as error:
        return error.report


def compile(task: Task | str | Path | Mapping[str, Any], target: str = "pddl21") -> Program:
    """The task as a program of `target`: its `files`, its `manifest`, and the way back.

    The program is that of t = 0; where the task has events, its `notes` say that they are not seen.
    Raises `InputError` where the task is at fault or the target refuses it.
    """
    return compile_task(_task(task), target)


def solve(
    task: Task | str | Path | Mapping[str, Any],
    target: str = "cpsat",
    *,
    engine: str = "auto",
    time_limit: float | None = None,
    memory_limit: int | None = None,
    seed: int = 0,
    workers: int | None = None,
    shortcut: bool = True,
    on_progress: OnProgress | None = None,
) -> Schedule:
    """The best schedule found, validated, with an honest status.

    `time_limit` in seconds of wall-clock time, `memory_limit` in MB. With `shortcut` a task
    without contention is solved by its critical path alone. The task is planned as of t = 0: its
    events are not seen. Raises `InputError`,
    `irc.targets.UnknownTarget`, `EngineMissing` or `EngineFailed`.
    """
    if time_limit is not None and not time_limit > 0:
        raise ValueError(f"time_limit must be more than 0 seconds, not {time_limit}")
    limits = Limits(time_limit, memory_limit, workers, seed)
    return solve_task(
        _task(task), target, engine, limits, shortcut=shortcut, on_progress=on_progress
    ).schedule


def explain(
    task: Task | str | Path | Mapping[str, Any], *, time_limit: float | None = None
) -> Explanation:
    """Why a task has no schedule, or what makes its schedule as long as it is.

    Of an infeasible task: a minimal set of statements that cannot hold together. Of a feasible
    one: a critical chain, the slack of each action, and what proves that nothing is shorter.
    `time_limit` in seconds of wall-clock time. Raises `InputError` for a task with other faults
    than that it cannot be scheduled, or that the solver's target refuses.
    """
    from irc.explanation import explain_task

    if time_limit is not None and not time_limit > 0:
        raise ValueError(f"time_limit must be more than 0 seconds, not {time_limit}")
    return explain_task(_task(task), time_limit)


def extract(manifest: Mapping[str, Any] | Program, answer: str) -> Schedule:
    """An engine's raw output → the validated schedule of the original task.

    Needs nothing but the manifest, so another process, or another day, can do it. Raises
    `InputError` where the manifest or the answer cannot be used.
    """
    document = manifest.manifest if isinstance(manifest, Program) else manifest
    return extract_answer(document, answer).schedule


def validate(
    task: Task | str | Path | Mapping[str, Any],
    schedule: Schedule,
    at: Number | str | None = None,
) -> Verdict:
    """The independent verdict: `valid`, and every violation with its rule, actions and times.

    `at` is a time of the task, as a number of its unit or a text such as "5 min": what began
    before is history, and what it alone causes is `carried`, not held against the schedule.
    Raises `InputError` where the task is faulty or the schedule says it is of another task, and
    `irc.model.times.TimeError` where `at` is no time of it.
    """
    known = _task(task)
    moment = None if at is None else known.number(parse_instant(at))
    return validate_schedule(known, schedule, at=moment)
