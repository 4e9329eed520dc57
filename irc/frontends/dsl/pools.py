"""Finds the repeated choices of a task, and short names for them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

from irc.model import Action, Resource, Task, Use
from irc.model.events import AddActions, AddResources

Choice = tuple[str, ...]

_LEAST_USES = 2
_ENDING = re.compile(r"[\W\d_]+\Z")


def pools(task: Task) -> dict[Choice, str]:
    """The choices that a task has more than once, each with a name that is not used yet."""
    uses = list(_uses(task))
    counts = Counter(use.one_of for use in uses if use.one_of is not None and len(use.one_of) > 1)
    taken = {use.resource for use in uses if use.resource is not None}
    taken |= {name for use in uses for name in use.one_of or ()}
    taken |= {resource.id for resource in task.resources}
    taken |= {r.id for event in task.events for r in _added(event.changes)}
    found: dict[Choice, str] = {}
    for choice, count in counts.items():
        if count >= _LEAST_USES:
            found[choice] = _free(_stem(choice), taken)
            taken.add(found[choice])
    return found


def _uses(task: Task) -> Iterator[Use]:
    added = (
        action
        for event in task.events
        for change in event.changes
        if isinstance(change, AddActions)
        for action in change.actions
    )
    for actions in (task.actions, added):
        for action in actions:
            yield from _of_action(action)


def _of_action(action: Action) -> Iterator[Use]:
    yield from action.uses
    for mode in action.modes:
        yield from mode.uses


def _added(changes: Iterable[object]) -> Iterator[Resource]:
    for change in changes:
        if isinstance(change, AddResources):
            yield from change.resources


def _stem(choice: Choice) -> str:
    """The common part of the members' names as a plural: "robot 1", "robot 2" → "robots"."""
    first = [_ENDING.sub("", name) for name in choice]
    if first[0] and first[0].isidentifier() and len(set(first)) == 1:
        return f"{first[0]}s"
    last = {name.split()[-1] if name.split() else "" for name in choice}
    if len(last) == 1 and (word := last.pop()).isidentifier():
        return f"{word}s"
    return "choice"


def _free(stem: str, taken: Mapping[str, object] | set[str]) -> str:
    if stem != "choice" and stem not in taken:
        return stem
    number = 1
    while f"{stem} {number}" in taken:
        number += 1
    return f"{stem} {number}"
