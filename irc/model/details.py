"""The parts that most tasks do not have: state, stock, modes, calendars, groups.

Loaded when a task has one of them (see `irc.model.lazy`).
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from irc.model.base import Amount, Count, Instant, Name, Node, Span, StateValue, Text
from irc.model.parts import Duration, Precedence, Use


def _object_or_text(raw: Any) -> str:
    return "text" if isinstance(raw, str) else "object"


class Window(Node):
    """A half-open time window [from, to) in which a resource has another capacity."""

    from_: Instant = Field(alias="from")
    to: Instant
    capacity: Count


class SetupTime(Node):
    """The set-up of a resource between a use of one family and a use of another; "*": any other."""

    from_: Name = Field(alias="from")
    to: Name
    time: Span = 0
    cost: Count = 0


class Setups(Node):
    """The set-ups of a resource: of the most specific rows, and the family at t = 0."""

    initial: Name | None = None
    times: tuple[SetupTime, ...] = ()


class StockChange(Node):
    """Takes from or puts into a reservoir, at the start or the end of an action."""

    resource: Name
    amount: Amount = 1
    at: Literal["start", "end"] | None = None


class Condition(Node):
    """`var` must have `value` just before the start or end, or throughout (`all`)."""

    at: Literal["start", "all", "end"]
    var: Name
    value: StateValue = True


class Effect(Node):
    """`var` becomes `value` at the start or the end of the action."""

    at: Literal["start", "end"]
    var: Name
    value: StateValue = True


class Mode(Node):
    """One way to carry out an action: its duration.

    What it uses, consumes, produces, needs, sets and costs comes on top of the action's own.
    """

    id: Name
    label: Text | None = None
    duration: Duration
    uses: tuple[Use, ...] = ()
    consumes: tuple[StockChange, ...] = ()
    produces: tuple[StockChange, ...] = ()
    conditions: tuple[Condition, ...] = ()
    effects: tuple[Effect, ...] = ()
    cost: Annotated[int, Field(strict=True)] | None = None


class OccurrenceRange(Node):
    """The number of times that an action may occur; without `max`, the solver chooses freely."""

    min: Count = 0
    max: Count | None = None


Occurs = Annotated[
    Annotated[Literal["once", "optional"], Tag("text")] | Annotated[OccurrenceRange, Tag("object")],
    Discriminator(_object_or_text),
]


class TimedChange(Node):
    """The world gives a state variable a value by itself, at a time."""

    at: Instant
    value: StateValue


class StateVariable(Node):
    """A variable with several values; without `values`, a boolean that is false at first.

    `changes` are timed changes of state: the world changes the variable, whatever the schedule.
    """

    id: Name
    values: tuple[StateValue, ...] = (False, True)
    initial: StateValue | None = None
    changes: tuple[TimedChange, ...] = ()

    @property
    def start_value(self) -> StateValue | None:
        """The value before anything happens; None where a multi-valued variable names none."""
        if self.initial is None and set(self.values) == {False, True}:
            return False
        return self.initial


class Group(Node):
    """All of its actions or none: an order, a delivery, a candidate goal."""

    id: Name
    label: Text | None = None
    actions: tuple[Name, ...]
    required: Annotated[bool, Field(strict=True)] = True
    reward: Annotated[int, Field(strict=True)] | None = None
    deadline: Instant | None = None
    due: Instant | None = None
    weight: Count | None = None


class Lapsed(Node):
    """Order, groups and goal of a cancelled action, for its repetition by a `retry_action`.

    Nothing of it counts for a schedule. `repetition` is the action that it was repeated by.
    """

    action: Name
    occurs: Occurs = "once"
    deadline: Instant | None = None
    precedence: tuple[Precedence, ...] = ()
    groups: tuple[Group, ...] = ()
    goal: Annotated[bool, Field(strict=True)] = False
    repetition: Name | None = None


class StateGoal(Node):
    """A goal: `var` has `value` after the last end."""

    var: Name
    value: StateValue = True


Goal = Annotated[
    Annotated[Name, Tag("text")] | Annotated[StateGoal, Tag("object")],
    Discriminator(_object_or_text),
]

Conditions = tuple[Condition, ...]
Effects = tuple[Effect, ...]
Goals = tuple[Goal, ...]
Groups = tuple[Group, ...]
Lapses = tuple[Lapsed, ...]
Modes = tuple[Mode, ...]
ResourceSetups = Setups | None
State = tuple[StateVariable, ...]
StockChanges = tuple[StockChange, ...]
Windows = tuple[Window, ...]
