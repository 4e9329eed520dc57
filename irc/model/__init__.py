"""The IR as pydantic models: what the user wrote, checked for shape only."""

from irc.model.events import Change, Event
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
