"""Projects of the scheduling literature, and the IR task that means the same."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from irc.diagnostics import Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.model import Task
from irc.model.from_document import to_task


@dataclass(frozen=True)
class Mode:
    """One way to carry out an activity: its duration, and the units of each resource it takes."""

    duration: int
    demands: Sequence[int]


@dataclass(frozen=True)
class Activity:
    """An activity of a project.

    `followers` are (position of the successor, delay). A delay counts from start to start and may
    be negative; None is an ordinary precedence, from end to start.
    """

    modes: Sequence[Mode]
    followers: Sequence[tuple[int, int | None]]


@dataclass(frozen=True)
class ProjectResource:
    """A resource of a project: renewable, or used up (a budget for the whole project)."""

    id: str
    capacity: int
    renewable: bool = True


@dataclass(frozen=True)
class Project:
    """A project whose activities are numbered from `first` on, as in its file."""

    resources: Sequence[ProjectResource]
    activities: Sequence[Activity]
    first: int = 1
    begins_at_0: bool = False
    """Whether the first activity, from which delays count, is at t = 0."""

    def id_of(self, position: int) -> str:
        """The id of the action of an activity."""
        return f"activity {position + self.first}"


def project_task(project: Project, name: str, source: Source) -> Iterator[tuple[str, Task]]:
    """(file stem, task) of a project; both are named after the file."""
    stem = stem_of(name)
    yield stem, task_of({"name": stem, **_document(project)}, source)


def stem_of(name: str) -> str:
    """The name of a file without folder and suffix."""
    return PurePath(name).stem or "task"


def task_of(document: dict[str, Any], source: Source) -> Task:
    """The task of a document that a reader made. Raises `InputError` with its faults."""
    findings = Findings()
    task = to_task(document, findings)
    if task is None:
        raise InputError(Report(tuple(findings.items), source))
    return task


def _document(project: Project) -> dict[str, Any]:
    actions = [_action(project, position) for position in range(len(project.activities))]
    if project.begins_at_0:
        actions[0]["start"] = 0
    return {
        "resources": [
            {"id": r.id, "capacity": r.capacity}
            if r.renewable
            else {"id": r.id, "kind": "reservoir", "initial": r.capacity}
            for r in project.resources
        ],
        "actions": actions,
        "precedence": [
            _precedence(project.id_of(position), project.id_of(after), delay)
            for position, activity in enumerate(project.activities)
            for after, delay in activity.followers
        ],
    }


def _action(project: Project, position: int) -> dict[str, Any]:
    modes = project.activities[position].modes
    ways = [{"duration": mode.duration, **_demands(project, mode)} for mode in modes]
    if len(ways) == 1:
        return {"id": project.id_of(position), **ways[0]}
    return {
        "id": project.id_of(position),
        "modes": [{"id": f"mode {n}", **way} for n, way in enumerate(ways, 1)],
    }


def _demands(project: Project, mode: Mode) -> dict[str, Any]:
    """The fields for what a mode holds and uses up."""
    wanted = [(r, n) for r, n in zip(project.resources, mode.demands, strict=True) if n]
    uses = [{"resource": r.id, "amount": n} for r, n in wanted if r.renewable]
    used_up = [{"resource": r.id, "amount": n} for r, n in wanted if not r.renewable]
    return {**({"uses": uses} if uses else {}), **({"consumes": used_up} if used_up else {})}


def _precedence(before: str, after: str, delay: int | None) -> dict[str, Any]:
    if delay is None:
        return {"before": before, "after": after}
    return {"before": before, "after": after, "type": "start-start", "min_lag": delay}
