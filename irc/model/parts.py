"""The parts that nearly every task has: actions, resources and their use, precedence."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from irc.model.base import Amount, Count, Instant, Name, Node, Span, Text
from irc.model.lazy import Conditions, Effects, Modes, Occurs, ResourceSetups, StockChanges, Windows

PrecedenceType = Literal["finish-start", "start-start", "finish-finish", "start-finish"]
ObjectiveName = Literal[
    "minimize_makespan",
    "minimize_tardiness",
    "minimize_tardy",
    "minimize_max_tardiness",
    "minimize_earliness",
    "minimize_flow_time",
    "maximize_reward",
    "minimize_cost",
    "minimize_changes",
    "minimize_setup_time",
    "minimize_setup_cost",
]

Breaks = Literal["avoid", "pause"]
"""Whether an action keeps clear of closed times, or pauses at them."""

OnFailure = Literal["resume", "restart"]
"""How an action is done again that ran on a resource when this broke."""


def _range_or_time(raw: Any) -> str:
    return "range" if isinstance(raw, (dict, DurationRange)) else "time"


class DurationRange(Node):
    """A range of durations from which the solver chooses, both ends included."""

    min: Span
    max: Span


Duration = Annotated[
    Annotated[Span, Tag("time")] | Annotated[DurationRange, Tag("range")],
    Discriminator(_range_or_time),
]


class Resource(Node):
    """A station, a robot, a crew (renewable), an oven that takes loads (batch), or a stock
    (reservoir).
    """

    id: Name
    kind: Literal["renewable", "batch", "reservoir"] = "renewable"
    label: Text | None = None
    description: Text | None = None
    capacity: Count = 1
    calendar: Name | None = None
    availability: Windows = ()
    setups: ResourceSetups = None
    no_idle: Annotated[bool, Field(strict=True)] = False
    initial: Annotated[int, Field(strict=True)] = 0
    min: Annotated[int, Field(strict=True)] = 0
    max: Annotated[int, Field(strict=True)] | None = None


class Use(Node):
    """Holds `amount` units of one resource over [start, end): a named one, or one of several.

    Set-ups and loads of the resource depend on the `family`.
    """

    resource: Name | None = None
    one_of: tuple[Name, ...] | None = None
    amount: Amount = 1
    family: Name | None = None

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


OF_MODES = ("consumes", "produces", "conditions", "effects", "cost")
"""The fields of a mode that add to its action, besides uses."""

_SIMPLE = frozenset(["id", "label", "description", "duration"])


class Action(Node):
    """An action: something that takes time."""

    id: Name
    label: Text | None = None
    description: Text | None = None
    duration: Duration | None = None
    occurs: Occurs = "once"
    uses: tuple[Use, ...] = ()
    modes: Modes = ()
    consumes: StockChanges = ()
    produces: StockChanges = ()
    release: Instant = 0
    deadline: Instant | None = None
    due: Instant | None = None
    weight: Count | None = None
    start: Instant | None = None
    latest_start: Instant | None = None
    calendar: Name | None = None
    breaks: Breaks = "avoid"
    max_pause: Span | None = None
    earliest_end: Instant | None = None
    conditions: Conditions = ()
    effects: Effects = ()
    reward: Annotated[int, Field(strict=True)] | None = None
    cost: Annotated[int, Field(strict=True)] | None = None
    on_failure: OnFailure | None = None

    @model_validator(mode="before")
    @classmethod
    def _read_range_of_starts(cls, raw: Any) -> Any:
        """A `start` with `min` and `max` is another way to write `release` and `latest_start`."""
        start = raw.get("start") if isinstance(raw, dict) else None
        if not isinstance(start, dict) or not start.keys() <= {"min", "max"}:
            return raw
        read = {key: value for key, value in raw.items() if key != "start"}
        for key, field in (("min", "release"), ("max", "latest_start")):
            if start.get(key) is None:
                continue
            if raw.get(field) is not None:
                raise ValueError(f"'{key}' of 'start' and '{field}' mean the same; keep one")
            read[field] = start[key]
        return read

    @property
    def is_simple(self) -> bool:
        """Whether its only content is a whole number of time units above 0 as its duration.

        Most actions of large tasks are like this, so code that visits all actions can skip work.
        """
        return self.model_fields_set <= _SIMPLE and type(self.duration) is int and self.duration > 0

    @property
    def ways(self) -> tuple[Action, ...]:
        """The action as each of its modes has it; the action itself where it has no modes."""
        return tuple(self.in_mode(mode.id) for mode in self.modes) or (self,)

    def in_mode(self, mode: str | None) -> Action:
        """The action with the stock, state and cost of a mode (by name) among its own.

        Its modes stay. Without a mode, or with an unknown one, it is the action itself.
        """
        own = next((m for m in self.modes if m.id == mode), None)
        if own is None or own.model_fields_set.isdisjoint(OF_MODES):
            return self
        fields = {name: getattr(self, name) + getattr(own, name) for name in OF_MODES[:-1]}
        cost = None if self.cost is None is own.cost else (self.cost or 0) + (own.cost or 0)
        return self.model_copy(update={**fields, "cost": cost})

    @property
    def may_repeat(self) -> bool:
        """Whether more than one occurrence is possible."""
        return self.occurs != "once" and self.occurrence_bounds[1] not in (0, 1)

    @property
    def occurrence_bounds(self) -> tuple[int, int | None]:
        """The least and the greatest number of occurrences (None: no greatest)."""
        if isinstance(self.occurs, str):
            return (1, 1) if self.occurs == "once" else (0, 1)
        return self.occurs.min, self.occurs.max


PRECEDENCE_ALIASES = {"predecessor": "before", "successor": "after", "lag": "min_lag"}


class Precedence(Node):
    """A precedence: a bound on the lag between a happening of `before` and one of `after`."""

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
    """The object with the IR's own field names. `ValueError` where both names are given."""
    renamed: dict[str, Any] = {}
    for key, value in raw.items():
        name = aliases.get(key, key)
        if name != key and name in raw:
            raise ValueError(f"'{key}' and '{name}' mean the same; write only '{name}'")
        renamed[name] = value
    return renamed


class ObjectiveTerm(Node):
    """An objective of a sum, with its weight."""

    weight: Amount = 1
    objective: ObjectiveName

    @model_validator(mode="before")
    @classmethod
    def _read_pair(cls, raw: Any) -> Any:
        if isinstance(raw, (list, tuple)) and len(raw) == 2:
            return {"weight": raw[0], "objective": raw[1]}
        return raw


class ObjectiveSum(Node):
    """A weighted sum of objectives, as one; a reward counts negatively."""

    sum: Annotated[tuple[ObjectiveTerm, ...], Field(min_length=1)]


def _text_or_object(raw: Any) -> str:
    return "object" if isinstance(raw, (dict, ObjectiveSum)) else "text"


Objective = Annotated[
    Annotated[ObjectiveName, Tag("text")] | Annotated[ObjectiveSum, Tag("object")],
    Discriminator(_text_or_object),
]


def objective_names(raw: Any) -> Any:
    """The objectives; a single one becomes a list."""
    return (raw,) if isinstance(raw, (str, dict, ObjectiveSum)) else raw
