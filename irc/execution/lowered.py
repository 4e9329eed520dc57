"""A task as a problem, lowered once for all that asks about it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from irc.lowering.lower import lower
from irc.model import Task
from irc.model.quantities import Number
from irc.problem import Problem


@dataclass(frozen=True, slots=True)
class Lowered:
    """The problem of a task, in a tick that also divides the `instants`, in the task's unit."""

    task: Task
    instants: frozenset[Number]
    problem: Problem


def lowered(task: Task, instants: Iterable[Number], known: Lowered | None = None) -> Lowered:
    """The problem of a task; the `known` one where it is of this task and of these instants."""
    wanted = frozenset(instants)
    if known is not None and known.task is task and known.instants == wanted:
        return known
    return Lowered(task, wanted, lower(task, wanted))
