"""Simulates a whole episode: all events of a task, in the order of their times."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, Unpack

from irc.diagnostics.source import Pointer
from irc.driver.compile import placed
from irc.driver.solve import solve_task
from irc.execution.execution import Execution
from irc.execution.rounding import Rounding
from irc.execution.step import Step
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

    An episode ends with its last event, or with the first step that has no answer.
    """

    task: str | None
    steps: tuple[Step, ...]

    @property
    def final(self) -> Schedule:
        """The last schedule: the whole history, where every step had an answer."""
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


def simulate(
    task: Task | Built[Task],
    *,
    schedule: Schedule | None = None,
    on_step: OnStep | None = None,
    options: SolveOptions | None = None,
    **more: Unpack[SolveKeywords],
) -> Simulation:
    """Plans a task (or takes `schedule` as its plan) and repairs the plan after each event.

    Events of one instant are one step, in their order. The options are those of `SolveOptions`;
    limits hold for each step. Raises what `irc.solve` and `Execution` raise, after it has called
    `on_step` for all previous steps.
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
        noted = [
            placed(replace(note, pointer=(*_place(task, event), *note.pointer)), task)
            for event in same
            for note in execution.apply(event)
        ]
        step = execution.replan()
        step = replace(step, notes=(*noted, *step.notes))
        steps.append(step)
        if on_step is not None:
            on_step(step)
        if not step.schedule.answered:
            break
    return Simulation(task.name, tuple(steps))


def _place(task: Task, event: Event) -> Pointer:
    return "events", task.events.index(event)


def in_order(task: Task) -> list[Event]:
    """A task's events by time; those of one instant as they are written."""
    return sorted(task.events, key=lambda event: task.number(event.at))
