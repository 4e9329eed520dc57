"""Finds a conflict of any task by leaving statements out and asking the solver again.

A statement is a part of the document without which a task allows at least what it allowed before:
a window, a calendar, a duration, a use, a precedence, a condition, a goal, a date. What is left
when none can be left out any more cannot hold together (deletion filter: Chinneck and Dravnieks
1991). Statements of one kind are tried together first, and halves of those that must stay.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from irc.diagnostics import InputError
from irc.diagnostics.source import Pointer
from irc.driver.solve import solve_task
from irc.explanation.result import RenderedStatement
from irc.model import Action, DurationRange, Task, Use
from irc.model.base import write_time
from irc.model.canonical import written_task
from irc.schedule import Status
from irc.targets import Budget, EngineFailed, SolveOptions

SECONDS_EACH = 20.0
"""Limit on the time for one question to the solver."""

MOST_STATEMENTS = 2000
"""A task with more statements is not explained in this way."""

Document = dict[str, Any]


@dataclass(frozen=True)
class Removable:
    """A statement, and how a document says no more of it."""

    kind: str
    text: str
    pointer: Pointer
    leave_out: Callable[[Document], None]

    @property
    def rendered(self) -> RenderedStatement:
        """The statement in words, with its place."""
        return RenderedStatement(self.kind, self.text, self.pointer)


def conflict_by_removal(
    task: Task, target: str, budget: Budget
) -> tuple[list[RenderedStatement], bool] | None:
    """(statements that cannot hold together, whether none of them can be left out).

    The caller must have proven that the task has no schedule. None where the time is over before
    anything is known, or the task has no such statements.
    """
    found = sorted(_statements(task), key=lambda s: _ORDER.index(s.kind))
    if not found or len(found) > MOST_STATEMENTS:
        return None
    search = _Search(task, target, budget, found)
    if not search.impossible(frozenset()):
        return None
    kept = search.minimal()
    return [found[k].rendered for k in sorted(kept)], search.done


@dataclass
class _Search:
    task: Task
    target: str
    budget: Budget
    statements: Sequence[Removable]
    done: bool = True

    def __post_init__(self) -> None:
        self.document = written_task(self.task)
        self.document.pop("events", None)
        self.document.pop("objective", None)

    def minimal(self) -> frozenset[int]:
        """The statements that are left, by index."""
        gone: set[int] = set()
        kinds: dict[str, list[int]] = {}
        for k, statement in enumerate(self.statements):
            kinds.setdefault(statement.kind, []).append(k)
        for of_kind in kinds.values():
            self._leave_out(of_kind, gone)
        return frozenset(range(len(self.statements))) - gone

    def _leave_out(self, some: list[int], gone: set[int]) -> None:
        """Leaves out as many of some statements as possible: all of them, or half by half."""
        if self.impossible(frozenset(gone | set(some))):
            gone.update(some)
        elif len(some) > 1:
            middle = len(some) // 2
            self._leave_out(some[:middle], gone)
            self._leave_out(some[middle:], gone)

    def impossible(self, gone: frozenset[int]) -> bool:
        """Whether the task without some statements is proven to have no schedule."""
        if self.budget.is_over:
            self.done = False
            return False
        document = copy.deepcopy(self.document)
        for k in gone:
            self.statements[k].leave_out(document)
        options = SolveOptions(self.target, time_limit=None, workers=1, seed=0)
        try:
            task = Task.model_validate(_without_gaps(document))
            part = self.budget.at_most(min(SECONDS_EACH, self.budget.left))
            status = solve_task(task, options, part).schedule.status
        except (InputError, EngineFailed, ValueError):
            return False
        if status is Status.UNKNOWN:
            self.done = False
        return status is Status.INFEASIBLE


_GONE = object()
"""Stands for an entry of an array that is left out, until none refers to its place any more."""


def _without_gaps(part: Any) -> Any:
    if isinstance(part, dict):
        return {key: _without_gaps(value) for key, value in part.items() if value is not _GONE}
    if isinstance(part, list):
        return [_without_gaps(value) for value in part if value is not _GONE]
    return part


def _removing(pointer: Pointer, instead: Any = _GONE) -> Callable[[Document], None]:
    def leave_out(document: Document) -> None:
        part: Any = document
        for key in pointer[:-1]:
            part = part[key]
            if part is _GONE:
                return
        part[pointer[-1]] = instead

    return leave_out


_ORDER = (
    *("condition", "use", "duration", "precedence", "release", "max_pause", "goal", "consumption"),
    *("window", "calendar", "latest_start", "start", "deadline", "group_deadline"),
    *("task_deadline",),
)
"""The order of leaving out: what authors set as limits is kept longest."""


def _statements(task: Task) -> Iterator[Removable]:
    if task.deadline is not None:
        said = f"everything ends by {_shown(task, task.deadline)}"
        yield Removable("task_deadline", said, ("deadline",), _removing(("deadline",)))
    yield from _of_resources(task)
    for i, action in enumerate(task.actions):
        yield from _of_action(task, action, ("actions", i))
    for k, edge in enumerate(task.precedence):
        said = f"{edge.before!r} is before {edge.after!r}"
        if edge.type != "finish-start" or edge.max_lag is not None or edge.min_lag != 0:
            limit = "" if edge.max_lag is None else f" and at most {_shown(task, edge.max_lag)}"
            lag = f"at least {_shown(task, edge.min_lag)}{limit}"
            said = f"from {edge.before!r} to {edge.after!r} ({edge.type}) it is {lag}"
        at: Pointer = ("precedence", k)
        yield Removable("precedence", said, at, _removing(at))
    for g, group in enumerate(task.groups):
        if group.deadline is not None:
            said = f"group {group.id!r} ends by {_shown(task, group.deadline)}"
            place: Pointer = ("groups", g, "deadline")
            yield Removable("group_deadline", said, place, _removing(place))
    for g, goal in enumerate(task.goals):
        if isinstance(goal, str):
            said = f"the goal that {goal!r} happens"
        else:
            said = f"the goal on {goal.var!r}"
        yield Removable("goal", said, ("goals", g), _removing(("goals", g)))


def _of_resources(task: Task) -> Iterator[Removable]:
    for i, resource in enumerate(task.resources):
        at: Pointer = ("resources", i)
        if resource.calendar is not None:
            said = f"{resource.id!r} is open by calendar {resource.calendar!r}"
            place = (*at, "calendar")
            yield Removable("calendar", said, place, _removing(place))
        for k, window in enumerate(resource.availability):
            if window.capacity >= resource.capacity and resource.calendar is None:
                continue  # Without it there would be no more room.
            span = f"{_bare(task, window.from_)} to {_shown(task, window.to)}"
            said = f"{resource.id!r} has a capacity of {window.capacity} from {span}"
            where: Pointer = (*at, "availability", k)
            instead = {"from": write_time(window.from_), "to": write_time(window.to)}
            usual = max(resource.capacity, *(w.capacity for w in resource.availability))
            yield Removable("window", said, where, _removing(where, {**instead, "capacity": usual}))


def _of_action(task: Task, action: Action, at: Pointer) -> Iterator[Removable]:
    name = repr(action.id)
    if isinstance(action.duration, DurationRange):
        low = _bare(task, action.duration.min)
        said = f"{name} takes {low} to {_shown(task, action.duration.max)}"
    elif action.duration is not None:
        verb = "works for" if action.breaks == "pause" else "takes"
        said = f"{name} {verb} {_shown(task, action.duration)}"
    if action.duration is not None and action.duration != 0:
        place: Pointer = (*at, "duration")
        yield Removable("duration", said, place, _removing(place, 0))
    for k, use in enumerate(action.uses):
        where: Pointer = (*at, "uses", k)
        yield Removable("use", f"{name} uses {_used(use)}", where, _removing(where))
    for field, kind, words in _DATES:
        date = getattr(action, field)
        if date is not None and not (field == "release" and date == 0):
            place = (*at, field)
            said = f"{name} {words} {_shown(task, date)}"
            yield Removable(kind, said, place, _removing(place))
    if action.calendar is not None:
        said = f"{name} is carried out by calendar {action.calendar!r}"
        place = (*at, "calendar")
        yield Removable("calendar", said, place, _removing(place))
    for k, condition in enumerate(action.conditions):
        where = (*at, "conditions", k)
        yield Removable("condition", f"{name} needs {condition.var!r}", where, _removing(where))
    for k, change in enumerate(action.consumes):
        where = (*at, "consumes", k)
        said = f"{name} consumes {change.amount} of {change.resource!r}"
        yield Removable("consumption", said, where, _removing(where))


_DATES = (
    ("release", "release", "is released at"),
    ("deadline", "deadline", "ends by"),
    ("latest_start", "latest_start", "starts by"),
    ("start", "start", "starts at"),
    ("max_pause", "max_pause", "pauses for at most"),
)


def _used(use: Use) -> str:
    names = " or ".join(map(repr, use.alternatives))
    return names if use.amount == 1 else f"{use.amount} of {names}"


def _shown(task: Task, time: Any) -> str:
    written = write_time(time)
    return f"{written} {task.time_unit}" if isinstance(written, (int, float)) else str(written)


def _bare(task: Task, time: Any) -> str:
    return str(write_time(time))
