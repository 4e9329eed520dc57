"""Events built in code: changes that become known while a task runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

from irc.api.elements import (
    Action,
    AnyValue,
    Element,
    Goal,
    Group,
    Resource,
    StateVariable,
    goal_fields,
    name_of,
    precedence_fields,
    without_none,
)
from irc.api.values import Duration, Length, Moment, duration, length, moment
from irc.frontends.events import to_events
from irc.model import Event as IrEvent
from irc.model.events import ObservedStatus
from irc.model.parts import ObjectiveName, PrecedenceType

if TYPE_CHECKING:
    from irc.api.task import Task


class Event:
    """An event: changes of a task that become known at a time. Each method adds one change.

    `irc.Event(5).set_duration("rolls", 30)` is for `Execution.apply` and `replan`, and
    `task.event(5)` makes one of the task's own, which `simulate` runs through.
    """

    def __init__(self, at: Moment, *, id: str | None = None, task: Task | None = None) -> None:
        self._task = task
        self._changes: list[dict[str, Any]] = []
        self._head = without_none(id=id, at=self._moment(at))
        self._known: tuple[list[dict[str, Any]], IrEvent] | None = None
        self._check([])

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Event:
        """The event of a JSON document. Raises `InputError` with every fault of shape."""
        (event,) = to_events([dict(document)], lambda _: (), 0, None)
        return cls.from_ir(event)

    @classmethod
    def from_ir(cls, event: IrEvent) -> Event:
        """The event of a part of the IR, to which changes can be added."""
        made = cls(event.at, id=event.id)
        raw = event.model_dump(by_alias=True, exclude_unset=True)
        made._changes = list(raw.get("changes", ()))
        return made

    @property
    def id(self) -> str | None:
        """Its name, if it has one."""
        return self._head.get("id")

    @property
    def ir(self) -> IrEvent:
        """The immutable part of the IR that it stands for."""
        changes = [_written(change) for change in self._changes]
        if self._known is None or self._known[0] != changes:
            self._known = changes, self._check(changes)
        return self._known[1]

    def to_dict(self) -> dict[str, Any]:
        """Its object in the JSON document."""
        return self.ir.model_dump(mode="json", by_alias=True, exclude_unset=True)

    # --- work ---------------------------------------------------------------------------------

    def add_actions(self, *actions: Action) -> Self:
        """Adds actions, made with `irc.Action(…)`."""
        return self._change("add_actions", actions=list(actions))

    def cancel_actions(self, *actions: Action | str) -> Self:
        """Cancels actions; running ones end at the event."""
        return self._change("cancel_actions", actions=[name_of(a) for a in actions])

    def retry_action(
        self,
        action: Action | str,
        *,
        id: str | None = None,
        done: Length = 0,
        mode: str | None = None,
    ) -> Self:
        """Does an action again that failed or was cancelled, or that this breaks off.

        `id` names the repetition; `done` is what need not be done again, in this `mode`.
        """
        more = without_none(id=id, done=None if done == 0 else length(done), mode=mode)
        return self._change("retry_action", action=name_of(action), **more)

    def set_duration(self, action: Action | str, time: Duration) -> Self:
        """Sets another duration of an action."""
        return self._change("set_duration", action=name_of(action), duration=duration(time))

    def set_release(self, action: Action | str, time: Moment) -> Self:
        """Sets another release of an action."""
        return self._change("set_release", action=name_of(action), release=self._moment(time))

    def set_deadline(
        self,
        time: Moment | None,
        *,
        action: Action | str | None = None,
        group: Group | str | None = None,
    ) -> Self:
        """Sets another deadline of the task, an action or a group; None removes it."""
        deadline = None if time is None else self._moment(time)
        of = without_none(
            action=None if action is None else name_of(action),
            group=None if group is None else name_of(group),
        )
        return self._change("set_deadline", deadline=deadline, **of)

    def add_groups(self, *groups: Group) -> Self:
        """Adds groups, made with `irc.Group(…)`."""
        return self._change("add_groups", groups=list(groups))

    def cancel_groups(self, *groups: Group | str) -> Self:
        """Cancels groups."""
        return self._change("cancel_groups", groups=[name_of(group) for group in groups])

    def observe(
        self,
        action: Action | str,
        *,
        started: Moment | None = None,
        finished: Moment | None = None,
        status: ObservedStatus | None = None,
        expected_end: Moment | None = None,
        mode: str | None = None,
        resources: Sequence[Resource | str] = (),
        occurrence: int = 1,
    ) -> Self:
        """Adds an observation: what really happened to an action, as of the event's time.

        `status` is `"not_begun"`, `"running"`, `"finished"` or `"failed"` then.
        """
        seen: dict[str, Any] = {"occurrence": occurrence} if occurrence != 1 else {}
        times = without_none(started=started, finished=finished, expected_end=expected_end)
        seen |= {name: self._moment(time) for name, time in times.items()}
        seen |= without_none(status=status, mode=mode)
        if resources:
            seen["resources"] = [name_of(resource) for resource in resources]
        return self._change("observe", action=name_of(action), **seen)

    # --- order, resources, state, aims --------------------------------------------------------

    def add_precedence(
        self,
        before: Action | str,
        after: Action | str,
        *,
        min_lag: Length = 0,
        max_lag: Length | None = None,
        type: PrecedenceType = "finish-start",
    ) -> Self:
        """Adds a precedence; see `Action.before`."""
        fields = precedence_fields(before, after, min_lag, max_lag, type)
        return self._change("add_precedence", precedence=[fields])

    def remove_precedence(self, before: Action | str, after: Action | str) -> Self:
        """Removes all precedences between two actions."""
        fields = {"before": name_of(before), "after": name_of(after)}
        return self._change("remove_precedence", precedence=[fields])

    def add_resources(self, *resources: Resource) -> Self:
        """Adds resources, made with `irc.Resource(…)`."""
        return self._change("add_resources", resources=list(resources))

    def set_capacity(
        self,
        resource: Resource | str,
        capacity: int,
        *,
        start: Moment | None = None,
        end: Moment | None = None,
    ) -> Self:
        """Sets another capacity of a resource, from the event (or `start`) on, perhaps to `end`."""
        window = without_none(
            **{"from": None if start is None else self._moment(start)},
            to=None if end is None else self._moment(end),
        )
        return self._change("set_capacity", resource=name_of(resource), capacity=capacity, **window)

    def add_state(self, *variables: StateVariable) -> Self:
        """Adds state variables, made with `irc.StateVariable(…)`."""
        return self._change("add_state", state=list(variables))

    def set_state(self, variable: StateVariable | str, value: AnyValue = True) -> Self:
        """Sets the value of a state variable, or the level of a number: a world change."""
        return self._change("set_state", var=name_of(variable), value=value)

    def set_goals(self, *goals: Goal) -> Self:
        """Replaces all goals."""
        return self._change("set_goals", goals=[goal_fields(goal) for goal in goals])

    def set_objective(self, *names: ObjectiveName | Mapping[str, Any]) -> Self:
        """Sets another objective."""
        return self._change("set_objective", objective=list(names))

    # --- the rest -----------------------------------------------------------------------------

    def _change(self, op: str, **fields: Any) -> Self:
        change = {"op": op, **fields}
        self._check([_written(change)])
        self._changes.append(change)
        return self

    def _check(self, changes: list[dict[str, Any]]) -> IrEvent:
        (event,) = to_events([{**self._head, "changes": changes}], lambda _: (), 0, None)
        return event

    def _moment(self, value: Moment) -> Any:
        return moment(value, None if self._task is None else self._task.ir_head)

    def __eq__(self, other: object) -> bool:
        return self.ir == other.ir if isinstance(other, Event) else NotImplemented

    def __repr__(self) -> str:
        name = "" if self.id is None else f", id={self.id!r}"
        return f"Event({self._head['at']!r}{name}, {len(self._changes)} changes)"


def _written(change: Mapping[str, Any]) -> dict[str, Any]:
    """A change in which elements built in code are replaced by parts of the IR."""
    return {name: _part(value) for name, value in change.items()}


def _part(value: Any) -> Any:
    if isinstance(value, list):
        return [_part(item) for item in value]
    return value.ir if isinstance(value, Element) else value
