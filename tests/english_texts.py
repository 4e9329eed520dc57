"""What tests of controlled English compare: order, durations and the first error, in short."""

from __future__ import annotations

import irc
from irc.diagnostics import InputError
from irc.model import DurationRange, Task
from irc.model.base import write_time

_SIGNS = {
    "finish-start": ">",
    "start-start": "s>s",
    "finish-finish": "e>e",
    "start-finish": "s>e",
}


def order(task: Task) -> str:
    """The order, shared resources and deadline of a task: "1>2 1>3+5 min | deadline 1 hour"."""
    told = []
    for p in task.precedence:
        least = "" if p.min_lag == 0 else f"+{write_time(p.min_lag)}"
        most = "" if p.max_lag is None else f"..{write_time(p.max_lag)}"
        told.append(f"{p.before[4:]}{_SIGNS[p.type]}{p.after[4:]}{least}{most}")
    parts = [" ".join(told)]
    if task.resources:
        parts.append(" ".join(_shared(task, r.id, r.capacity) for r in task.resources))
    if task.deadline is not None:
        parts.append(f"deadline {write_time(task.deadline)}")
    return " | ".join(parts)


def _shared(task: Task, resource: str, capacity: int) -> str:
    users = [a.id[4:] for a in task.actions if any(u.resource == resource for u in a.uses)]
    return f"{resource}:{capacity}={','.join(users)}"


def durations(task: Task) -> str:
    """Each step with the beginning of its text and its duration: "1:Boil water=5 min"."""
    told = []
    for action in task.actions:
        time = action.duration
        if isinstance(time, DurationRange):
            length = f"{write_time(time.min)}..{write_time(time.max)}"
        else:
            length = str(write_time(time))
        told.append(f"{action.id[4:]}:{(action.label or '')[:30]}={length}")
    return "; ".join(told)


def first_error(text: str) -> tuple[str, int | None, int | None]:
    """Code, line and column of the first error that a text is told."""
    try:
        task = irc.loads(text).ir
    except InputError as error:
        first = error.report.located().diagnostics[0]
        return first.code.id, first.line, first.column
    return f"read as {order(task)}", None, None
