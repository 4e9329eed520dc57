"""Events: revisions of a task that become known while it runs (docs/online.md)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, field_validator

from irc.model.base import Amount, AnyValue, Count, Instant, Name, Node, Span
from irc.model.details import Goal, Group, StateVariable
from irc.model.parts import (
    Action,
    Duration,
    Objective,
    Precedence,
    Resource,
    objective_names,
)


class AddActions(Node):
    """Adds actions."""

    op: Literal["add_actions"]
    actions: tuple[Action, ...]


class CancelActions(Node):
    """Cancels actions; running ones end at the event."""

    op: Literal["cancel_actions"]
    actions: tuple[Name, ...]


class SetDuration(Node):
    """Sets another duration of an action."""

    op: Literal["set_duration"]
    action: Name
    duration: Duration


class AddPrecedence(Node):
    """Adds precedences."""

    op: Literal["add_precedence"]
    precedence: tuple[Precedence, ...]


class PrecedenceKey(Node):
    """All precedences between two actions."""

    before: Name
    after: Name


class RemovePrecedence(Node):
    """Removes precedences."""

    op: Literal["remove_precedence"]
    precedence: tuple[PrecedenceKey, ...]


class AddResources(Node):
    """Adds resources: stations, robots, stocks."""

    op: Literal["add_resources"]
    resources: tuple[Resource, ...]


class SetCapacity(Node):
    """Sets another capacity, from the event on or within a window (a failure)."""

    op: Literal["set_capacity"]
    resource: Name
    capacity: Count
    from_: Instant | None = Field(default=None, alias="from")
    to: Instant | None = None


class SetDeadline(Node):
    """Sets another deadline of the task, of one action or of one group; null removes it."""

    op: Literal["set_deadline"]
    deadline: Instant | None
    action: Name | None = None
    group: Name | None = None


class SetRelease(Node):
    """Sets another release of an action."""

    op: Literal["set_release"]
    action: Name
    release: Instant


class AddGroups(Node):
    """Adds groups: new orders."""

    op: Literal["add_groups"]
    groups: tuple[Group, ...]


class CancelGroups(Node):
    """Cancels groups: orders that are no longer wanted."""

    op: Literal["cancel_groups"]
    groups: tuple[Name, ...]


class SetGoals(Node):
    """Replaces all goals."""

    op: Literal["set_goals"]
    goals: tuple[Goal, ...]


class SetState(Node):
    """Sets the value of a state variable: a world change."""

    op: Literal["set_state"]
    var: Name
    value: AnyValue = True


class AddState(Node):
    """Adds state variables."""

    op: Literal["add_state"]
    state: tuple[StateVariable, ...]


class SetObjective(Node):
    """Sets another objective."""

    op: Literal["set_objective"]
    objective: Annotated[tuple[Objective, ...], Field(min_length=1)]

    _one_objective = field_validator("objective", mode="before")(objective_names)


class RetryAction(Node):
    """Does an action again that failed, was cancelled, or is interrupted by this.

    The repetition is an action of its own, called `id` (default: "weld (2)", say), with the
    precedences, groups and goal of the other. `done` is the part of the duration that need not be
    done again, in the mode `mode` if the action has modes.
    """

    op: Literal["retry_action"]
    action: Name
    id: Name | None = None
    done: Span = 0
    mode: Name | None = None


ObservedStatus = Literal["not_begun", "running", "finished", "failed"]
"""The state of an occurrence at the time of an observation."""


class Observe(Node):
    """An observation: what really happened to an action, as of the event's time.

    `status` says what it is then; `finished` is also when it failed. `expected_end` is when what is
    running should end. `mode` and `resources` are those in which it is really done.
    """

    op: Literal["observe"]
    action: Name
    occurrence: Amount = 1
    status: ObservedStatus | None = None
    started: Instant | None = None
    finished: Instant | None = None
    expected_end: Instant | None = None
    mode: Name | None = None
    resources: tuple[Name, ...] = ()


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
    | RetryAction
    | Observe,
    Discriminator("op"),
]


class Event(Node):
    """Revisions of the task that become known at `at`."""

    id: Name | None = None
    at: Instant
    changes: tuple[Change, ...] = ()


Events = tuple[Event, ...]
