"""`Execution`: a task that is being carried out, live or in a simulation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Unpack

from irc.checks.events import check_event
from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.events.apply import apply
from irc.execution.history import History
from irc.execution.replanning import solve_step
from irc.execution.state import ExecutionState
from irc.execution.step import Step
from irc.model import Event, Task
from irc.model.built import Built, event_of, task_of
from irc.model.quantities import Number
from irc.model.times import Instant, format_number, parse_instant
from irc.schedule import Schedule
from irc.targets import Budget, Cancellation, SolveKeywords, SolveOptions


class Execution:
    """A task in force, the schedule that is being carried out, and the time.

    The options are those of `irc.SolveOptions`, for each replanning. Not for several threads at
    once.

    >>> import irc
    >>> task = irc.Task()
    >>> van = task.resource("van")
    >>> a, b = task.action("a", 10).uses(van), task.action("b", 10).uses(van)
    >>> run = Execution(task, irc.solve(task))
    >>> run.apply(irc.Event(4).set_duration(a, 12)).ok
    True
    >>> run.replan().schedule.makespan
    22
    """

    def __init__(
        self,
        task: Task | Built[Task],
        schedule: Schedule,
        at: Number = 0,
        *,
        options: SolveOptions | None = None,
        **more: Unpack[SolveKeywords],
    ) -> None:
        """Starts at `at`. Raises `InputError` where the schedule names what the task lacks."""
        self.task = task_of(task)
        _require_known(self.task, schedule)
        self.now: Number = at
        self.options = SolveOptions.of(options, more)
        self._schedule = schedule
        self._history = History.of(schedule)
        self._events: list[Event] = []

    def copy(self) -> Execution:
        """A copy at the same point; later changes of one do not affect the other."""
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__)
        other._history = self._history.copy()
        other._events = list(self._events)
        return other

    __copy__ = copy

    def __eq__(self, other: object) -> bool:
        """Whether both are at the same point of the same task, with the same options."""
        return self.__dict__ == other.__dict__ if isinstance(other, Execution) else NotImplemented

    @property
    def schedule(self) -> Schedule:
        """The schedule in force, with observed times in place of planned ones.

        After an event it is out of date until `replan`.
        """
        if not self._events:
            return self._schedule
        entries = sorted(self._history.entries.values(), key=lambda e: (e.start, e.end, e.id))
        return Schedule(tuple(entries), task=self.task.name)

    @property
    def pending(self) -> tuple[Event, ...]:
        """The events since the last plan."""
        return tuple(self._events)

    def state(self) -> ExecutionState:
        """The entries that are completed, running and open now."""
        return self._history.state(self.now)

    def advance(self, to: Instant) -> None:
        """Advances the time. Raises `InputError` for a time that has passed already."""
        time = self.task.number(parse_instant(to))
        if time < self.now:
            raise _in_the_past(
                "the time to advance to is", time, self.now, self.task.time_unit, ("to",), None
            )
        self.now = time

    def observe(
        self,
        action: str,
        *,
        started: Instant | None = None,
        finished: Instant | None = None,
        occurrence: int = 1,
    ) -> Report:
        """Applies an `observe` event: what really happened, as of now. Raises `InputError`."""
        seen = {"started": started, "finished": finished}
        change = {
            "op": "observe",
            "action": action,
            "occurrence": occurrence,
            **{k: v for k, v in seen.items() if v is not None},
        }
        return self.apply(Event.model_validate({"at": self.now, "changes": [change]}))

    def apply(self, event: Event | Built[Event], *, source: Source | None = None) -> Report:
        """Revises the task by an event, now or later: the time advances to the event.

        Raises `InputError` where the event has a fault, and then applies nothing of it; `source`
        is the text that it was read from. The plan is repaired only by `replan`.
        """
        event = event_of(event)
        report = check_event(self.task, event, source=source)
        if not report.ok:
            raise InputError(report)
        at = self.task.number(event.at)
        if at < self.now:
            raise _in_the_past(
                "the event is at", at, self.now, self.task.time_unit, ("at",), source
            )
        history, findings = self._history.copy(), Findings()
        history.take(self.task, event, findings)
        if findings.items:
            raise InputError(Report(tuple(findings.items), source))
        self.task = apply(self.task, event, self._history.starts(at), source=source)
        self.now = at
        self._history = history
        self._events.append(event)
        return report

    def replan(self, budget: Budget | None = None) -> Step:
        """Repairs the schedule for all events since the last plan, as of now.

        Where no continuation exists the step reports it, and the previous schedule stays. `budget`
        replaces the time limit and the cancellation of the options. Raises `InputError`,
        `irc.targets.UnknownTarget`, `EngineMissing` or `EngineFailed`, and `KeyboardInterrupt`
        where ^C comes before there is any answer.
        """
        events = tuple(self._events)
        step = solve_step(self.task, self._history, self.now, self.options, events, budget)
        if step.schedule.answered:
            self.adopt(step.schedule)
        return step

    async def areplan(self) -> Step:
        """`replan` for `async` code: the execution must not be changed meanwhile.

        If the task that awaits it is cancelled, the engine ends, and the plan stays as it was.
        """
        from irc.driver.running import awaited

        task, history, at, events = self.task, self._history, self.now, tuple(self._events)

        def call(cancel: Cancellation) -> Step:
            return solve_step(task, history, at, replace(self.options, cancel=cancel), events)

        step = await awaited(call, self.options.cancel)
        if step.schedule.answered:
            self.adopt(step.schedule)
        return step

    def adopt(self, schedule: Schedule) -> None:
        """Sets the schedule that is carried out from now on, such as that of a step."""
        _require_known(self.task, schedule)
        entries = {(e.id, e.occurrence): e for e in schedule.entries}
        self._history.entries, self._history.plan = entries, dict(entries)
        self._schedule = schedule
        self._events.clear()


def replan(
    task: Task | Built[Task],
    schedule: Schedule,
    at: Number,
    events: Iterable[Event | Built[Event]] = (),
    *,
    options: SolveOptions | None = None,
    **more: Unpack[SolveKeywords],
) -> Step:
    """Repairs the schedule of a running task at `at`, after events of that instant.

    Raises what `Execution.apply` and `Execution.replan` raise.
    """
    execution = Execution(task, schedule, at, options=options, **more)
    for event in events:
        execution.apply(event)
    return execution.replan()


def _require_known(task: Task, schedule: Schedule) -> None:
    """Checks that a schedule names only actions of its task, each occurrence once."""
    known = {action.id for action in task.actions}
    findings = Findings()
    seen: set[tuple[str, int]] = set()
    for k, entry in enumerate(schedule.entries):
        if entry.id not in known:
            message = f"the schedule has {entry.id!r}, which the task does not have"
            hint = "give the schedule of this task, and the task as revised by earlier events"
            findings.add(Code.BAD_SCHEDULE, message, ("actions", k, "id"), hint=hint)
        elif (entry.id, entry.occurrence) in seen:
            message = f"the schedule has two entries of {entry.id!r} with the same occurrence"
            hint = 'number the occurrences of an action that repeats: "occurrence": 2'
            findings.add(Code.BAD_SCHEDULE, message, ("actions", k), hint=hint)
        seen.add((entry.id, entry.occurrence))
    if findings.items:
        raise InputError(Report(tuple(findings.items)))


def _in_the_past(
    what: str,
    time: Number,
    now: Number,
    unit: str,
    pointer: tuple[str, ...],
    source: Source | None,
) -> InputError:
    findings = Findings()
    findings.add(
        Code.EVENT_TIME,
        f"{what} {format_number(time)} {unit}, but it is {format_number(now)} {unit} already",
        pointer,
        hint="give events in the order of their times; the past cannot be changed",
    )
    return InputError(Report(tuple(findings.items), source))
