"""Whether a conflict is one, and minimal: judged on the task's document, statement by statement.

A statement is taken out of the document itself: the deadline, release, fixed start, use or
precedence is deleted, a capacity is raised beyond all demand, a duration is made free. What is
left is decided by solving (or by brute force), which knows nothing of explanations.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Collection, Iterable
from typing import Any

import irc
from irc.diagnostics.source import Pointer
from irc.explanation.result import Explanation
from irc.model import Task
from irc.schedule import Status

Decide = Callable[[Task], bool]

_LONG = 100_000
"""More than any of the small tasks takes; a free duration is at most so long."""

_PLENTY = 100_000
"""Units of a resource of which the capacity is not stated."""


def by_solving(task: Task) -> bool:
    """Whether a task has a schedule, by `irc.solve`; what the checks find impossible has none."""
    try:
        schedule = irc.solve(task, time_limit=60, workers=1)
    except irc.InputError as error:
        if {d.code.id for d in error.report.errors} <= {f"IRC30{k}" for k in range(1, 6)}:
            return False
        raise
    if schedule.status is Status.INFEASIBLE:
        return False
    assert schedule.answered, schedule.status
    return True


def statements_of(task: Task) -> set[Pointer]:
    """The places of all statements of a task; what is repeated word for word counts once."""
    found: set[Pointer] = {("deadline",)} if task.deadline is not None else set()
    for i, action in enumerate(task.actions):
        found.add(("actions", i, "duration"))
        fields = (("release", action.release), ("deadline", action.deadline))
        found |= {("actions", i, name) for name, value in fields if value}
        if action.deadline is not None:
            found.add(("actions", i, "deadline"))
        if action.latest_start is not None:
            found.add(("actions", i, "latest_start"))
        if action.earliest_end is not None:
            found.add(("actions", i, "earliest_end"))
        if action.start is not None:
            found.add(("actions", i, "start"))
        found |= {("actions", i, "uses", u) for u in range(len(action.uses))}
    found |= {
        ("groups", g, "deadline")
        for g, group in enumerate(task.groups)
        if group.deadline is not None
    }
    found |= {("resources", r, "capacity") for r in range(len(task.resources))}
    found |= {("resources", r, "no_idle") for r, of in enumerate(task.resources) if of.no_idle}
    found |= {("resources", r, "setups") for r, of in enumerate(task.resources) if of.setups}
    found |= {("precedence", k) for k in range(len(task.precedence))}
    return found


def only(task: Task, kept: Collection[Pointer]) -> Task:
    """The task that makes only the statements at `kept`."""
    document = copy.deepcopy(task.model_dump(mode="python", by_alias=True))
    for pointer in statements_of(task) - set(kept):
        # (Set-ups, and use without idle time, are between uses one by one.)
        one_by_one = {(*pointer[:2], "setups"), (*pointer[:2], "no_idle")} & set(kept)
        if not (one_by_one and pointer[-1] == "capacity"):
            _weaken(document, pointer)
    document["precedence"] = [
        p for k, p in enumerate(document["precedence"]) if ("precedence", k) in kept
    ]
    for i, action in enumerate(document["actions"]):
        action["uses"] = [
            u for k, u in enumerate(action["uses"]) if ("actions", i, "uses", k) in kept
        ]
    return Task.model_validate(_without_nothing(document))


def _weaken(document: Any, pointer: Pointer) -> None:
    kind, name = pointer[0], pointer[-1]
    if pointer == ("deadline",):
        document["deadline"] = None
    elif kind == "groups":
        document["groups"][pointer[1]]["deadline"] = None
    elif kind == "resources" and name == "setups":
        document["resources"][pointer[1]]["setups"] = None
    elif kind == "resources" and name == "no_idle":
        document["resources"][pointer[1]]["no_idle"] = False
    elif kind == "resources":
        document["resources"][pointer[1]]["capacity"] = _PLENTY
    elif kind == "actions" and name == "duration":
        document["actions"][pointer[1]]["duration"] = {"min": 0, "max": _LONG}
    elif kind == "actions" and len(pointer) == 3:
        document["actions"][pointer[1]][name] = 0 if name == "release" else None


def _without_nothing(part: Any) -> Any:
    if isinstance(part, dict):
        return {k: _without_nothing(v) for k, v in part.items() if v is not None and v != ()}
    if isinstance(part, (list, tuple)):
        return [_without_nothing(v) for v in part]
    return part


def faults_of(
    task: Task, explanation: Explanation, decide: Decide = by_solving, *, check_minimal: bool = True
) -> list[str]:
    """What is wrong with a conflict: it can hold together, or a statement is not needed."""
    pointers = [told.pointer for told in explanation.conflict]
    faults = [] if len(set(pointers)) == len(pointers) else ["a statement is told twice"]
    faults += [f"no such statement: {p}" for p in pointers if p not in statements_of(task)]
    if faults:
        return faults
    if decide(only(task, pointers)):
        return ["these can hold together"]
    if not check_minimal:
        return []
    return [f"not needed: {p}" for p in pointers if not decide(only(task, _but(pointers, p)))]


def _but(pointers: Iterable[Pointer], left_out: Pointer) -> list[Pointer]:
    return [p for p in pointers if p != left_out]
