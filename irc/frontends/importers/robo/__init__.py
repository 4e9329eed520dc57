"""Importer for Robo Challenge: makes one IR task of each state-constrained kitchen task.

Item states are state variables; each processing action needs its item in one state and leaves it
in another; stations and robots are resources; stack order and temporal constraints are precedence.
A candidate goal is an optional group with a reward, which takes its cost out of reservoirs.
Action ids are `<action>_<item>`. Source: repository jiayizx/async_planning (Zhang et al. 2026).
"""

from __future__ import annotations

from collections.abc import Iterator

from irc.frontends.importers.instances import read_instances
from irc.frontends.importers.robo.document import read_robo_task
from irc.frontends.importers.robo.task import robo_task
from irc.model import Task

__all__ = ["import_robo"]


def import_robo(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of every instance. Raises `InputError` with every fault of the file."""
    instances, faults = read_instances(text, name)
    tasks = [read_robo_task(instance) for instance in instances]
    faults.raise_any()
    yield from ((task.id, robo_task(task)) for task in tasks if task is not None)
