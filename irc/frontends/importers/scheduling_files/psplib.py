"""Importer for PSPLIB: projects with one or several modes (`.sm`, `.mm`).

Format: the sections PRECEDENCE RELATIONS, REQUESTS/DURATIONS and RESOURCEAVAILABILITIES of the
project generator ProGen. Source: Kolisch and Sprecher 1997, "PSPLIB – a project scheduling problem
library", European Journal of Operational Research 96.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

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
    "expected PSPLIB: the sections 'PRECEDENCE RELATIONS:', 'REQUESTS/DURATIONS:' and "
    "'RESOURCEAVAILABILITIES:'"
)
_RESOURCE = re.compile(r"\b([RND])\s*(\d+)")


def import_psplib(text: str, name: str) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of a project. Raises `InputError` at the first fault."""
    lines = NumberLines(text, name, _EXPECTED)
    followers = _followers(lines)
    columns, modes = _modes(lines, [count for count, _ in followers])
    resources = _resources(lines, columns)
    activities = [
        Activity(ways, [(after, None) for after in afters])
        for ways, (_, afters) in zip(modes, followers, strict=True)
    ]
    yield from project_task(Project(resources, activities), name, lines.source)


def _seek(lines: NumberLines, *titles: str) -> None:
    """Moves behind the title of a section, in one of its spellings."""
    while lines:
        if lines.take().text.upper().startswith(titles):
            return
    lines.refuse(f"there is no section {titles[0]!r}", len(lines.source.text.rstrip()))


def _followers(lines: NumberLines) -> list[tuple[int, list[int]]]:
    """(number of modes, positions of the successors) of each job."""
    _seek(lines, "PRECEDENCE RELATIONS")
    lines.take()
    found: list[tuple[int, list[int]]] = []
    while lines and lines.next.is_numbers:
        row = lines.take_numbers(f"job {len(found) + 1}")
        row.take("its number", len(found) + 1, len(found) + 1)
        modes = row.take("the number of modes", 1, MOST_ELEMENTS)
        count = row.take("the number of successors", 0, MOST_ELEMENTS)
        found.append((modes, [n - 1 for n in row.take_many("a successor", count, 1)]))
        row.end()
    if not found:
        lines.refuse("the section has no jobs", lines.next.offsets[0])
    _check_successors(lines, found)
    return found


def _check_successors(lines: NumberLines, found: Sequence[tuple[int, list[int]]]) -> None:
    first = lines.position - len(found)
    for position, (_, afters) in enumerate(found):
        for number, after in enumerate(afters):
            if after >= len(found):
                place = lines.lines[first + position].offsets[3 + number]
                lines.refuse(f"job {position + 1}: there is no job {after + 1}", place)


def _modes(
    lines: NumberLines, counts: Sequence[int]
) -> tuple[list[tuple[str, str]], list[list[Mode]]]:
    """The columns of resources, and the modes of each job."""
    _seek(lines, "REQUESTS/DURATIONS")
    columns = _columns(lines)
    while lines and not lines.next.is_numbers:
        lines.take()
    found: list[list[Mode]] = []
    for job, count in enumerate(counts, 1):
        ways = []
        for mode in range(1, count + 1):
            row = lines.take_numbers(f"job {job}, mode {mode}", len(columns) + 2 + (mode == 1))
            if mode == 1:
                row.take("the number of the job", 1)
            row.take("the number of the mode", mode, mode)
            duration = row.take("the duration")
            ways.append(Mode(duration, row.take_many("a request", len(columns))))
        found.append(ways)
    if lines and lines.next.is_numbers:
        lines.refuse("more modes than the jobs declare", lines.next.offsets[0])
    return columns, found


def _columns(lines: NumberLines) -> list[tuple[str, str]]:
    """(kind, number) of each resource in the line of headings."""
    heading = lines.take()
    columns = _RESOURCE.findall(heading.text)
    for kind, number in columns:
        if kind == "D":
            message = f"resource {kind} {number} is doubly constrained, which is not read"
            lines.refuse(message, heading.offsets[0])
    return columns


def _resources(lines: NumberLines, columns: Sequence[tuple[str, str]]) -> list[ProjectResource]:
    _seek(lines, "RESOURCEAVAILABILITIES", "RESOURCE AVAILABILITIES")
    if columns != _columns(lines):
        message = "the resources are not those of REQUESTS/DURATIONS"
        lines.refuse(message, lines.lines[lines.position - 1].offsets[0])
    row = lines.take_numbers("RESOURCEAVAILABILITIES", len(columns))
    return [
        ProjectResource(
            f"{kind}{number}", row.take(f"the capacity of {kind} {number}"), kind == "R"
        )
        for kind, number in columns
    ]
