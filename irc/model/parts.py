"""The parts of a task: actions, resources, precedence, state, groups, goals."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from irc.model.base import Amount, Count, Instant, Name, Node, Span, StateValue

PrecedenceType = Literal["finish-start", "start-start", "finish-finish", "start-finish"]
ObjectiveName = Literal[
    "minimize_makespan",
    "minimize_tardiness",
    "maximize_reward",
    "minimize_cost",
    "minimize_changes",
]


def _range_or_time(raw: Any) -> str:
    return "range" if isinstance(raw, (dict, DurationRange)) else "time"


def _object_or_text(raw: Any) -> str:
    return "text" if isinstance(raw, str) else "object"


class DurationRange(Node):
    """A duration the solver chooses, both ends included."""

    min: Span
    max: Span


Duration = Annotated[
    Annotated[Span, Tag("time")] | Annotated[DurationRange, Tag("range")],
    Discriminator(_range_or_time),
]


class Window(Node):
    """A half-open time window [from, to) in which a resource has another capacity."""

    from_: Instant = Field(alias="from")
    to: Instant
    capacity: Count


class Resource(Node):
    """A station, a robot, a crew (renewable), or a stock (reservoir)."""

    id: Name
    kind: Literal["renewable", "reservoir"] = "renewable"
    label: str | None = None
    description: str | None = None
    capacity: Count = 1
    availability: tuple[Window, ...] = ()
    initial: Annotated[int, Field(strict=True)] = 0
    min: Annotated[int, Field(strict=True)] = 0
    max: Annotated[int, Field(strict=True)] | None = None


class Use(Node):
    """Holds `amount` units of one resource over [start, end): a named one, or one of several."""

    resource: Name | None = None
    one_of: tuple[Name, ...] | None = None
    amount: Amount = 1

    @model_validator(mode="after")
    def _one_way(self) -> Use:
        if (self.resource is None) == (self.one_of is None):
            raise ValueError("needs either 'resource' or 'one_of'")
        return self

    @property
    def alternatives(self) -> tuple[str, ...]:
        """The resources of which one is held."""
        if self.one_of is not None:
            return self.one_of
        return () if self.resource is None else (self.resource,)


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
    """One way to carry out an action: its duration, and what it uses besides the action's own."""

    id: Name
    label: str | None = None
    duration: Duration
    uses: tuple[Use, ...] = ()


class OccurrenceRange(Node):
    """How often an action may occur; without `max`, as often as the planner likes."""

    min: Count = 0
    max: Count | None = None


Occurs = Annotated[
    Annotated[Literal["once", "optional"], Tag("text")] | Annotated[OccurrenceRange, Tag("object")],
    Discriminator(_object_or_text),
]


class Action(Node):
    """Something that takes time."""

    id: Name
    label: str | None = None
    description: str | None = None
    duration: Duration | None = None
    occurs: Occurs = "once"
    uses: tuple[Use, ...] = ()
    modes: tuple[Mode, ...] = ()
    consumes: tuple[StockChange, ...] = ()
    produces: tuple[StockChange, ...] = ()
    release: Instant = 0
    deadline: Instant | None = None
    due: Instant | None = None
    weight: Count | None = None
    start: Instant | None = None
    conditions: tuple[Condition, ...] = ()
    effects: tuple[Effect, ...] = ()
    reward: Annotated[int, Field(strict=True)] | None = None
    cost: Annotated[int, Field(strict=True)] | None = None

    @property
    def occurrence_bounds(self) -> tuple[int, int | None]:
        """The least and the greatest number of occurrences (None: no greatest)."""
        if isinstance(self.occurs, OccurrenceRange):
            return self.occurs.min, self.occurs.max
        return (1, 1) if self.occurs == "once" else (0, 1)


PRECEDENCE_ALIASES = {"predecessor": "before", "successor": "after", "lag": "min_lag"}


class Precedence(Node):
    """`after` is bound to `before` at two of their end points, with a lag between min and max."""

    before: Name
    after: Name
    type: PrecedenceType = "finish-start"
    min_lag: Span = 0
    max_lag: Span | None = None

    @model_validator(mode="before")
    @classmethod
    def _read_aliases(cls, raw: Any) -> Any:
        if isinstance(raw, (list, tuple)) and len(raw) == 2:
            return {"before": raw[0], "after": raw[1]}
        if not isinstance(raw, dict) or PRECEDENCE_ALIASES.keys().isdisjoint(raw):
            return raw
        return without_aliases(raw, PRECEDENCE_ALIASES)


def without_aliases(raw: dict[str, Any], aliases: dict[str, str]) -> dict[str, Any]:
    renamed: dict[str, Any] = {}
    for key, value in raw.items():
        name = aliases.get(key, key)
        if name != key and name in raw:
            raise ValueError(f"'{key}' and '{name}' mean the same; write only '{name}'")
        renamed[name] = value
    return renamed


class StateVariable(Node):
    """A multi-valued fact of the world; without `values` a boolean that starts false."""

    id: Name
    values: tuple[StateValue, ...] = (False, True)
    initial: StateValue | None = None

    @property
    def start_value(self) -> StateValue | None:
        """The value before anything happens; None where a multi-valued variable names none."""
        if self.initial is None and set(self.values) == {False, True}:
            return False
        return self.initial


class Group(Node):
    """All of its actions or none: an order, a delivery, a candidate goal."""

    id: Name
    label: str | None = None
    actions: tuple[Name, ...]
    required: Annotated[bool, Field(strict=True)] = True
    reward: Annotated[int, Field(strict=True)] | None = None
    deadline: Instant | None = None
    due: Instant | None = None
    weight: Count | None = None


class StateGoal(Node):
    """`var` has `value` when everything has ended."""

    var: Name
    value: StateValue = True


Goal = Annotated[
    Annotated[Name, Tag("text")] | Annotated[StateGoal, Tag("object")],
    Discriminator(_object_or_text),
]


def objective_names(raw: Any) -> Any:
    """One objective is a list of one."""
    return (raw,) if isinstance(raw, str) else raw
