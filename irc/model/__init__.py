"""The IR as pydantic models: in, a raw document; out, a typed task, checked for shape only.

Each model is loaded when it is first used: a caller that needs only times does not load pydantic.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irc.model.details import (
        Calendar,
        ClosedTime,
        Condition,
        Effect,
        Goal,
        Group,
        Mode,
        OccurrenceRange,
        OpenTime,
        Setups,
        SetupTime,
        StateGoal,
        StateVariable,
        StockChange,
        Window,
    )
    from irc.model.events import Change, Event
    from irc.model.parts import Action, DurationRange, Precedence, Resource, Use
    from irc.model.task import Task

__all__ = [
    "Action",
    "Calendar",
    "Change",
    "ClosedTime",
    "Condition",
    "DurationRange",
    "Effect",
    "Event",
    "Goal",
    "Group",
    "Mode",
    "OccurrenceRange",
    "OpenTime",
    "Precedence",
    "Resource",
    "SetupTime",
    "Setups",
    "StateGoal",
    "StateVariable",
    "StockChange",
    "Task",
    "Use",
    "Window",
]


_HOMES = {
    "details": (
        "Calendar ClosedTime Condition Effect Goal Group Mode OccurrenceRange OpenTime "
        "SetupTime Setups StateGoal StateVariable StockChange Window"
    ),
    "events": "Change Event",
    "parts": "Action DurationRange Precedence Resource Use",
    "task": "Task",
}
"""The module of each model."""


def __getattr__(name: str) -> Any:
    for module, names in _HOMES.items():
        if name in names.split():
            return getattr(import_module(f"irc.model.{module}"), name)
    raise AttributeError(f"module 'irc.model' has no attribute {name!r}")
