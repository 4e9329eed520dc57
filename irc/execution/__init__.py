"""Execution: in, a running task, its schedule and its events; out, the repaired schedule.

`Execution` holds a running task, `replan` repairs a schedule once, and `simulate` runs through all
events of a task. `irc.events.apply` revises the task itself.
"""

from __future__ import annotations

from irc.execution.execution import Execution, replan
from irc.execution.simulation import EventRefused, Simulation, simulate
from irc.execution.state import ExecutionState, state_at
from irc.execution.step import Step

__all__ = [
    "EventRefused",
    "Execution",
    "ExecutionState",
    "Simulation",
    "Step",
    "replan",
    "simulate",
    "state_at",
]
