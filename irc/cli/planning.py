"""What the online commands share: how to plan, and what they read beside the task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from irc.backend import Limits
from irc.canonical import task_sha256
from irc.checks import run_checks
from irc.cli import EXIT_INPUT, EXIT_NO_ANSWER, EXIT_USE
from irc.cli.output import Format, fail
from irc.compiler import solve_task
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.frontends.files import STANDARD_INPUT, read_text
from irc.frontends.json_document import read_document
from irc.model import Task
from irc.online.execution import Execution
from irc.schedule import Schedule, Status, schedule_from_json
from irc.times import Number


@dataclass(frozen=True)
class Planning:
    """The options that say how the rest of a task is planned, each time that it is."""

    target: str
    engine: str
    time_limit: float
    memory_limit: int | None
    seed: int
    workers: int | None
    stability: float

    @property
    def limits(self) -> Limits:
        """Those of one planning."""
        return Limits(self.time_limit, self.memory_limit, self.workers, self.seed)

    def execution(self, task: Task, schedule: Schedule, at: Number = 0) -> Execution:
        """The task in execution by a schedule, as of `at`."""
        return Execution(
            task,
            schedule,
            at,
            target=self.target,
            engine=self.engine,
            limits=self.limits,
            stability=self.stability,
        )

    def first_schedule(self, task: Task) -> Schedule:
        """The best schedule of a task of which nothing has run yet, and no event is known."""
        plain = task.model_copy(update={"events": ()}).with_source(task.source)
        schedule = solve_task(plain, self.target, self.engine, self.limits).schedule
        return replace(schedule, task_sha256=task_sha256(task))


def one_standard_input(format: Format, *names: str | None) -> None:
    """Ends with wrong use where more than one of the inputs is standard input."""
    if sum(name == STANDARD_INPUT for name in names) > 1:
        fail(EXIT_USE, "only one of the inputs can be standard input", format)


def read_schedule(path: str, task: Task) -> Schedule:
    """The schedule in a file, which must be one of the task. Raises `InputError`."""
    document = read_document(*read_text(path))
    schedule = schedule_from_json(document.content, document.source)

    def refused(message: str, field: str, hint: str) -> InputError:
        finding = Diagnostic(Code.BAD_SCHEDULE, message, (field,), hint)
        return InputError(Report((finding,), document.source))

    if schedule.task_sha256 is not None and schedule.task_sha256 != task_sha256(task):
        raise refused(
            "this schedule was made for another task, or the task has changed since",
            "task_sha256",
            "give the task it was made for (`irc replan --task-output` writes the one in force), "
            "or remove 'task_sha256' from the schedule to go on all the same",
        )
    if not schedule.answered:
        raise refused(
            f"there is no plan in this schedule: its status is {schedule.status}",
            "status",
            "give the schedule that was in force before",
        )
    return schedule


def require_sound(task: Task) -> None:
    """Raises `InputError` where a task or one of its events has faults of structure.

    Whether what is left of it can still be scheduled is not judged: that is what planning finds.
    """
    report = run_checks(task, lint=False).report
    if any(not d.code.id.startswith("IRC3") for d in report.errors):
        raise InputError(report)


def end_with(statuses: Sequence[Status]) -> None:
    """Ends the process where a planning found no schedule: the first one that did not counts."""
    import sys

    for status in statuses:
        if status is Status.INFEASIBLE:
            sys.exit(EXIT_INPUT)
        if status in (Status.UNKNOWN, Status.FAILED):
            sys.exit(EXIT_NO_ANSWER)
    return None
