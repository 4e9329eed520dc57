"""Importer for RCPSP/max: projects with least and greatest time lags (`.sch`).

Format: a line with the numbers of activities and resources; for each activity its number, modes,
successors and a delay in brackets for each of them, from start to start; for each activity its
duration and requests; the capacities. Source: Schwindt 1998, the project generator ProGen/max.
"""

from __future__ import annotations

from collections.abc import Iterator

from irc.frontends.importers.scheduling_files.number_lines import MOST_ELEMENTS, NumberLines
from irc.frontends.importers.scheduling_files.projects import (
    Activity,
    Mode,
    Project,
    ProjectResource,
    project_task,
)
from irc.model import Task

_EXPECTED = (
    "expected RCPSP/max: 'activities resources …', then '0 1 successors … [delay] …' for each "
    "activity, then '0 1 duration requests …', then the capacities"
)


def import_rcpsp_max(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of a project. Raises `InputError` at the first fault."""
    lines = NumberLines(text, name, _EXPECTED)
    head = lines.take_numbers("the first line")
    count = head.take("the number of activities", 0, MOST_ELEMENTS) + 2
    amount = head.take("the number of renewable resources", 0, MOST_ELEMENTS)
    if head:
        head.take("the number of non-renewable resources, which are not read", 0, 0)
    followers = [_followers(lines, position, count) for position in range(count)]
    modes = [_mode(lines, position, amount) for position in range(count)]
    capacities = lines.take_numbers("the capacities", amount) if amount else None
    resources = [
        ProjectResource(f"R{n}", capacities.take(f"the capacity of resource {n}"))
        for n in range(1, amount + 1)
        if capacities is not None
    ]
    if lines:
        lines.refuse("more lines than the format has", lines.next.offsets[0])
    activities = [Activity([mode], after) for mode, after in zip(modes, followers, strict=True)]
    project = Project(resources, activities, first=0, begins_at_0=True)
    yield from project_task(project, name, lines.source)


def _followers(lines: NumberLines, position: int, count: int) -> list[tuple[int, int | None]]:
    row = lines.take_numbers(f"activity {position}")
    row.take("its number", position, position)
    row.take("the number of modes, of which one is read", 1, 1)
    amount = row.take("the number of successors", 0, MOST_ELEMENTS)
    after = [row.take("a successor", 0, count - 1) for _ in range(amount)]
    delays = [row.take("a delay", None, brackets=True) for _ in range(amount)]
    row.end()
    return list(zip(after, delays, strict=True))


def _mode(lines: NumberLines, position: int, amount: int) -> Mode:
    row = lines.take_numbers(f"the requests of activity {position}", amount + 3)
    row.take("its number", position, position)
    row.take("its mode", 1, 1)
    return Mode(row.take("the duration"), row.take_many("a request", amount))
