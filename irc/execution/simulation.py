"""Simulates a whole episode: all events of a task, in the order of their times."""

from __future__ import annotations

from collections.abc import Callable
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
from irc.model.times import json_number
from irc.schedule import Schedule
from irc.targets import SolveKeywords, SolveOptions

SIMULATION_VERSION = "1"

OnStep = Callable[[Step], None]


@dataclass(frozen=True, slots=True)
class Simulation:
    """The steps of an episode; the first one is the plan as of t = 0, before any event.

    An episode ends with its last event; without a first plan it does not begin.
    """

    task: str | None
    steps: tuple[Step, ...]

    @property
    def final(self) -> Schedule:
        """The last schedule: the whole history, where the last step has an answer."""
        return self.steps[-1].schedule

    @property
    def moved(self) -> int:
        """The number of planned occurrences that moved, over all steps."""
        return sum(step.moved for step in self.steps)

    def to_dict(self) -> dict[str, Any]:
        """The document that `irc simulate --format json` writes."""
        final = self.final
        return {
            "irc_simulation": SIMULATION_VERSION,
            "task": self.task,
            "steps": [step.to_dict() for step in self.steps],
            "final": final.to_dict(),
            "makespan": json_number(final.makespan) if final.answered else None,
            "moved": self.moved,
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
    **more: Unpack[SolveKeywords],
) -> Simulation:
    """Plans a task (or takes `schedule` as its plan) and repairs the plan after each event.

    Events of one instant are one step, in their order. A step without an answer does not end it:
    nothing new begins until a later one has an answer. The options are those of `SolveOptions`;
    limits hold for each step. Raises `EventRefused`, and what `irc.solve` and `Execution` raise,
    after it has called `on_step` for all previous steps.
    """
    chosen, task = SolveOptions.of(options, more), task_of(task)
    if schedule is None:
        answer = solve_task(task, chosen)
        schedule, notes = answer.schedule, answer.notes
    else:
        notes = ()
    steps = [Step(0, (), (), (), 0, schedule, task, notes)]
    if on_step is not None:
        on_step(steps[0])
    if not schedule.answered:
        return Simulation(task.name, tuple(steps))
    execution = Execution(task, schedule, options=chosen)
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
                raise EventRefused(report, Simulation(task.name, tuple(steps))) from None
        step = execution.replan()
        step = replace(step, notes=(*noted, *step.notes))
        steps.append(step)
        if on_step is not None:
            on_step(step)
    return Simulation(task.name, tuple(steps))


def _placed(task: Task, event: Event) -> PlacedEvent:
    """One of a task's own events with its place in the text of the task."""
    place = next(i for i, own in enumerate(task.events) if own is event)
    return PlacedEvent(event, ("events", place), task.source)


def in_order(task: Task) -> list[Event]:
    """A task's events by time; those of one instant as they are written."""
    return sorted(task.events, key=lambda event: task.number(event.at))
