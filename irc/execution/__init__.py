"""Execution: in, a task that is being carried out and what happened; out, the schedule repaired.

`Execution` holds a running task, `replan` repairs a schedule once, `simulate` goes through all of a
task's events. `irc.events.apply` revises the task itself.
"""

from __future__ import annotations

from irc.execution.execution import Execution, replan
from irc.execution.simulation import Simulation, simulate
from irc.execution.state import ExecutionState, state_at
from irc.execution.step import Step

__all__ = [
    "Execution",
    "ExecutionState",
    "Simulation",
    "Step",
    "replan",
    "simulate",
    "state_at",
]
