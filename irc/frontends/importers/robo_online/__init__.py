"""Importer for Online Robo Challenge: makes one IR task, with events, of each kitchen episode.

The kitchen is that of Robo Challenge: item states are state variables, processing and stacking are
actions `<action>_<item>`, stations and robots are resources. Orders that come while the kitchen
works are events, and no part of them is in the task before, so that a plan cannot foresee them.
Source: repository jiayizx/async_planning (Zhang et al. 2026).
"""

from __future__ import annotations

from collections.abc import Iterator

from irc.frontends.importers.instances import read_instances
from irc.frontends.importers.robo_online.document import read_episode
from irc.frontends.importers.robo_online.task import episode_task
from irc.model import Task

__all__ = ["import_robo_online"]


def import_robo_online(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of every episode. Raises `InputError` with every fault of the file."""
    instances, faults = read_instances(text, name)
    episodes = [read_episode(instance) for instance in instances]
    faults.raise_any()
    tasks = [(episode.id, episode_task(episode)) for episode in episodes if episode is not None]
    faults.raise_any()
    yield from ((name, task) for name, task in tasks if task is not None)
