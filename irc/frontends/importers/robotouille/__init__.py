"""Importer for Robotouille: makes one IR task of each grid kitchen.

One robot walks between stations, carries one item at a time, cuts, and starts stoves and fryers
that then run by themselves. The task has the places of the robot, the durations of walks, the item
in its hand, the items on others, each single cut, and cooking. One time unit is one step of the
game.

State variables: `robot` (the station it stands at, or "walking"), `hand` (an item, or "empty"),
`top_<station>` (the uppermost item there, or "nothing"), `below_<item>` (an item, or "station";
only where it matters), `at_<item>` (a station, or "hand"; only where a goal asks), `cut_<item>`
(the number of its cuts), `cooked_<item>` and `fried_<item>`.

Every action of the robot uses the resource `robot`. Cooking, frying, putting an item in and taking
it out use the stove or fryer. `docs/importers.md` and the metadata of each task list the
assumptions. Source: Robotouille, as converted in the repository jiayizx/async_planning.
"""

from __future__ import annotations

from collections.abc import Iterator

from irc.frontends.importers.instances import read_instances
from irc.frontends.importers.robotouille.document import read_kitchen_task
from irc.frontends.importers.robotouille.task import robotouille_task
from irc.model import Task

__all__ = ["import_robotouille"]


def import_robotouille(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of every instance. Raises `InputError` with every fault of the file."""
    instances, faults = read_instances(text, name)
    read = [read_kitchen_task(instance) for instance in instances]
    faults.raise_any()
    tasks = [(task.id, robotouille_task(task)) for task in read if task is not None]
    faults.raise_any()
    yield from ((stem, task) for stem, task in tasks if task is not None)
