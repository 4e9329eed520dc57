"""The parts that most tasks do not have: state, stock, modes, calendars, groups.

Loaded when a task has one of them (see `irc.model.lazy`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from irc.model.base import (
    Amount,
    AnyValue,
    Count,
    DayTime,
    Instant,
    Level,
    Name,
    Node,
    Span,
    StateValue,
    Text,
)
from irc.model.parts import Duration, Precedence, Use
from irc.model.quantities import Number, level_of
from irc.model.state_values import limits_text


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


Day = Annotated[
    Literal["mon", "tue", "wed", "thu", "fri", "sat", "sun"],
    BeforeValidator(lambda raw: _DAYS.get(raw.lower(), raw) if isinstance(raw, str) else raw),
]

_DAYS = {
    name: name[:3]
    for name in ("monday", "tuesday", "wednesday", "thursday", "friday", "saturday", "sunday")
}


class OpenTime(Node):
    """An open time of each of the `days` (all, if none is named), or of each cycle of `every`.

    Where `to` is not after `from` it runs over midnight, or over the end of the cycle.
    """

    days: tuple[Day, ...] = ()
    from_: DayTime = Field(alias="from")
    to: DayTime


class ClosedTime(Node):
    """A time [from, to) at which a calendar is closed, whatever its open times say."""

    from_: Instant = Field(alias="from")
    to: Instant


ClosedTimes = Annotated[
    Annotated[Instant, Tag("text")] | Annotated[ClosedTime, Tag("object")],
    Discriminator(lambda raw: "object" if isinstance(raw, (dict, ClosedTime)) else "text"),
]


class Calendar(Node):
    """Open times that repeat without end: by days of the week, or `every` some time from t = 0.

    Times of day are those of the clock in `time_zone`, by default that of the task's `origin`.
    """

    id: Name
    label: Text | None = None
    description: Text | None = None
    time_zone: Name | None = None
    every: Span | None = None
    open: Annotated[tuple[OpenTime, ...], Field(min_length=1)]
    closed: tuple[ClosedTimes, ...] = ()


class StockChange(Node):
    """Takes from or puts into a reservoir, at the start or the end of an action."""

    resource: Name
    amount: Amount = 1
    at: Literal["start", "end"] | None = None


Limits = tuple[Number | None, Number | None]
"""The least and the greatest level that are asked for; None: no limit."""


class NumberTest:
    """The common part of all that may ask for a range of levels of a number variable, or for one.

    (The fields stand in each of them, behind its own.)
    """

    if TYPE_CHECKING:
        at_least: Level | None
        at_most: Level | None
        equals: Level | None

        @property
        def model_fields_set(self) -> set[str]:
            """The names of the fields that were given."""

    @property
    def limits(self) -> Limits:
        """The least and the greatest level that it asks for; with `equals` both are the same."""
        if self.equals is None:
            return self.at_least, self.at_most
        least = self.equals if self.at_least is None else max(self.at_least, self.equals)
        return least, self.equals if self.at_most is None else min(self.at_most, self.equals)

    @property
    def asks_for_a_level(self) -> bool:
        """Whether it is about a number variable."""
        return not self.model_fields_set.isdisjoint(_TESTS)


_TESTS = ("at_least", "at_most", "equals")


class Condition(NumberTest, Node):
    """`var` must have `value` just before the start or end, or throughout (`all`).

    A number variable must be within the limits instead.
    """

    at: Literal["start", "all", "end"]
    var: Name
    value: StateValue = True
    at_least: Level | None = None
    at_most: Level | None = None
    equals: Level | None = None


class Effect(Node):
    """`var` becomes `value` at the start or the end of the action.

    Of a number variable the level changes by `add`, or becomes `set`.
    """

    at: Literal["start", "end"]
    var: Name
    value: StateValue = True
    add: Level | None = None
    set: Level | None = None

    @property
    def changes_a_level(self) -> bool:
        """Whether it is about a number variable."""
        return not self.model_fields_set.isdisjoint(("add", "set"))


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


def _level(raw: Any) -> Any:
    """A text that is a number as that number; all else as it is, for the field to judge."""
    if not isinstance(raw, str):
        return raw
    try:
        return level_of(raw)
    except ValueError:
        return raw


class TimedChange(Node):
    """The world gives a state variable a value by itself, at a time."""

    at: Instant
    value: AnyValue


class StateVariable(Node):
    """A variable with several values; without `values`, a boolean that is false at first.

    Of the kind "number" it is an exact number, 0 at first, that stays between `min` and `max`.
    `changes` are timed changes of state: the world changes the variable, whatever the schedule.
    """

    id: Name
    kind: Literal["values", "number"] = "values"
    values: tuple[StateValue, ...] = (False, True)
    initial: AnyValue | None = None
    min: Level | None = None
    max: Level | None = None
    changes: tuple[TimedChange, ...] = ()

    @model_validator(mode="before")
    @classmethod
    def _read_levels(cls, raw: Any) -> Any:
        """Reads the texts of a number variable as levels: "1/3" is a third."""
        if not isinstance(raw, dict) or raw.get("kind") != "number":
            return raw
        read = {**raw, "initial": _level(raw["initial"])} if "initial" in raw else {**raw}
        if isinstance(raw.get("changes"), (list, tuple)):
            read["changes"] = [
                {**c, "value": _level(c["value"])} if isinstance(c, dict) and "value" in c else c
                for c in raw["changes"]
            ]
        return read

    @property
    def is_number(self) -> bool:
        """Whether it is a number variable."""
        return self.kind == "number"

    def read(self, value: AnyValue) -> AnyValue:
        """A value of it as it was written elsewhere; a text of a number variable is a level."""
        level: AnyValue = _level(value) if self.is_number else value
        return level

    @property
    def start_value(self) -> StateValue | Number | None:
        """The value before anything happens; None where a multi-valued variable names none."""
        if self.kind == "number":
            return 0 if self.initial is None else self.initial
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


class CoupledAction(Node):
    """An action of a coupling; `use` is the place of one of its own uses, counted from 0.

    Without it, all resources that the action holds are meant, those of its mode included.
    """

    action: Name
    use: Count | None = None

    @model_validator(mode="before")
    @classmethod
    def _read_name(cls, raw: Any) -> Any:
        return {"action": raw} if isinstance(raw, str) else raw


class ChoiceMade(Node):
    """That an action is carried out in a `mode`, or in one of some `modes`, or holds a `resource`.

    The resource is that of its use `use`, or of any.
    """

    action: Name
    mode: Name | None = None
    modes: tuple[Name, ...] = ()
    resource: Name | None = None
    use: Count | None = None

    @model_validator(mode="after")
    def _one_choice(self) -> ChoiceMade:
        if sum((self.mode is not None, bool(self.modes), self.resource is not None)) != 1:
            raise ValueError("needs one of 'mode', 'modes' and 'resource'")
        return self

    @property
    def in_modes(self) -> tuple[str, ...]:
        """The modes of which one is meant; none where it is a resource."""
        return self.modes if self.mode is None else (self.mode,)


Coupled = Literal["resource", "mode"]


class Coupling(Node):
    """Choices of several actions that depend on each other, among those that are present."""

    same: Coupled | None = None
    different: Coupled | None = None
    actions: tuple[CoupledAction, ...] = ()
    if_: ChoiceMade | None = Field(default=None, alias="if")
    then: ChoiceMade | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> Coupling:
        if (self.if_ is None) != (self.then is None):
            raise ValueError("'if' and 'then' belong together")
        if sum(kind is not None for kind in (self.same, self.different, self.if_)) != 1:
            raise ValueError("needs one of 'same', 'different', and 'if' with 'then'")
        if (self.if_ is None) != bool(self.actions):
            raise ValueError("needs 'actions' with 'same' and 'different', and only there")
        return self


class Selection(Node):
    """How many of some optional actions and groups are present; with `if`, only where that is.

    With `all_or_none` it is all of them or none.
    """

    actions: Annotated[tuple[Name, ...], Field(min_length=1)]
    min: Count = 0
    max: Count | None = None
    all_or_none: Annotated[bool, Field(strict=True)] = False
    if_: Name | None = Field(default=None, alias="if")

    @model_validator(mode="after")
    def _one_count(self) -> Selection:
        if self.all_or_none and (self.min or self.max is not None):
            raise ValueError("takes 'min' and 'max' without 'all_or_none', and only there")
        return self


class UseOrder(Node):
    """An order of uses of resources, among present actions.

    With `consecutive` the second action holds the `resource` (None: each that both hold) next after
    the first. With `same_order` the jobs hold all of these resources in one order. A job of `jobs`
    is a row with an action for each of the resources; without `jobs`, a group is one, and so is an
    action in no group.
    """

    consecutive: Annotated[tuple[Name, ...], Field(min_length=2, max_length=2)] | None = None
    resource: Name | None = None
    same_order: Annotated[tuple[Name, ...], Field(min_length=2)] | None = None
    jobs: tuple[tuple[Name, ...], ...] = ()

    @model_validator(mode="after")
    def _one_kind(self) -> UseOrder:
        if (self.consecutive is None) == (self.same_order is None):
            raise ValueError("needs one of 'consecutive' and 'same_order'")
        if self.resource is not None and self.consecutive is None:
            raise ValueError("takes 'resource' with 'consecutive', and only there")
        if self.jobs and self.same_order is None:
            raise ValueError("takes 'jobs' with 'same_order', and only there")
        if self.same_order is not None:
            for row in self.jobs:
                if len(row) != len(self.same_order):
                    raise ValueError("each of 'jobs' needs one action for each resource")
        return self


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


class StateGoal(NumberTest, Node):
    """A goal: `var` has `value` after the last end, or a number variable is within limits."""

    var: Name
    value: StateValue = True
    at_least: Level | None = None
    at_most: Level | None = None
    equals: Level | None = None

    @property
    def wanted(self) -> StateValue:
        """The value that the variable must have, as reports name it, or its limits in words."""
        return limits_text(*self.limits) if self.asks_for_a_level else self.value


Goal = Annotated[
    Annotated[Name, Tag("text")] | Annotated[StateGoal, Tag("object")],
    Discriminator(_object_or_text),
]

Calendars = tuple[Calendar, ...]
Conditions = tuple[Condition, ...]
Effects = tuple[Effect, ...]
Goals = tuple[Goal, ...]
Couplings = tuple[Coupling, ...]
Groups = tuple[Group, ...]
Lapses = tuple[Lapsed, ...]
Modes = tuple[Mode, ...]
ResourceSetups = Setups | None
Selections = tuple[Selection, ...]
Sequences = tuple[UseOrder, ...]
State = tuple[StateVariable, ...]
StockChanges = tuple[StockChange, ...]
Windows = tuple[Window, ...]
