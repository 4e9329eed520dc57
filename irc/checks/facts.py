"""Conditions, effects and goals with the places where they are written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from irc.diagnostics.source import Pointer
from irc.model import Task
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
    facts = getattr(task.actions[int(activity.origin[1])], field)
    return [
        ShownFact(fact.at, fact.var, fact.value, (*activity.origin, field, k))
        for k, fact in enumerate(facts)
    ]


def goal_places(task: Task) -> list[ShownFact]:
    """The goals that are about state variables."""
    return [
        ShownFact("", goal.var, goal.value, ("goals", k))
        for k, goal in enumerate(task.goals)
        if not isinstance(goal, str)
    ]
