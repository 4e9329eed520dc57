"""Conditions, effects and goals about values (not levels), with their places in the text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from irc.diagnostics.source import Pointer
from irc.model import Action, Condition, Effect, Mode, Task
from irc.problem import Activity


@dataclass(frozen=True, slots=True)
class ShownFact:
    """A condition, effect or goal: `var` is or becomes `value`; `at` is empty for a goal."""

    at: str
    var: str
    value: bool | str
    pointer: Pointer

    @property
    def key(self) -> tuple[type, bool | str]:
        """The type and the value, so that true and "true" differ."""
        return type(self.value), self.value


def fact_places(
    task: Task, activity: Activity, field: Literal["conditions", "effects"]
) -> list[ShownFact]:
    """The conditions or effects of an action as they were written, in their order."""
    action = task.actions[int(activity.origin[1])]
    return list(_facts(action, field, activity.origin))


def mode_fact_places(
    task: Task, activity: Activity, field: Literal["conditions", "effects"]
) -> list[ShownFact]:
    """The conditions or effects of an action's modes as they were written."""
    modes = enumerate(task.actions[int(activity.origin[1])].modes)
    return [f for m, mode in modes for f in _facts(mode, field, (*activity.origin, "modes", m))]


def _facts(part: Action | Mode, field: str, at: Pointer) -> Iterator[ShownFact]:
    for k, fact in enumerate(getattr(part, field)):
        if not _is_about_number(fact):
            yield ShownFact(fact.at, fact.var, fact.value, (*at, field, k))


def _is_about_number(fact: Condition | Effect) -> bool:
    return fact.changes_a_level if isinstance(fact, Effect) else fact.asks_for_a_level


def goal_places(task: Task) -> list[ShownFact]:
    """The goals that are about state variables."""
    return [
        ShownFact("", goal.var, goal.value, ("goals", k))
        for k, goal in enumerate(task.goals)
        if not isinstance(goal, str) and not goal.asks_for_a_level
    ]
