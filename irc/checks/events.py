"""Checks of an event against the task that it revises.

An event may name elements that the task and earlier changes declare, except actions that can no
longer happen. Whatever depends on the execution (such as whether an action has ended) is checked
there, not here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from irc.checks.resolution import check_changed_durations
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
from irc.diagnostics import Code, Findings, Report, did_you_mean
from irc.diagnostics.source import Pointer, Source
from irc.model import Action, DurationRange, Event, Group, Resource, Task
from irc.model.base import write_time
from irc.model.cancellation import ended, is_over, latest, repetition_id
from irc.model.details import Lapsed
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
    RetryAction,
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
        self.task = task
        self.edges = {(edge.before, edge.after) for edge in task.precedence}
        self.optional_group = {
            action: group for group in task.groups if not group.required for action in group.actions
        }
        self.cancelled: set[str] = set()
        self.lapsed = {had.action: had for had in task.lapsed}
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
            "it can no longer happen; `retry_action` does it again"
            if name in self.lapsed
            else "it can no longer happen; add it again under another id",
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
        if name not in self.lapsed:
            groups = [g for g in self.names.groups.values() if name in g.actions]
            self.lapsed[name] = Lapsed(action=name, occurs=action.occurs, groups=tuple(groups))
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
        check_changed_durations(action, walk.task, (*at, "actions", k), walk.findings)
        check_action(action, (*at, "actions", k), walk.names, walk.times, walk.findings)


def _cancel_actions(walk: _Walk, change: CancelActions, at: Pointer) -> None:
    for k, name in enumerate(change.actions):
        if walk.live(name, (*at, "actions", k)):
            walk.end(name)


def _retry_action(walk: _Walk, change: RetryAction, at: Pointer) -> None:
    old, place = change.action, (*at, "action")
    if not walk.names.require("action", old, place):
        return
    had = walk.lapsed.get(old)
    if had is not None and had.repetition is not None:
        walk.report(
            Code.OVER,
            f"action {old!r} is done again already, as {had.repetition!r}",
            place,
            f"to do it once more, name {latest(old, walk.lapsed)!r}",
        )
        return
    if had is None and not walk.live(old, place):
        return
    action = walk.names.actions[old]
    if _is_counted(action if had is None else action.model_copy(update={"occurs": had.occurs})):
        walk.report(
            Code.UNSUITED_CHANGE,
            f"action {old!r} may occur more than once, and how often is bounded: what is left to "
            "be done is not known",
            place,
            "add an action for each occurrence that is still needed",
        )
        return
    _require_part_done(walk, change, action, at)
    _repeat(walk, change, action, at)


def _is_counted(action: Action) -> bool:
    return action.may_repeat and action.occurrence_bounds != (0, None)


def _require_part_done(walk: _Walk, change: RetryAction, action: Action, at: Pointer) -> None:
    """Reports a part that is done which is not a part of the action."""
    done = walk.times.span(change.done, f"what is done of {change.action!r}", (*at, "done"))
    own = next((m for m in action.modes if m.id == change.mode), None)
    if change.mode is not None and own is None:
        known = ", ".join(mode.id for mode in action.modes)
        walk.report(
            Code.UNKNOWN_NAME,
            f"action {change.action!r} has no mode {change.mode!r}",
            (*at, "mode"),
            f"its modes are {known}" if known else "leave the mode out",
        )
        return
    if not done:
        return
    if action.modes and own is None:
        walk.report(
            Code.UNSUITED_CHANGE,
            f"action {change.action!r} has modes, so it must be said in which one this part was "
            "done",
            (*at, "done"),
            'add the mode: "mode": …',
        )
        return
    duration = action.duration if own is None else own.duration
    with suppress(TimeError):  # Reported where the action stands.
        number = walk.times.clock.number
        whole = number(duration.max if isinstance(duration, DurationRange) else duration or 0)
        if done > whole:
            walk.report(
                Code.UNSUITED_CHANGE,
                f"{format_number(done)} of {change.action!r} cannot be done: it takes "
                f"{format_number(whole)}",
                (*at, "done"),
                "if all of it is done, observe that it finished",
            )


def _repeat(walk: _Walk, change: RetryAction, action: Action, at: Pointer) -> None:
    """Puts the repetition in the place of an action, which ends."""
    old, names = change.action, walk.names
    name = change.id or repetition_id(old, names.actions, walk.lapsed.values())
    if name in names.actions:
        walk.report(
            Code.TAKEN_ID,
            f"action {name!r} is already there",
            (*at, "id"),
            "an id is never used again, not even after a cancellation; choose another",
        )
        return
    if old not in walk.lapsed:
        walk.end(old)
    had = walk.lapsed[old]
    walk.lapsed[old] = had.model_copy(update={"repetition": name})
    fresh = {"id": name, "occurs": had.occurs, "deadline": had.deadline, "start": None}
    names.actions[name] = action.model_copy(update=fresh)
    for before, after in list(walk.edges):
        if old in (before, after):
            walk.edges.add((name, after) if before == old else (before, name))
    for edge in had.precedence:
        walk.edges.add((name, edge.after) if edge.before == old else (edge.before, name))
    for group in had.groups:
        there = names.groups.setdefault(group.id, group.model_copy(update={"actions": ()}))
        changed = there.model_copy(update={"actions": (*there.actions, name)})
        names.groups[group.id] = changed
        walk.join(changed)
        if not group.required:
            walk.optional_group.update(dict.fromkeys(changed.actions, changed))


def _set_duration(walk: _Walk, change: SetDuration, at: Pointer) -> None:
    walk.times.duration(change.duration, f"action {change.action!r}", (*at, "duration"))
    check_changed_durations(change, walk.task, at, walk.findings)
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
            check_lags(edge, edge.max_lag, place, walk.times)
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


def _require_one_at_a_time(walk: _Walk, resource: Resource, capacity: int, at: Pointer) -> None:
    """Reports a capacity that a resource with set-ups cannot have."""
    wrong = None
    if resource.setups is not None or resource.no_idle:
        from irc.checks.setups import check_capacity_with_setups

        wrong = check_capacity_with_setups(resource, capacity)
    elif walk.task.sequences:
        from irc.checks.sequences import check_capacity_in_order

        wrong = check_capacity_in_order(walk.task, resource, capacity)
    if wrong is not None:
        hint = "set it to 0 or 1, or add another resource"
        walk.report(Code.UNSUITED_CHANGE, wrong, (*at, "capacity"), hint)


def _set_capacity(walk: _Walk, change: SetCapacity, at: Pointer) -> None:
    place = (*at, "resource")
    if walk.names.require("resource", change.resource, place):
        resource = walk.names.resources[change.resource]
        require_kind(resource, "renewable", "set_capacity", place, walk.names)
        _require_one_at_a_time(walk, resource, change.capacity, at)
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
                before = len(walk.findings.items)
                check_member(group, action, place, walk.optional_group, walk.findings)
                if len(walk.findings.items) > before:
                    _suggest_retry(walk, member)


def _suggest_retry(walk: _Walk, member: str) -> None:
    """Adds to the last finding that a repetition would keep the group that an action is in."""
    group = walk.optional_group.get(member)
    stopped = [
        had.action
        for had in walk.lapsed.values()
        if had.repetition is None and group is not None and group.id in {g.id for g in had.groups}
    ]
    if stopped:
        found = walk.findings.items[-1]
        hint = f"{found.hint}; `retry_action` of {stopped[0]!r} does it again in the same group"
        walk.findings.items[-1] = replace(found, hint=hint)


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
        _require_taken(walk, change, at)
    said = (change.status, change.started, change.finished, change.expected_end, change.mode)
    if not change.resources and all(part is None for part in said):
        walk.report(
            Code.UNSUITED_CHANGE,
            f"this observation of {change.action!r} says nothing",
            at,
            'add "started" or "finished", or a "status" such as "running" or "not_begun"',
        )
    for field in ("started", "finished"):
        moment = walk.times.point(getattr(change, field), field, (*at, field))
        if moment is not None and walk.at is not None and moment > walk.at:
            walk.report(
                Code.EVENT_TIME,
                f"{change.action!r} {field} at {format_number(moment)}, "
                f"after the event that reports it ({format_number(walk.at)})",
                (*at, field),
                'only what has happened can be observed; for what is still to come, "status": '
                '"running" and "expected_end", or "not_begun"',
            )
    expected = walk.times.point(change.expected_end, "expected_end", (*at, "expected_end"))
    if expected is not None and walk.at is not None and expected <= walk.at:
        walk.report(
            Code.EVENT_TIME,
            f"{change.action!r} is expected to end at {format_number(expected)}, "
            f"not after the event that reports it ({format_number(walk.at)})",
            (*at, "expected_end"),
            'give a later time, or leave it out; if it has ended, write "finished"',
        )
    _require_order(walk, change, at)
    _require_one_story(walk, change, at)


_FITS = {
    "not_begun": frozenset[str](),
    "running": frozenset(["started", "expected_end", "mode", "resources"]),
    "finished": frozenset(["started", "finished", "mode", "resources"]),
    "failed": frozenset(["started", "finished", "mode", "resources"]),
}
"""The fields that an observation may have beside each status."""


def _require_one_story(walk: _Walk, change: Observe, at: Pointer) -> None:
    """Reports fields of an observation that contradict its status or each other."""
    status = change.status
    if status is not None:
        for field in ("started", "finished", "expected_end", "mode", "resources"):
            if getattr(change, field) not in (None, ()) and field not in _FITS[status]:
                walk.report(
                    Code.UNSUITED_CHANGE,
                    f"{change.action!r} is reported as {status.replace('_', ' ')}, "
                    f"so it has no {field!r}",
                    (*at, field),
                    "leave one of the two out",
                )
    elif change.finished is not None and change.expected_end is not None:
        walk.report(
            Code.UNSUITED_CHANGE,
            f"{change.action!r} has finished, so it has no 'expected_end'",
            (*at, "expected_end"),
            "leave one of the two out",
        )


def _require_taken(walk: _Walk, change: Observe, at: Pointer) -> None:
    """Reports a mode or resources that the action cannot have."""
    action = walk.names.actions[change.action]
    modes = [mode.id for mode in action.modes]
    if change.mode is not None and change.mode not in modes:
        hint = f"its modes are {', '.join(modes)}" if modes else "leave the mode out"
        walk.report(
            Code.UNKNOWN_NAME,
            f"action {change.action!r} has no mode {change.mode!r}",
            (*at, "mode"),
            did_you_mean(change.mode, modes) or hint,
        )
        return
    uses = [*action.uses, *(u for m in action.modes if change.mode in (None, m.id) for u in m.uses)]
    known = sorted({name for use in uses for name in use.alternatives})
    for k, name in enumerate(change.resources):
        place = (*at, "resources", k)
        if walk.names.require("resource", name, place) and name not in known:
            walk.report(
                Code.UNSUITED_CHANGE,
                f"action {change.action!r} cannot be done by {name!r}",
                place,
                f"it uses {', '.join(known)}" if known else "it uses no resource",
            )


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
        RetryAction: _retry_action,
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
