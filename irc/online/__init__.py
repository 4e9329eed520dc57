"""Online: events revise a task while it runs (docs/semantics.md, "While a task runs").

`apply` revises a task by one event, `check_event` says what is wrong with an event for a task;
`Execution` holds a task that is being carried out, `replan` repairs a schedule once, `simulate`
goes through all of a task's events.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from irc.online.checking import check_event
from irc.online.revision import apply

if TYPE_CHECKING:
    from irc.online.execution import Execution, replan
    from irc.online.simulation import Simulation, simulate
    from irc.online.state import ExecutionState, state_at
    from irc.online.step import Step

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
    "Execution": "irc.online.execution",
    "replan": "irc.online.execution",
    "Step": "irc.online.step",
    "Simulation": "irc.online.simulation",
    "simulate": "irc.online.simulation",
    "ExecutionState": "irc.online.state",
    "state_at": "irc.online.state",
}
"""Loaded when asked for: checks need `apply` alone."""


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_LATER[name]), name)
