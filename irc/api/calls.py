"""The functions on tasks: `check`, `compile`, `solve`, `explain`, `validate`, `replan`, …"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, Unpack

from irc.api.values import read
from irc.diagnostics import InputError, Report
from irc.driver.compile import check_task, compile_task
from irc.driver.extract import extract_answer
from irc.driver.judge import validate_schedule
from irc.driver.solve import solve_task
from irc.frontends.files import read_task
from irc.model import Task
from irc.model.built import Built
from irc.model.quantities import Number
from irc.model.times import json_number, parse_instant
from irc.schedule import Schedule
from irc.targets import (
    Cancellation,
    EngineKeywords,
    Program,
    SolveKeywords,
    SolveOptions,
    require_seconds,
)
from irc.validation import Verdict

if TYPE_CHECKING:
    from irc.execution.simulation import Simulation
    from irc.execution.step import Step
    from irc.explanation import Explanation, Lateness
    from irc.model import Event

AnyEvent: TypeAlias = "Event | Built[Event] | Mapping[str, Any]"
"""An event: one built in code, an immutable one, or a JSON document."""

AnyTask = Task | Built[Task] | Mapping[str, Any] | str | Path
"""A task: one built in code, an immutable one, a JSON document, or the path of a file."""


def ir_of(task: AnyTask) -> Task:
    """The immutable task. Raises `InputError` where a document or file has faults."""
    if isinstance(task, Task):
        return task
    if isinstance(task, Mapping):
        return read(task)
    if isinstance(task, (str, Path)):
        return read_task(task).task
    found = getattr(task, "ir", None)
    if not isinstance(found, Task):
        raise TypeError(f"expected a task, a document or a path, not {type(task).__name__}")
    return found


def check(task: AnyTask) -> Report:
    """All diagnostics of a task or a file: errors, warnings and notes, in one run."""
    try:
        if isinstance(task, (str, Path)):
            reading = read_task(task)
            return check_task(reading.task, reading.notes)
        return check_task(ir_of(task))
    except InputError as error:
        return error.report


def compile(task: AnyTask, target: str = "cpsat") -> Program:
    """The task as a program of `target`: its `files`, its `manifest`, and the way back.

    The program is that of t = 0; where the task has events, its `notes` say that they are ignored.
    Raises `InputError` where the task has faults or the target refuses it.
    """
    return compile_task(ir_of(task), target)


def solve(
    task: AnyTask,
    target: str | None = None,
    *,
    options: SolveOptions | None = None,
    scheduler: str | None = None,
    **more: Unpack[EngineKeywords],
) -> Schedule:
    """The best schedule found, validated, with its status.

    The options are those of `SolveOptions`, alone or on top of `options`: `engine`, `time_limit`
    (seconds of wall-clock time), `memory_limit` (MB), `workers`, `seed`, `shortcut`, `on_progress`,
    `cancel`, `deterministic`, `work_limit`. `cancel`, and in the main thread ^C, end it with the
    best schedule so far. With `scheduler`, the address of a Dask scheduler such as
    "tcp://10.0.0.5:8786", the workers of that cluster race for the best schedule. The task is
    planned as of t = 0: its events are ignored. Raises `InputError`, `OptionError`,
    `UnknownTarget`, `EngineMissing` or `EngineFailed`.
    """
    chosen = SolveOptions.of(options, more, target)
    if scheduler is None:
        return solve_task(ir_of(task), chosen).schedule
    from irc.cluster.solving import solve_on_cluster

    return solve_on_cluster(ir_of(task), scheduler, chosen).schedule


def explain(
    task: AnyTask, *, time_limit: float | None = None, cancel: Cancellation | None = None
) -> Explanation:
    """Explains why a task has no schedule, or why its schedule is not shorter.

    For an infeasible task: a minimal set of statements that cannot hold together. For a feasible
    one: a critical chain, the slack of each action, and the proof that no schedule is shorter.
    `time_limit` is in seconds of wall-clock time; `cancel` ends it earlier, with what is known by
    then. Raises `InputError` for a task that has faults besides being infeasible, or that the
    target refuses.
    """
    from irc.explanation import explain_task

    require_seconds(time_limit)
    return explain_task(ir_of(task), time_limit, cancel=cancel)


def explain_lateness(
    task: AnyTask,
    name: str,
    *,
    time_limit: float | None = None,
    cancel: Cancellation | None = None,
) -> Lateness:
    """Explains why an action or a group is late: by how much, what makes it so, what would help.

    Each change that it suggests was verified by solving the changed task. `time_limit` is in
    seconds of wall-clock time for all of it. Raises `InputError` where the task has no action or
    group `name`, or is faulty.
    """
    from irc.explanation import explain_lateness

    require_seconds(time_limit)
    return explain_lateness(ir_of(task), name, time_limit, cancel=cancel)


def extract(manifest: Mapping[str, Any] | Program, answer: str) -> Schedule:
    """Turns an engine's raw output into the validated schedule of the original task.

    It needs only the manifest, so another process can do it, at any later time. Raises
    `InputError` where the manifest or the answer cannot be used.
    """
    document = manifest.manifest if isinstance(manifest, Program) else manifest
    return extract_answer(document, answer).schedule


def validate(task: AnyTask, schedule: Schedule, at: Number | str | None = None) -> Verdict:
    """Validates a schedule: `valid`, and every violation with its rule, actions and times.

    `at` is a time of the task, as a number of its unit or a text such as "5 min": entries that
    began before it are history, and violations that the history alone causes are `carried`.
    Raises `InputError` where the task has faults or the schedule is of another task, and
    `irc.TimeError` where `at` is not a time.
    """
    known = ir_of(task)
    moment = None if at is None else known.number(parse_instant(at))
    return validate_schedule(known, schedule, at=moment)


def replan(
    task: AnyTask,
    schedule: Schedule,
    at: Number | str,
    events: Iterable[AnyEvent] = (),
    *,
    options: SolveOptions | None = None,
    **more: Unpack[SolveKeywords],
) -> Step:
    """Repairs the schedule of a running task at `at`, after events of that instant.

    The history stays, and the rest is planned again. `at` is a time of the task, as for `validate`;
    an event may be a JSON document, whose time is `at` where it has none. The options are those of
    `solve` and `stability`. Raises what `Execution.apply` and `Execution.replan` raise.
    """
    from irc.execution.execution import replan

    known = ir_of(task)
    moment = known.number(parse_instant(at))
    return replan(known, schedule, moment, _events(events, moment), options=options, **more)


def _events(events: Iterable[AnyEvent], at: Number) -> list[Event | Built[Event]]:
    """Events as given, those that are documents read. Raises `InputError` for their faults."""
    given = list(events)
    documents = [k for k, event in enumerate(given) if isinstance(event, Mapping)]
    if not documents:
        return [event for event in given if not isinstance(event, Mapping)]
    from irc.frontends.events import to_events

    raw = [given[k] for k in documents]
    read = iter(to_events(raw, lambda i: (documents[i],), json_number(at), None))
    return [next(read) if isinstance(event, Mapping) else event for event in given]


def simulate(
    task: AnyTask,
    *,
    schedule: Schedule | None = None,
    on_step: Callable[[Step], None] | None = None,
    options: SolveOptions | None = None,
    **more: Unpack[SolveKeywords],
) -> Simulation:
    """Simulates a task through all of its events: plans it, and repairs the plan after each.

    `schedule` is the first plan, if there is one. The options are those of `replan`, for each
    step; `on_step` is called after each step.
    """
    from irc.execution.simulation import simulate

    return simulate(ir_of(task), schedule=schedule, on_step=on_step, options=options, **more)
