"""Online: events revise a task while it runs (design: "Online").

`apply` revises a task by one event, `check_event` says what is wrong with an event for a task;
`Execution` holds a task that is being carried out, `replan` repairs a schedule once, `simulate`
goes through all of a task's events.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from irc.checks.events import check_event
from irc.events.apply import apply

if TYPE_CHECKING:
    from irc.execution.execution import Execution, replan
    from irc.execution.simulation import Simulation, simulate
    from irc.execution.state import ExecutionState, state_at
    from irc.execution.step import Step

__all__ = [
    "Execution",
    "ExecutionState",
    "Simulation",
    "Step",
    "apply",
    "check_event",
    "replan",
    "simulate",
    "state_at",
]

_LATER = {
    "Execution": "irc.execution.execution",
    "replan": "irc.execution.execution",
    "Step": "irc.execution.step",
    "Simulation": "irc.execution.simulation",
    "simulate": "irc.execution.simulation",
    "ExecutionState": "irc.execution.state",
    "state_at": "irc.execution.state",
}
"""Loaded when asked for: checks need `apply` alone."""


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_LATER[name]), name)
