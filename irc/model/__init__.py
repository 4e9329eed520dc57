"""The IR as pydantic models: what the user wrote, checked for shape only."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from irc.model.parts import (
    Action,
    Condition,
    DurationRange,
    Effect,
    Goal,
    Group,
    Mode,
    OccurrenceRange,
    Precedence,
    Resource,
    StateGoal,
    StateVariable,
    StockChange,
    Use,
    Window,
)
from irc.model.task import Task

if TYPE_CHECKING:
    from irc.model.events import Change, Event

__all__ = [
    "Action",
    "Change",
    "Condition",
    "DurationRange",
    "Effect",
    "Event",
    "Goal",
    "Group",
    "Mode",
    "OccurrenceRange",
    "Precedence",
    "Resource",
    "StateGoal",
    "StateVariable",
    "StockChange",
    "Task",
    "Use",
    "Window",
]


def __getattr__(name: str) -> Any:
    if name in ("Change", "Event"):
        from irc.model import events

        return getattr(events, name)
    raise AttributeError(f"module 'irc.model' has no attribute {name!r}")
