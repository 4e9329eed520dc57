"""Small running tasks for tests: documents, plans and events in few words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from irc.execution import replan
from irc.execution.freeze import FrozenProblem, freeze
from irc.execution.history import History
from irc.execution.presumed import as_of
from irc.execution.step import Step
from irc.lowering.lower import lower
from irc.model import Event, Task
from irc.model.quantities import Number
from irc.passes.contention import merge_pools
from irc.schedule import Entry, Schedule
from irc.targets import SolveOptions

OPTIONS = SolveOptions(time_limit=20, workers=1)


def action(name: str, duration: Any, *resources: str, **fields: Any) -> dict[str, Any]:
    """An action that holds one unit of each of the resources; "a|b" is one of them."""
    uses = [{"one_of": r.split("|")} if "|" in r else {"resource": r} for r in resources]
    return {"id": name, "duration": duration, **({"uses": uses} if uses else {}), **fields}


def event(at: Any, *changes: dict[str, Any]) -> Event:
    return Event.model_validate({"at": at, "changes": list(changes)})


def plan(*entries: Entry) -> Schedule:
    return Schedule(entries)


def entry(name: str, start: Any, end: Any, *resources: str, **fields: Any) -> Entry:
    return Entry(name, start, end, dict.fromkeys(resources, 1), **fields)


def repaired(
    whole: Task, schedule: Schedule, at: Number, *changes: dict[str, Any], **means: Any
) -> Step:
    """The step after one event (or none) at a time."""
    events = [event(at, *changes)] if changes else []
    return replan(whole, schedule, at, events, **{"options": OPTIONS, **means})


def replanned(task: Task, schedule: Schedule, at: Number, events: Sequence[Event]) -> Step:
    """The step after events: what `oracles.online_random.play` asks for."""
    return replan(task, schedule, at, events, options=OPTIONS)


def starts(schedule: Schedule) -> dict[str, Number]:
    return {e.id: e.start for e in schedule.entries}


def carried(step: Step) -> list[str]:
    return [note.message for note in step.notes]


def frozen_at(whole: Task, entries: Sequence[Entry], at: Number) -> FrozenProblem:
    """The frozen problem of a task and a plan, without events."""
    instants = [at, *(t for e in entries for t in (e.start, e.end))]
    problem = merge_pools(lower(whole, instants))
    history = as_of(History.of(Schedule(tuple(entries)), at), whole, at)
    return freeze(problem, history, at, problem.whole_ticks(at))
