"""Simulates a whole episode: all events of a task, in the order of their times."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, Unpack

from irc.diagnostics import Diagnostic, InputError, Report
from irc.driver.solve import solve_task
from irc.execution.execution import Execution
from irc.execution.rounding import Rounding
from irc.execution.step import Step
from irc.frontends.events import PlacedEvent
from irc.model import Event, Task
from irc.model.built import Built, task_of
from irc.model.quantities import Number
from irc.model.times import format_number, json_number
from irc.outcome import Outcome
from irc.schedule import Schedule, Status
from irc.targets import SolveKeywords, SolveOptions
from irc.targets.interrupt import ended_by_interrupt, lost

SIMULATION_VERSION = "1"

OnStep = Callable[[Step], None]


@dataclass(frozen=True, slots=True)
class Simulation:
    """The steps of an episode; the first one is the plan as of t = 0, before any event.

    An episode ends with its last event, or where it was `interrupted`; without a first plan it does
    not begin.
    """

    task: str | None
    steps: tuple[Step, ...]
    interrupted: bool = False

    @property
    def final(self) -> Schedule:
        """The last schedule: the whole history, where the last step has an answer."""
        return self.steps[-1].schedule

    @property
    def outcome(self) -> Outcome:
        """How the last step ended; without a plan, with the diagnostics that say why."""
        return self.steps[-1].outcome

    @property
    def moved(self) -> int:
        """The number of planned occurrences that moved, over all steps."""
        return sum(step.moved for step in self.steps)

    def _repr_html_(self) -> str:
        """A row for each step, and the last plan, for notebooks."""
        from irc.display.html import heading, table
        from irc.events.wording import changes_in_words

        rows = [
            (
                format_number(step.at),
                "; ".join(said for e in step.events for said in changes_in_words(e, step.task)),
                str(step.schedule.status),
                format_number(step.schedule.makespan) if step.schedule.answered else "",
                str(step.moved),
            )
            for step in self.steps
        ]
        unit = self.steps[-1].task.time_unit if self.steps else ""
        columns = (f"at ({unit})", "what happened", "status", f"makespan ({unit})", "moved")
        shown = heading(f"{self.task or 'task'}: {len(rows)} plans") + table(columns, rows)
        return shown + (self.final._repr_html_() if rows else "")

    def to_dict(self) -> dict[str, Any]:
        """The document that `irc simulate --format json` writes."""
        final = self.final
        return {
            "irc_simulation": SIMULATION_VERSION,
            "task": self.task,
            **({"interrupted": True} if self.interrupted else {}),
            "steps": [step.to_dict() for step in self.steps],
            "final": final.to_dict(),
            "makespan": json_number(final.makespan) if final.answered else None,
            "moved": self.moved,
            **({} if self.outcome.answered else {"outcome": self.outcome.to_dict()}),
        }


class EventRefused(InputError):
    """An event of an episode does not fit what has happened.

    `report` has what is wrong and where in the task, `simulation` all steps before it.
    """

    def __init__(self, report: Report, simulation: Simulation) -> None:
        super().__init__(report)
        self.simulation = simulation

    def __reduce__(self) -> tuple[type[EventRefused], tuple[Report, Simulation]]:
        return type(self), (self.report, self.simulation)


def simulate(
    task: Task | Built[Task],
    *,
    schedule: Schedule | None = None,
    on_step: OnStep | None = None,
    options: SolveOptions | None = None,
    spent: float = 0.0,
    **more: Unpack[SolveKeywords],
) -> Simulation:
    """Plans a task (or takes `schedule` as its plan) and repairs the plan after each event.

    Events of one instant are one step, in their order. A step without an answer does not end it:
    nothing new begins until a later one has an answer. The options are those of `SolveOptions`;
    limits hold for each step (`spent` are seconds that the first one has used already). Where it is
    cancelled, the step that is being planned is the last. Raises `EventRefused`, and what
    `irc.solve` and `Execution` raise, after it has called `on_step` for all previous steps.
    """
    chosen, task = SolveOptions.of(options, more), task_of(task)
    chosen.require_seconds_only("a simulation")
    with ended_by_interrupt(chosen.cancel) as cancel:
        options = replace(chosen, cancel=cancel)
        steps: list[Step] = []
        for step in _steps(task, schedule, options, spent, steps):
            steps.append(step)
            if on_step is not None:
                on_step(step)
            if cancel is not None:
                cancel.keep()
                if cancel.is_cancelled:
                    break
        if len(steps) == 1 and steps[0].schedule.status is Status.UNKNOWN:
            lost(cancel)
        planned = schedule is None or len(steps) > 1
        rounding = Rounding.of(task)
        instants = {rounding.time(task.number(event.at)) for event in task.events}
        done = len(steps) > len(instants)
        ended = cancel is not None and cancel.is_cancelled
        partial = not done or (planned and steps[-1].schedule.interrupted)
        return Simulation(task.name, tuple(steps), ended and partial)


def _steps(
    task: Task,
    schedule: Schedule | None,
    options: SolveOptions,
    spent: float,
    before: Sequence[Step],
) -> Iterator[Step]:
    """The first plan, and the step of each instant with events; `before` are the previous ones."""
    notes: tuple[Diagnostic, ...] = ()
    if schedule is None:
        answer = solve_task(task, options, options.budget(spent))
        schedule, notes, spent = answer.schedule, answer.notes, 0.0
    yield Step(0, (), (), (), 0, schedule, task, notes)
    if not schedule.answered:
        return
    execution = Execution(task, schedule, options=options)
    rounding = Rounding.of(task)

    def moment(event: Event) -> Number:
        return rounding.time(task.number(event.at))

    for _, same in groupby(in_order(task), key=moment):
        noted: list[Diagnostic] = []
        for event in same:
            try:
                noted += _placed(task, event).notes(execution.apply(event))
            except InputError as error:
                report = _placed(task, event).anchored(error.report)
                raise EventRefused(report, Simulation(task.name, tuple(before))) from None
        step = execution.replan(options.budget(spent))
        spent = 0.0
        yield replace(step, notes=(*noted, *step.notes))


def _placed(task: Task, event: Event) -> PlacedEvent:
    """One of a task's own events with its place in the text of the task."""
    place = next(i for i, own in enumerate(task.events) if own is event)
    return PlacedEvent(event, ("events", place), task.source)


def in_order(task: Task) -> list[Event]:
    """A task's events by time; those of one instant as they are written."""
    return sorted(task.events, key=lambda event: task.number(event.at))
