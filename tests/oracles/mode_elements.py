"""Tasks whose modes have a cost, stock and state, read without them: one task for each choice.

Choosing a mode for each action leaves a task in which the actions have what their modes add. So
the best answer is the best of all choices (docs/semantics.md, rule 2.1).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

from irc.model import Action, Mode, Task

_ADDED = ("consumes", "produces", "conditions", "effects")


def has_mode_elements(task: Task) -> bool:
    """Whether some mode has more than a duration and uses."""
    return any(_adds(mode) for action in task.actions for mode in action.modes)


def _adds(mode: Mode) -> bool:
    return mode.cost is not None or any(getattr(mode, field) for field in _ADDED)


def tasks_by_choice(task: Task) -> Iterator[Task]:
    """The task in each choice of modes; an action whose modes add nothing keeps all of them.

    Raises `ValueError` for an action that may repeat: its occurrences may differ in their modes.
    """
    for actions in product(*(list(_in_each_mode(action)) for action in task.actions)):
        yield task.model_copy(update={"actions": actions})


def _in_each_mode(action: Action) -> Iterator[Action]:
    if not any(map(_adds, action.modes)):
        yield action
        return
    if action.occurrence_bounds[1] != 1:
        raise ValueError(f"action {action.id!r} may repeat, and its modes add to it")
    for mode in action.modes:
        fields: dict[str, Any] = {f: getattr(action, f) + getattr(mode, f) for f in _ADDED}
        bare = Mode(id=mode.id, duration=mode.duration, uses=mode.uses)
        fields |= {"modes": (bare,), "cost": (action.cost or 0) + (mode.cost or 0)}
        yield action.model_copy(update=fields)
