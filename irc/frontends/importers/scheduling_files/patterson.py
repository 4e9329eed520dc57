"""Importer for projects in the Patterson format (`.rcp`).

Format: the numbers of activities and resources; the capacities; for each activity its duration,
its requests, the number of successors and the successors, broken into lines anywhere.
Source: Patterson 1984; it is the format of the library of Ghent's OR&S group.
"""

from __future__ import annotations

from collections.abc import Iterator

from irc.frontends.importers.scheduling_files.number_lines import (
    MOST_ELEMENTS,
    NumberLines,
    Numbers,
)
from irc.frontends.importers.scheduling_files.projects import (
    Activity,
    Mode,
    Project,
    ProjectResource,
    project_task,
)
from irc.model import Task

_EXPECTED = (
    "expected the Patterson format: 'activities resources', the capacities, then 'duration "
    "requests … successors …' for each activity"
)


def import_patterson(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of a project. Raises `InputError` at the first fault."""
    lines = NumberLines(text, name, _EXPECTED)
    head = lines.take_numbers("the first line", 2)
    count = head.take("the number of activities", 1, MOST_ELEMENTS)
    amount = head.take("the number of resources", 0, MOST_ELEMENTS)
    numbers = lines.rest("the project")
    resources = [
        ProjectResource(f"R{n}", numbers.take(f"the capacity of resource {n}"))
        for n in range(1, amount + 1)
    ]
    activities = [_activity(numbers, n, count, amount) for n in range(1, count + 1)]
    numbers.end()
    yield from project_task(Project(resources, activities), name, lines.source)


def _activity(numbers: Numbers, number: int, count: int, amount: int) -> Activity:
    numbers.what = f"activity {number}"
    duration = numbers.take("the duration")
    demands = numbers.take_many("a request", amount)
    after = numbers.take("the number of successors", 0, count)
    followers = [numbers.take("a successor", 1, count) - 1 for _ in range(after)]
    return Activity([Mode(duration, demands)], [(one, None) for one in followers])
