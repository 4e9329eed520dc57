"""Events: revisions of a task that become known while it runs (docs/online.md)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, field_validator

from irc.model.base import Amount, Count, Instant, Name, Node, StateValue
from irc.model.details import Goal, Group, StateVariable
from irc.model.parts import (
    Action,
    Duration,
    ObjectiveName,
    Precedence,
    Resource,
    objective_names,
)


class AddActions(Node):
    """New work."""

    op: Literal["add_actions"]
    actions: tuple[Action, ...]


class CancelActions(Node):
    """Work no longer wanted; what is running ends at the event."""

    op: Literal["cancel_actions"]
    actions: tuple[Name, ...]


class SetDuration(Node):
    """An action takes another time than was thought."""

    op: Literal["set_duration"]
    action: Name
    duration: Duration


class AddPrecedence(Node):
    """New orderings."""

    op: Literal["add_precedence"]
    precedence: tuple[Precedence, ...]


class PrecedenceKey(Node):
    """All precedences between two actions."""

    before: Name
    after: Name


class RemovePrecedence(Node):
    """Orderings that no longer bind."""

    op: Literal["remove_precedence"]
    precedence: tuple[PrecedenceKey, ...]


class AddResources(Node):
    """New stations, robots, stocks."""

    op: Literal["add_resources"]
    resources: tuple[Resource, ...]


class SetCapacity(Node):
    """Another capacity, from the event on or within a window (a failure)."""

    op: Literal["set_capacity"]
    resource: Name
    capacity: Count
    from_: Instant | None = Field(default=None, alias="from")
    to: Instant | None = None


class SetDeadline(Node):
    """Another deadline of the task, of one action or of one group; null takes it away."""

    op: Literal["set_deadline"]
    deadline: Instant | None
    action: Name | None = None
    group: Name | None = None


class SetRelease(Node):
    """An action may start from another time on."""

    op: Literal["set_release"]
    action: Name
    release: Instant


class AddGroups(Node):
    """New orders."""

    op: Literal["add_groups"]
    groups: tuple[Group, ...]


class CancelGroups(Node):
    """Orders taken back."""

    op: Literal["cancel_groups"]
    groups: tuple[Name, ...]


class SetGoals(Node):
    """Other goals in place of all the old ones."""

    op: Literal["set_goals"]
    goals: tuple[Goal, ...]


class SetState(Node):
    """The world changed by itself."""

    op: Literal["set_state"]
    var: Name
    value: StateValue = True


class AddState(Node):
    """New state variables."""

    op: Literal["add_state"]
    state: tuple[StateVariable, ...]


class SetObjective(Node):
    """Another objective."""

    op: Literal["set_objective"]
    objective: Annotated[tuple[ObjectiveName, ...], Field(min_length=1)]

    _one_objective = field_validator("objective", mode="before")(objective_names)


class Observe(Node):
    """What really happened: an action started or finished at a time."""

    op: Literal["observe"]
    action: Name
    occurrence: Amount = 1
    started: Instant | None = None
    finished: Instant | None = None


Change = Annotated[
    AddActions
    | CancelActions
    | SetDuration
    | AddPrecedence
    | RemovePrecedence
    | AddResources
    | SetCapacity
    | SetDeadline
    | SetRelease
    | AddGroups
    | CancelGroups
    | SetGoals
    | SetState
    | AddState
    | SetObjective
    | Observe,
    Discriminator("op"),
]


class Event(Node):
    """Revisions of the task that become known at `at`."""

    id: Name | None = None
    at: Instant
    changes: tuple[Change, ...] = ()


Events = tuple[Event, ...]
