"""Events in words: a line for people on each change."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from irc.diagnostics.listing import and_more
from irc.model import Event, Task
from irc.model.base import write_time
from irc.model.events import (
    AddActions,
    AddGroups,
    AddPrecedence,
    AddResources,
    AddState,
    CancelActions,
    CancelGroups,
    Observe,
    RemovePrecedence,
    RetryAction,
    SetCapacity,
    SetDeadline,
    SetDuration,
    SetGoals,
    SetObjective,
    SetRelease,
    SetState,
)
from irc.model.state_values import value_text
from irc.model.times import Clock, Instant, format_number

NAMES_SHOWN = 8
"""Longer lists end in "and N more"."""


@dataclass(frozen=True)
class _Unit:
    """The name of a task's time unit, and the task's clock."""

    name: str
    clock: Clock


def changes_in_words(event: Event, task: Task) -> Iterator[str]:
    """The lines on the changes of an event of a task."""
    unit = _Unit(task.time_unit, task.clock)
    for change in event.changes:
        yield _WORDS[type(change)](change, unit)


def listed(names: Iterable[str]) -> str:
    """ "a, b, c and 7 more"."""
    found = list(names)
    return and_more(found[:NAMES_SHOWN], len(found))


def _time(value: Any, unit: _Unit) -> str:
    """The text of a time as it was written, with the task's unit if it has no unit."""
    if isinstance(value, (int, Fraction)):
        return f"{format_number(value)} {unit.name}"
    if isinstance(value, datetime):
        return f"{value.isoformat()} ({format_number(unit.clock.number(value))} {unit.name})"
    return str(write_time(value))


def _duration(value: Any, unit: _Unit) -> str:
    if hasattr(value, "min"):
        return f"from {_time(value.min, unit)} to {_time(value.max, unit)}"
    return _time(value, unit)


def _ids(elements: Iterable[Any]) -> str:
    return listed(element.id for element in elements)


def _set_capacity(change: SetCapacity, unit: _Unit) -> str:
    begin = "" if change.from_ is None else f" from {_time(change.from_, unit)}"
    end = "" if change.to is None else f" until {_time(change.to, unit)}"
    return f"{change.resource} has a capacity of {change.capacity}{begin}{end}"


def _set_deadline(change: SetDeadline, unit: _Unit) -> str:
    of = change.action or change.group
    whose = "the deadline" if of is None else f"the deadline of {of}"
    return f"{whose} is {'removed' if change.deadline is None else _time(change.deadline, unit)}"


def _add_groups(change: AddGroups, _unit: _Unit) -> str:
    groups = [f"{group.id} ({listed(group.actions)})" for group in change.groups]
    return f"new group{'s' if len(groups) > 1 else ''}: {listed(groups)}"


def _set_goals(change: SetGoals, _unit: _Unit) -> str:
    goals = [g if isinstance(g, str) else f"{g.var} = {value_text(g.value)}" for g in change.goals]
    return f"the goals are now {listed(goals)}" if goals else "there are no goals any more"


def _pairs(edges: Iterable[Any]) -> str:
    return listed(f"{edge.before} before {edge.after}" for edge in edges)


def _observe(change: Observe, unit: _Unit) -> str:
    happened: list[tuple[str, Instant | None]] = [
        ("started", change.started),
        ("finished", change.finished),
    ]
    said = [f"{what} at {_time(when, unit)}" for what, when in happened if when is not None]
    status = change.status
    if status == "failed" and change.finished is not None:
        said[-1] = f"failed at {_time(change.finished, unit)}"
    elif status is not None and not (status == "finished" and change.finished is not None):
        said.insert(0, _STATUSES[status])
    if change.expected_end is not None:
        said.append(f"is expected to end at {_time(change.expected_end, unit)}")
    if change.mode is not None:
        said.append(f"is done as {change.mode}")
    if change.resources:
        said.append(f"is done by {listed(change.resources)}")
    return f"{change.action} {' and '.join(said)}"


_STATUSES = {
    "not_begun": "has not begun",
    "running": "is still running",
    "finished": "has finished",
    "failed": "has failed",
}


def _retry_action(change: RetryAction, unit: _Unit) -> str:
    name = "" if change.id is None else f", as {change.id}"
    done = f", but for {_time(change.done, unit)} that are done" if change.done != 0 else ""
    return f"again: {change.action}{name}{done}"


_WORDS: Mapping[type, Callable[[Any, _Unit], str]] = MappingProxyType(
    {
        AddActions: lambda change, _: f"new: {_ids(change.actions)}",
        CancelActions: lambda change, _: f"cancelled: {listed(change.actions)}",
        RetryAction: _retry_action,
        SetDuration: lambda change, unit: (
            f"{change.action} takes {_duration(change.duration, unit)}"
        ),
        AddPrecedence: lambda change, _: f"new order: {_pairs(change.precedence)}",
        RemovePrecedence: lambda change, _: f"no longer: {_pairs(change.precedence)}",
        AddResources: lambda change, _: f"new resources: {_ids(change.resources)}",
        SetCapacity: _set_capacity,
        SetDeadline: _set_deadline,
        SetRelease: lambda change, unit: (
            f"{change.action} may start from {_time(change.release, unit)} on"
        ),
        AddGroups: _add_groups,
        CancelGroups: lambda change, _: f"cancelled groups: {listed(change.groups)}",
        SetGoals: _set_goals,
        SetState: lambda change, _: f"{change.var} has become {value_text(change.value)}",
        AddState: lambda change, _: f"new state variables: {_ids(change.state)}",
        SetObjective: lambda change, _: (
            f"the objective is now {', then '.join(change.objective).replace('_', ' ')}"
        ),
        Observe: _observe,
    }
)
