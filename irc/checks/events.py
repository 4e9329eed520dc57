"""Checks of an event against the task that it revises.

An event may name elements that the task and earlier changes declare, except actions that can no
longer happen. Whatever depends on the execution (such as whether an action has ended) is checked
there, not here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from types import MappingProxyType
from typing import Any

from irc.checks.structure import (
    DeclaredNames,
    TimeChecks,
    check_action,
    check_lags,
    check_member,
    check_resource,
    check_value,
    check_variable,
    require_kind,
)
from irc.diagnostics import Code, Findings, Report
from irc.diagnostics.source import Pointer, Source
from irc.model import Action, Event, Group, Task
from irc.model.base import write_time
from irc.model.cancellation import ended, is_over
from irc.model.events import (
    AddActions,
    AddGroups,
    AddPrecedence,
    AddResources,
    AddState,
    CancelActions,
    CancelGroups,
    Observe,
    RemovePrecedence,
    SetCapacity,
    SetDeadline,
    SetDuration,
    SetGoals,
    SetRelease,
    SetState,
)
from irc.model.quantities import Number, TimeError
from irc.model.times import format_number


def check_event(
    task: Task, event: Event, at: Pointer = (), *, source: Source | None = None
) -> Report:
    """Every fault of an event for the task it revises; `at` is where it stands in `source`."""
    findings = Findings()
    walk = _Walk(task, DeclaredNames(task, findings), TimeChecks(task.clock, findings))
    walk.event(event, walk.times.point(event.at, "at", (*at, "at")), at)
    return Report(tuple(findings.items), source)


def check_events(task: Task, names: DeclaredNames, times: TimeChecks) -> None:
    """Adds the faults of a task's own events, in the order of their times.

    `names` are those that the task declares; events add to them and take from them.
    """
    moments = [
        times.point(event.at, "at", ("events", i, "at")) for i, event in enumerate(task.events)
    ]
    walk = _Walk(task, names, times)
    for i in sorted(range(len(moments)), key=lambda i: moments[i] or 0):
        walk.event(task.events[i], moments[i], ("events", i))


class _Walk:
    """The ids that exist when an event comes, updated by each of its changes."""

    def __init__(self, task: Task, names: DeclaredNames, times: TimeChecks) -> None:
        self.names, self.times, self.findings = names, times, names.findings
        self.at: Number | None = None
        self.edges = {(edge.before, edge.after) for edge in task.precedence}
        self.optional_group = {
            action: group for group in task.groups if not group.required for action in group.actions
        }
        self.cancelled: set[str] = set()
        self.members: dict[str, int] = {}
        self.groups_of: dict[str, set[str]] = {}
        for group in task.groups:
            self.join(group)

    def event(self, event: Event, at: Number | None, pointer: Pointer) -> None:
        """Checks an event at `at` (None: its time is faulty) and applies its changes to the ids."""
        self.at = at
        for j, change in enumerate(event.changes):
            check = _CHECKS.get(type(change))
            if check is not None:  # An objective can always be set.
                check(self, change, (*pointer, "changes", j))

    def report(self, code: Code, message: str, pointer: Pointer, hint: str) -> None:
        """Adds a finding."""
        self.findings.add(code, message, pointer, hint=hint)

    def declare(self, kind: str, field: str, elements: Sequence[Any], at: Pointer) -> None:
        """Adds new elements, and reports ids that are not new."""
        table = self.names.tables[kind]
        for k, element in enumerate(elements):
            if element.id in table:
                self.report(
                    Code.TAKEN_ID,
                    f"{kind} {element.id!r} is already there",
                    (*at, field, k, "id"),
                    "an id is never used again, not even after a cancellation; choose another",
                )
            table.setdefault(element.id, element)

    def live(self, name: str, pointer: Pointer) -> bool:
        """Whether `name` is an action that can still happen; reports it if not."""
        if not self.names.require("action", name, pointer):
            return False
        if not self._is_over(self.names.actions[name]):
            return True
        self.report(
            Code.OVER,
            f"action {name!r} was cancelled, or its deadline has passed",
            pointer,
            "it can no longer happen; add it again under another id",
        )
        return False

    def _is_over(self, action: Action) -> bool:
        try:
            return self.at is not None and is_over(action, self.at, self.times.clock)
        except TimeError:  # The deadline is faulty, which is reported at its place.
            return False

    def end(self, name: str) -> None:
        """Cancels an action, and removes each group whose last action this was."""
        action = self.names.actions[name]
        self.cancelled.add(name)
        if self.at is not None and not self._is_over(action):
            with suppress(TimeError):  # Reported at the place of its deadline.
                self.names.actions[name] = ended(action, self.at, self.times.clock)
        for group in self.groups_of.pop(name, set()):
            self.members[group] -= 1
            if not self.members[group]:
                self.names.groups.pop(group, None)

    def join(self, group: Group) -> None:
        """Records the members of a group."""
        members = set(group.actions)
        self.members[group.id] = len(members)
        for name in members:
            self.groups_of.setdefault(name, set()).add(group.id)

    def take_back(self, group: Group) -> None:
        """Cancels a group, with the members that are in no other group."""
        del self.names.groups[group.id]
        for name in set(group.actions):
            others = self.groups_of.get(name, set())
            others.discard(group.id)
            if self.optional_group.get(name) == group:
                del self.optional_group[name]
            if not others and name in self.names.actions:
                self.end(name)


def _add_actions(walk: _Walk, change: AddActions, at: Pointer) -> None:
    walk.declare("action", "actions", change.actions, at)
    for k, action in enumerate(change.actions):
        check_action(action, (*at, "actions", k), walk.names, walk.times, walk.findings)


def _cancel_actions(walk: _Walk, change: CancelActions, at: Pointer) -> None:
    for k, name in enumerate(change.actions):
        if walk.live(name, (*at, "actions", k)):
            walk.end(name)


def _set_duration(walk: _Walk, change: SetDuration, at: Pointer) -> None:
    walk.times.duration(change.duration, f"action {change.action!r}", (*at, "duration"))
    place = (*at, "action")
    if walk.live(change.action, place) and walk.names.actions[change.action].modes:
        walk.report(
            Code.UNSUITED_CHANGE,
            f"action {change.action!r} has modes, each with a duration of its own",
            place,
            "cancel it, and add the changed action under another id",
        )


def _add_precedence(walk: _Walk, change: AddPrecedence, at: Pointer) -> None:
    for k, edge in enumerate(change.precedence):
        place: Pointer = (*at, "precedence", k)
        if edge.before == edge.after:
            walk.report(
                Code.SELF_EDGE,
                f"action {edge.before!r} cannot precede itself",
                place,
                "remove this precedence, or name the action that was meant",
            )
        for field, name in (("before", edge.before), ("after", edge.after)):
            if walk.names.require("action", name, (*place, field)):
                _require_at_most_once(walk, name, "a precedence cannot name it", (*place, field))
        if edge.max_lag is not None:
            check_lags(edge.min_lag, edge.max_lag, place, walk.times)
        walk.edges.add((edge.before, edge.after))


def _require_at_most_once(walk: _Walk, name: str, so: str, at: Pointer) -> bool:
    greatest = walk.names.actions[name].occurrence_bounds[1]
    if greatest is not None and greatest <= 1:
        return True
    walk.report(
        Code.OCCURRENCE,
        f"action {name!r} may occur more than once, so {so}",
        at,
        f"name an action that occurs at most once instead of {name!r}",
    )
    return False


def _remove_precedence(walk: _Walk, change: RemovePrecedence, at: Pointer) -> None:
    for k, edge in enumerate(change.precedence):
        place: Pointer = (*at, "precedence", k)
        before = walk.names.require("action", edge.before, (*place, "before"))
        after = walk.names.require("action", edge.after, (*place, "after"))
        if not before or not after:
            continue
        key = (edge.before, edge.after)
        if key not in walk.edges or not walk.cancelled.isdisjoint(key):
            turned = (edge.after, edge.before) in walk.edges
            walk.report(
                Code.NOTHING_TO_REMOVE,
                f"there is no precedence of {edge.before!r} before {edge.after!r}",
                place,
                "swap the two actions" if turned else "leave this out",
            )
        walk.edges.discard(key)


def _add_resources(walk: _Walk, change: AddResources, at: Pointer) -> None:
    walk.declare("resource", "resources", change.resources, at)
    for k, resource in enumerate(change.resources):
        check_resource(resource, (*at, "resources", k), walk.times, walk.findings)


def _set_capacity(walk: _Walk, change: SetCapacity, at: Pointer) -> None:
    place = (*at, "resource")
    if walk.names.require("resource", change.resource, place):
        resource = walk.names.resources[change.resource]
        require_kind(resource, "renewable", "set_capacity", place, walk.names)
    begin = walk.times.point(change.from_, "from", (*at, "from"))
    end = walk.times.point(change.to, "to", (*at, "to"))
    if end is None:
        return
    if begin is not None and begin >= end:
        walk.report(
            Code.EMPTY_RANGE,
            f"the window from {format_number(begin)} to {format_number(end)} is empty",
            (*at, "to"),
            "it must end after it begins",
        )
    elif walk.at is not None and end <= walk.at:
        walk.report(
            Code.EVENT_TIME,
            f"the window ends at {format_number(end)}, and the event is at "
            f"{format_number(walk.at)}, so the change has no effect",
            (*at, "to"),
            "an event changes only what is after it; correct the window or the event's time",
        )


def _set_deadline(walk: _Walk, change: SetDeadline, at: Pointer) -> None:
    walk.times.point(change.deadline, "deadline", (*at, "deadline"))
    if change.action is not None and change.group is not None:
        walk.report(
            Code.UNSUITED_CHANGE,
            "this sets the deadline of both an action and a group",
            (*at, "group"),
            "write a change for each of the two",
        )
    if change.group is not None:
        walk.names.require("group", change.group, (*at, "group"))
    if change.action is None or not walk.live(change.action, (*at, "action")):
        return
    action = walk.names.actions[change.action]
    walk.names.actions[change.action] = action.model_copy(update={"deadline": change.deadline})


def _set_release(walk: _Walk, change: SetRelease, at: Pointer) -> None:
    walk.live(change.action, (*at, "action"))
    walk.times.point(change.release, "release", (*at, "release"))


def _add_groups(walk: _Walk, change: AddGroups, at: Pointer) -> None:
    walk.declare("group", "groups", change.groups, at)
    for k, group in enumerate(change.groups):
        walk.join(group)
        for name in ("deadline", "due"):
            walk.times.point(getattr(group, name), name, (*at, "groups", k, name))
        for j, member in enumerate(group.actions):
            place: Pointer = (*at, "groups", k, "actions", j)
            if walk.live(member, place):
                action = walk.names.actions[member]
                check_member(group, action, place, walk.optional_group, walk.findings)


def _cancel_groups(walk: _Walk, change: CancelGroups, at: Pointer) -> None:
    for k, name in enumerate(change.groups):
        if walk.names.require("group", name, (*at, "groups", k)):
            walk.take_back(walk.names.groups[name])


def _set_goals(walk: _Walk, change: SetGoals, at: Pointer) -> None:
    for k, goal in enumerate(change.goals):
        if isinstance(goal, str):
            walk.names.require("action", goal, (*at, "goals", k))
        else:
            check_value(goal, (*at, "goals", k), walk.names)


def _set_state(walk: _Walk, change: SetState, at: Pointer) -> None:
    check_value(change, at, walk.names)


def _add_state(walk: _Walk, change: AddState, at: Pointer) -> None:
    walk.declare("state variable", "state", change.state, at)
    for k, variable in enumerate(change.state):
        check_variable(variable, (*at, "state", k), walk.times, walk.findings)


def _observe(walk: _Walk, change: Observe, at: Pointer) -> None:
    place = (*at, "action")
    if walk.names.require("action", change.action, place):
        _require_occurrence(walk, change, at)
    if change.started is None and change.finished is None:
        walk.report(
            Code.UNSUITED_CHANGE,
            f"this observation of {change.action!r} has no time",
            at,
            'add "started" or "finished"',
        )
    for field in ("started", "finished"):
        moment = walk.times.point(getattr(change, field), field, (*at, field))
        if moment is not None and walk.at is not None and moment > walk.at:
            walk.report(
                Code.EVENT_TIME,
                f"{change.action!r} {field} at {format_number(moment)}, "
                f"after the event that reports it ({format_number(walk.at)})",
                (*at, field),
                "only what has happened can be observed; correct one of the two times",
            )
    _require_order(walk, change, at)


def _require_occurrence(walk: _Walk, change: Observe, at: Pointer) -> None:
    greatest = walk.names.actions[change.action].occurrence_bounds[1]
    if greatest is not None and change.occurrence > max(1, greatest):
        often = "at most once" if greatest <= 1 else f"at most {greatest} times"
        walk.report(
            Code.UNSUITED_CHANGE,
            f"{change.action!r} occurs {often}, so it has no occurrence {change.occurrence}",
            (*at, "occurrence"),
            "leave the occurrence out" if greatest <= 1 else "occurrences are numbered by start",
        )


def _require_order(walk: _Walk, change: Observe, at: Pointer) -> None:
    if change.started is None or change.finished is None:
        return
    try:
        started, finished = map(walk.times.clock.number, (change.started, change.finished))
    except TimeError:
        return  # Reported already.
    if finished < started:
        walk.report(
            Code.EVENT_TIME,
            f"{change.action!r} finished at {write_time(change.finished)}, "
            f"before it started at {write_time(change.started)}",
            (*at, "finished"),
            "swap the two, or correct one of them",
        )


_CHECKS: Mapping[type, Callable[[_Walk, Any, Pointer], None]] = MappingProxyType(
    {
        AddActions: _add_actions,
        CancelActions: _cancel_actions,
        SetDuration: _set_duration,
        AddPrecedence: _add_precedence,
        RemovePrecedence: _remove_precedence,
        AddResources: _add_resources,
        SetCapacity: _set_capacity,
        SetDeadline: _set_deadline,
        SetRelease: _set_release,
        AddGroups: _add_groups,
        CancelGroups: _cancel_groups,
        SetGoals: _set_goals,
        SetState: _set_state,
        AddState: _add_state,
        Observe: _observe,
    }
)
