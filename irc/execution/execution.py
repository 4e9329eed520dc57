"""`Execution`: a task that is being carried out, live or in a simulation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeVar, Unpack, get_args

from irc.checks.events import check_event
from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.errors import OptionError
from irc.events.apply import with_observations, without_observations
from irc.execution.follow import follow, is_observation
from irc.execution.found_ranks import with_found_ranks
from irc.execution.history import History
from irc.execution.interruption import breaks_off, lapses, with_repetitions, without_the_past
from irc.execution.plannable import Plannable
from irc.execution.presumed import adopt, as_of, not_as_planned, outcomes
from irc.execution.replanning import solve_step
from irc.execution.rounding import Rounding
from irc.execution.state import ExecutionState
from irc.execution.step import Step
from irc.model import Event, Task
from irc.model.built import Built, event_of, task_of
from irc.model.events import ObservedStatus, SetCapacity
from irc.model.garbage import without_garbage
from irc.model.quantities import Number
from irc.model.times import Instant, format_number, parse_instant
from irc.schedule import Entry, Schedule
from irc.targets import Budget, Cancellation, SolveKeywords, SolveOptions

_T = TypeVar("_T")

Presume = Literal["assume", "confirm"]
"""The facts of a running task: the plan as well, or only observations."""


class Execution:
    """A task in force, the schedule that is being carried out, and the time.

    The options are those of `irc.SolveOptions`, for each replanning. Times that come in are rounded
    to the task's resolution; the first report or step after that says so. Not for several threads
    at once.

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
        presume: Presume = "assume",
        options: SolveOptions | None = None,
        **more: Unpack[SolveKeywords],
    ) -> None:
        """Starts at `at`, until when the schedule has been carried out.

        With `presume="confirm"` nothing begins or ends from then on until it is observed; with
        `"assume"` the plan is taken to happen unless something else is observed. Raises
        `InputError` where the schedule names what the task lacks.
        """
        self._told = task_of(task)
        _require_known(self._told, schedule)
        if presume not in (known := get_args(Presume)):
            raise OptionError(f"presume is one of {', '.join(known)}, not {presume!r}")
        self._notes: tuple[Diagnostic, ...] = ()
        self._rounding = Rounding.of(self._told)
        schedule = self._take(self._rounding.schedule(self._told, schedule))
        schedule = with_found_ranks(self._told, schedule)
        now = self._told.clock.exact(parse_instant(at))
        moment = self._rounding.moment(self._told, now, "the present, ", ("at",))
        self.now: Number = self._take(moment)
        self.options = SolveOptions.of(options, more)
        self.options.require_seconds_only("an execution")
        self._plannable = Plannable(self.options.target)
        self._task: Task | None = self._told
        self._schedule = schedule
        clock = self._told.clock
        starts = {a.id: clock.number(a.start) for a in self._told.actions if a.start is not None}
        assumes = presume == "assume"
        self._history = History.of(schedule, self.now, assumes=assumes, starts=starts)
        self._events: list[Event] = []
        self._known: _Facts | None = None

    def copy(self) -> Execution:
        """A copy at the same point; later changes of one do not affect the other."""
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__)
        other._history = self._history.copy()
        other._events, other._known = list(self._events), None
        return other

    __copy__ = copy

    def __eq__(self, other: object) -> bool:
        """Whether both are at the same point of the same task, with the same options."""
        if not isinstance(other, Execution):
            return NotImplemented
        follows = {"_task": None, "_known": None}
        return {**self.__dict__, **follows} == {**other.__dict__, **follows}

    @property
    def task(self) -> Task:
        """The task in force: as the events have revised it, with all that was observed."""
        if self._task is None:
            self._task = self._in_force(self._told, self._facts(), self.now)
        return self._task

    @property
    def unobserved(self) -> Task:
        """The task as the events have revised it, without what was observed."""
        return self._told

    @property
    def schedule(self) -> Schedule:
        """The schedule in force, with observed times in place of planned ones.

        After an event it is out of date until `replan`.
        """
        if not self._events:
            return self._schedule
        taken = self._facts().entries.values()
        entries = sorted(taken, key=lambda e: (e.start, e.end, e.id))
        return Schedule(tuple(entries), task=self._told.name).of(self._told)

    @property
    def pending(self) -> tuple[Event, ...]:
        """The events since the last plan."""
        return tuple(self._events)

    @property
    def presume(self) -> Presume:
        """Whether the plan is presumed to happen, or only observations count."""
        return "assume" if self._history.assumes else "confirm"

    @property
    def replan_needed(self) -> bool:
        """Whether the plan is out of date: an event came in, or what should have begun has not."""
        if self._events or self._history.held is not None:
            return True
        state = self.state()
        return any(entry.start < self.now for entry in state.open)

    def state(self) -> ExecutionState:
        """The entries that are completed, running and open now."""
        return self._facts().state(self.now)

    def _facts(self) -> History:
        """The history with all that is taken to have happened by now."""
        known = self._known
        if known is None or not known.are_of(self._history, self._told, self.now):
            taken = as_of(self._history, self._told, self.now)
            known = self._known = _Facts(self._history, self._told, self.now, taken)
        return known.taken

    def advance(self, to: Instant) -> None:
        """Advances the time. Raises `InputError` for a time that has passed already, and for one
        with which the target cannot plan.
        """
        exact = self._told.clock.exact(parse_instant(to))
        time, rounding, notes = self._rounding.moment(self._told, exact, "the present, ", ("to",))
        if time < self.now:
            raise _in_the_past(
                "the time to advance to is", time, self.now, self._told.time_unit, ("to",), None
            )
        self._plannable = self._after(self._told, Event(at=time), self._history, None)
        if time > self.now:
            self.now, self._task = time, None
        self._rounding = rounding
        self._notes += notes

    def observe(
        self,
        action: str,
        *,
        started: Instant | None = None,
        finished: Instant | None = None,
        status: ObservedStatus | None = None,
        expected_end: Instant | None = None,
        mode: str | None = None,
        resources: Iterable[str] = (),
        occurrence: int = 1,
        at: Instant | None = None,
    ) -> Report:
        """Applies an `observe` event: what really happened, as of now or of `at`.

        An observation may come in late: `at` is when it was made. Returns notes, such as which of
        two observations counts. Raises `InputError`.
        """
        said: dict[str, Any] = {
            "status": status,
            "started": started,
            "finished": finished,
            "expected_end": expected_end,
            "mode": mode,
            "resources": list(resources) or None,
        }
        change = {
            "op": "observe",
            "action": action,
            "occurrence": occurrence,
            **{k: v for k, v in said.items() if v is not None},
        }
        when = self.now if at is None else at
        return self.apply(Event.model_validate({"at": when, "changes": [change]}))

    @without_garbage()
    def apply(self, event: Event | Built[Event], *, source: Source | None = None) -> Report:
        """Revises the task by an event, now or later: the time advances to the event.

        An event that only observes may also be of a time that has passed. Raises `InputError`
        where the event has a fault, and then applies nothing of it; `source` is the text that it
        was read from. The plan is repaired only by `replan`.
        """
        given = event_of(event)
        event, rounding, rounded = self._rounding.event(self._told, given)
        only_seen = is_observation(event)
        # (What was observed before changes nothing for a further observation: it is not looked up.)
        report = check_event(self._told if only_seen else self.task, event, source=source)
        if not report.ok:
            raise InputError(report)
        at = self._told.number(event.at)
        if at < self.now and not only_seen:
            raise _in_the_past(
                "the event is at", at, self.now, self._told.time_unit, ("at",), source
            )
        event = self._with_repetitions(event)
        history, findings, now = self._history.copy(), Findings(), max(self.now, at)
        notes = follow(history, self._told, event, findings, now)
        if findings.items:
            raise InputError(Report(tuple(findings.items), source))
        revised = without_observations(_with_own(self._told, given, event), event)
        task: Task | None = None
        known: _Facts | None = None
        if only_seen and not _reports_failure(event):
            self._plannable = self._after(revised, event, history, source)
        else:
            judged, taken = revised, as_of(history, revised, now)
            revised, passed = without_the_past(self._told, revised, taken.state(now))
            task = self._in_force(revised, taken, now)
            if revised is judged:
                known = _Facts(history, revised, now, taken, task)
            self._plannable = self._after(task, event, history, source)
            if task.lapsed != self.task.lapsed:
                ended = {entry.id for entry in taken.state(now).completed}
                notes = [*notes, *lapses(self.task, task, event, ended), *passed]
        self._told, self._task, self._history, self.now = revised, task, history, now
        self._known = known
        self._rounding = rounding
        self._events.append(event)
        return Report((*report.diagnostics, *self.take_notes(), *rounded, *notes), source)

    def _with_repetitions(self, event: Event) -> Event:
        """The event, with what runs on a resource that it breaks done again."""
        if not any(isinstance(change, SetCapacity) for change in event.changes):
            return event
        if not any(map(breaks_off, self._told.actions)):
            return event
        at = self._told.number(event.at)
        state = as_of(self._history, self._told, at).state(at)
        return with_repetitions(event, self.task, state.running)

    def take_notes(self) -> tuple[Diagnostic, ...]:
        """The notes on what came in since the last report or step; each is given once."""
        notes, self._notes = self._notes, ()
        return notes

    def _take(self, taken: tuple[_T, Rounding, tuple[Diagnostic, ...]]) -> _T:
        """Returns a value after rounding, and keeps the note on it."""
        value, self._rounding, notes = taken
        self._notes += notes
        return value

    def _after(
        self, task: Task, event: Event, history: History, source: Source | None
    ) -> Plannable:
        """Raises `InputError` where the target could not plan with the task, after an event."""
        times = (t for entry in history.entries.values() for t in (entry.start, entry.end))
        return self._plannable.after(task, event, times, source)

    def _in_force(self, revised: Task, history: History, now: Number) -> Task:
        """The task with all that is taken to have happened by now."""
        return with_observations(revised, outcomes(history, revised, now))

    def replan(self, budget: Budget | None = None, *, since: Budget | None = None) -> Step:
        """Repairs the schedule for all events since the last plan, as of now.

        Where no continuation exists the step reports it, and nothing that was still to begin is
        presumed any more. `budget` replaces the time limit and the cancellation of the options; the
        time limit counts from now, or from when the budget `since` was made.
        Raises `InputError`, `irc.targets.UnknownTarget`, `EngineMissing` or `EngineFailed`, and
        `KeyboardInterrupt` where ^C comes before there is any answer.
        """
        since = since or Budget()
        present = task, history = self._present()
        events = tuple(self._events)
        known = self._plannable.problem
        step = solve_step(
            task, history, self.now, self.options, events, budget, since=since, known=known
        )
        return self._taken(present, step)

    async def areplan(self) -> Step:
        """`replan` for `async` code: the execution must not be changed meanwhile.

        If the task that awaits it is cancelled, the engine ends, and the plan stays as it was.
        """
        from irc.driver.running import awaited

        since = Budget()
        present = task, history = self._present()
        at, events, known = self.now, tuple(self._events), self._plannable.problem

        def call(cancel: Cancellation) -> Step:
            options = replace(self.options, cancel=cancel)
            return solve_step(task, history, at, options, events, since=since, known=known)

        return self._taken(present, await awaited(call, self.options.cancel))

    def _present(self) -> tuple[Task, History]:
        """The task and the history with all that is taken to have happened by now."""
        history, known = self._facts(), self._known
        if known is not None and known.in_force is not None:
            return known.in_force, history
        return self._in_force(self._told, history, self.now), history

    def _taken(self, present: tuple[Task, History], step: Step) -> Step:
        """The step, after it has changed the execution: its plan is adopted or rejected."""
        task, history = present
        late = [self._late(entry) for entry in not_as_planned(history, self.now)]
        step = replace(step, notes=(*late, *step.notes))
        self._task = task
        if step.schedule.answered:
            self.adopt(step.schedule)
        else:
            self.reject()
        return replace(step, notes=(*self.take_notes(), *step.notes))

    def _late(self, entry: Entry) -> Diagnostic:
        start = f"{format_number(entry.start)} {self._told.time_unit}"
        return Diagnostic(
            Code.NOT_AS_PLANNED,
            f"{entry.id!r} was to begin at {start} and cannot have, by what is known: it is taken "
            "not to have begun",
            hint="if it has, observe when it started",
        )

    def adopt(self, schedule: Schedule) -> None:
        """Sets the schedule that is carried out from now on, such as that of a step."""
        _require_known(self._told, schedule)
        adopt(self._history, schedule, self.now, self._facts().begun)
        self._known = None
        self._schedule = schedule
        self._events.clear()

    def reject(self) -> None:
        """Takes note that a step has no schedule: from now on nothing is presumed to begin."""
        self._history.reject(self.now)
        self._known = None


@dataclass(frozen=True, slots=True)
class _Facts:
    """A history as it is taken to be at `now` (`taken`), and the task in force, where it is known.

    They hold for this very history, until a plan changes it, and for this `task`, which is without
    observations.
    """

    history: History
    task: Task
    now: Number
    taken: History
    in_force: Task | None = None

    def are_of(self, history: History, task: Task, now: Number) -> bool:
        """Whether these are the facts of a history, a task and a time."""
        return self.history is history and self.task is task and self.now == now


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
    noted = [note for event in events for note in execution.apply(event)]
    step = execution.replan()
    return replace(step, notes=(*noted, *step.notes))


def _reports_failure(event: Event) -> bool:
    """Whether an action is observed to have failed, so that something may lapse."""
    return any(getattr(change, "status", None) == "failed" for change in event.changes)


def _with_own(task: Task, given: Event, rounded: Event) -> Task:
    """The task in which its own event `given` is the rounded one that is applied."""
    if rounded is given or given not in task.events:
        return task
    place = task.events.index(given)
    events = (*task.events[:place], rounded, *task.events[place + 1 :])
    return task.model_copy(update={"events": events})


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
