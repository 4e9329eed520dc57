"""What the online commands share: how to plan, and what they read beside the task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from irc.checks import run_checks
from irc.cli.exit_codes import EXIT_INPUT, EXIT_NO_ANSWER, EXIT_USE
from irc.cli.output import Format, fail, tell_notes
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.diagnostics.source import Source
from irc.driver.solve import solve_task
from irc.execution.execution import Execution
from irc.frontends.files import STANDARD_INPUT, read_task, read_text
from irc.frontends.json.document import read_document
from irc.model import Task
from irc.model.canonical import task_sha256
from irc.model.quantities import Number
from irc.schedule import Schedule, Status, schedule_from_json
from irc.targets import SolveOptions, get_backend


@dataclass(frozen=True)
class Planning:
    """The options that say how the rest of a task is planned, each time that it is."""

    target: str
    engine: str
    time_limit: float
    memory_limit: int | None
    seed: int
    workers: int | None
    stability: Fraction

    @property
    def options(self) -> SolveOptions:
        """The same for the library."""
        return SolveOptions(
            self.target,
            self.engine,
            self.time_limit,
            self.memory_limit,
            self.workers,
            self.seed,
            stability=self.stability,
        )

    def require_engine(self) -> None:
        """Raises `UnknownTarget` where there is no such target or engine, before it is needed."""
        get_backend(self.target).engine(self.engine)

    def execution(
        self, task: Task, schedule: Schedule, at: Number = 0, source: Source | None = None
    ) -> Execution:
        """The task in execution by a schedule (read from `source`, if it was), as of `at`.

        Raises `InputError` where the schedule does not fit the task.
        """
        try:
            return Execution(task, schedule, at, options=self.options)
        except InputError as error:
            raise InputError(Report(error.report.diagnostics, source)) from None

    def first_schedule(self, task: Task) -> Schedule:
        """The best schedule of a task of which nothing has run yet, and no event is known."""
        return solve_task(task, self.target, self.engine, self.options.limits).schedule


def one_standard_input(format: Format, *names: str | None) -> None:
    """Ends with wrong use where more than one of the inputs is standard input."""
    if sum(name == STANDARD_INPUT for name in names) > 1:
        fail(EXIT_USE, "only one of the inputs can be standard input", format)


def read_schedule(path: str) -> tuple[Schedule, Source]:
    """The schedule in a file, and its text. Raises `InputError`, also where it holds no plan."""
    document = read_document(*read_text(path))
    schedule = schedule_from_json(document.content, document.source)
    if not schedule.answered:
        raise _unsuited(
            f"there is no plan in this schedule: its status is {schedule.status}",
            "status",
            "give the schedule that was in force before",
            document.source,
        )
    return schedule, document.source


def require_task(schedule: Schedule, source: Source, task: Task) -> None:
    """Raises `InputError` where a schedule says that it is of another task."""
    if schedule.task_sha256 in (None, task_sha256(task)):
        return
    raise _unsuited(
        "this schedule was made for another task, or the task has changed since",
        "task_sha256",
        "give the task it was made for (`irc replan --task-output` writes the one in force), "
        "or remove 'task_sha256' from the schedule to go on all the same",
        source,
    )


def _unsuited(message: str, field: str, hint: str, source: Source) -> InputError:
    return InputError(Report((Diagnostic(Code.BAD_SCHEDULE, message, (field,), hint),), source))


def schedule_to_begin_with(path: str, task: Task) -> tuple[Schedule, Source]:
    """The schedule in a file, which must be one of the task. Raises `InputError`."""
    schedule, source = read_schedule(path)
    require_task(schedule, source, task)
    return schedule, source


def read_sound_task(file: str, format: Format) -> Task:
    """The task in a file; notes on its text are told. Raises `InputError` for its faults.

    Whether all of it can still be scheduled is not judged: that is what planning finds.
    """
    reading = read_task(file)
    if format is Format.text:
        tell_notes(reading.notes, reading.task.source)
    report = run_checks(reading.task, lint=False).report
    if any(not d.code.id.startswith("IRC3") for d in report.errors):
        raise InputError(report)
    return reading.task


def end_with(statuses: Sequence[Status]) -> None:
    """Ends the process where a planning found no schedule: the first one that did not counts."""
    import sys

    for status in statuses:
        if status is Status.INFEASIBLE:
            sys.exit(EXIT_INPUT)
        if status in (Status.UNKNOWN, Status.FAILED):
            sys.exit(EXIT_NO_ANSWER)
    return None
