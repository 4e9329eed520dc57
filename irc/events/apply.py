"""Revises a task by an event: a pure function from a task to a task."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from irc.checks.events import check_event
from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.events.capacity import with_capacity
from irc.events.observed import (
    Outcome,
    ended_at,
    failures,
    lasting,
    with_length,
    with_start,
    working_time,
    written,
)
from irc.events.repetition import lapsed_of, repetition_of, restored
from irc.events.world import world_change
from irc.model import Action, Event, Group, Precedence, Resource, StateVariable, Task
from irc.model.built import Built, event_of, task_of
from irc.model.cancellation import ended, repetition_id
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
    SetObjective,
    SetRelease,
    SetState,
)
from irc.model.quantities import Number
from irc.model.resolution import pinned

_UNKNOWN: Mapping[str, Number] = MappingProxyType({})


def apply(
    task: Task | Built[Task],
    event: Event | Built[Event],
    starts: Mapping[str, Number] = _UNKNOWN,
    *,
    source: Source | None = None,
) -> Task:
    """The task as revised by `event`, which is no longer among its events.

    `starts` has the starts of actions, in the task's unit, for observations of an end alone;
    `source` is the text of the event. Neither task nor event changes. The task must have no faults
    of its own (`irc.check`): only the event is checked here. Raises `InputError` if the event does
    not fit the task.

    >>> import irc
    >>> task = irc.Task()
    >>> boil = task.action("boil", 4)
    >>> apply(task, irc.Event(1).set_duration(boil, 6)).actions[0].duration
    6
    """
    task, event = task_of(task), event_of(event)
    report = check_event(task, event, source=source)
    if not report.ok:
        raise InputError(report)
    editor = _TaskEditor(task, task.number(event.at), starts)
    for i, change in enumerate(event.changes):
        try:
            _OPERATIONS[type(change)](editor, change)
        except _NoStart as error:
            raise InputError(_no_start(error.action, i, source)) from None
    return editor.revised(event)


def without_observations(task: Task, event: Event) -> Task:
    """The task as an event revises it, but for what the event has observed.

    The event must fit the task (`irc.checks.events.check_event`).
    """
    if event not in task.events and all(isinstance(c, Observe) for c in event.changes):
        return task
    editor = _TaskEditor(task, task.number(event.at), _UNKNOWN)
    for change in event.changes:
        if not isinstance(change, Observe):
            _OPERATIONS[type(change)](editor, change)
    return editor.revised(event)


def with_observations(task: Task, outcomes: Sequence[Outcome]) -> Task:
    """The task with what was observed of its actions, as `apply` writes it."""
    if not outcomes:
        return task
    editor = _TaskEditor(task, 0, _UNKNOWN)
    for outcome in outcomes:
        action = editor.actions.get(outcome.action)
        if action is not None:
            editor.actions[outcome.action] = written(task, action, outcome)
    for name, failed in failures(outcomes).items():
        if name in editor.actions:
            editor.cancel([name], at=failed)
    return editor.revised(None)


class _NoStart(Exception):
    """An observation names the end of an action whose start is not known."""

    def __init__(self, action: str) -> None:
        super().__init__(action)
        self.action = action


def _no_start(action: str, change: int, source: Source | None) -> Report:
    findings = Findings()
    findings.add(
        Code.UNSUITED_CHANGE,
        f"the start of action {action!r} is not known, so its end gives no duration",
        ("changes", change, "finished"),
        hint='add the start: "started": …',
    )
    return Report(tuple(findings.items), source)


class _TaskEditor:
    """A task that is being revised. Elements keep their order; new ones come last."""

    def __init__(self, task: Task, at: Number, starts: Mapping[str, Number]) -> None:
        self.task, self.at, self.starts = pinned(task), at, starts
        self.clock = task.clock
        self.actions: dict[str, Action] = {a.id: a for a in task.actions}
        self.resources: dict[str, Resource] = {r.id: r for r in task.resources}
        self.state: dict[str, StateVariable] = {s.id: s for s in task.state}
        self.groups: dict[str, Group] = {g.id: g for g in task.groups}
        self.precedence: list[Precedence] = list(task.precedence)
        self.lapsed: dict[str, Lapsed] = {had.action: had for had in task.lapsed}
        self.whole: dict[str, Any] = {}
        """Fields of the task that are replaced as a whole."""

    def revised(self, event: Event | None) -> Task:
        """The task after the changes."""
        fields: dict[str, Any] = {
            "actions": tuple(self.actions.values()),
            "resources": tuple(self.resources.values()),
            "state": tuple(self.state.values()),
            "groups": tuple(self.groups.values()),
            "precedence": tuple(self.precedence),
            "lapsed": tuple(self.lapsed.values()),
            "events": self.task.events if event is None else _without(self.task.events, event),
            **self.whole,
        }
        if self.task.couplings or self.task.select or self.task.sequences:
            from irc.events.together import couplings_left, selections_left, sequences_left

            left = {a for a in self.actions if a not in self.lapsed}
            fields["couplings"] = couplings_left(self.task.couplings, left)
            fields["select"] = selections_left(self.task.select, left | set(self.groups))
            fields["sequences"] = sequences_left(self.task.sequences, left)
        changed = {k: v for k, v in fields.items() if v != getattr(self.task, k)}
        # The places of its elements in the text are no longer valid.
        return self.task.model_copy(update=changed).with_source(None)

    def change_action(self, name: str, **fields: Any) -> None:
        self.actions[name] = self.actions[name].model_copy(update=fields)

    def cancel(self, names: Collection[str], at: Number | None = None) -> None:
        """Cancels actions, and removes them from precedences, groups and goals."""
        gone = frozenset(names)
        goals = self.whole.get("goals", self.task.goals)
        for name in self.actions:
            if name in gone and name not in self.lapsed:
                groups = self.groups.values()
                had = lapsed_of(self.actions[name], self.precedence, groups, goals)
                self.lapsed[name] = had
        when = self.at if at is None else at
        for name in gone:
            self.actions[name] = ended(self.actions[name], when, self.clock)
        self.precedence = [e for e in self.precedence if gone.isdisjoint((e.before, e.after))]
        for group in [g for g in self.groups.values() if not gone.isdisjoint(g.actions)]:
            left = tuple(a for a in group.actions if a not in gone)
            if not left:
                del self.groups[group.id]
            else:
                self.groups[group.id] = group.model_copy(update={"actions": left})
        self.whole["goals"] = tuple(g for g in goals if not isinstance(g, str) or g not in gone)

    def repeat(self, change: RetryAction) -> None:
        """Adds the repetition of an action, which is cancelled if it is not over."""
        old = change.action
        if old not in self.lapsed:
            self.cancel([old])
        had = self.lapsed[old]
        name = change.id or repetition_id(old, self.actions, self.lapsed.values())
        action = repetition_of(self.actions[old], had, change, name, self.at, self.clock)
        self.lapsed[old] = had.model_copy(update={"repetition": name})
        self.actions[name] = action
        found = restored(had, name, self.lapsed, lambda other: other in self.lapsed)
        self.precedence += [edge for edge in found.precedence if edge not in self.precedence]
        for other, edges in found.waiting.items():
            known = self.lapsed[other]
            all_edges = (*known.precedence, *edges)
            self.lapsed[other] = known.model_copy(update={"precedence": all_edges})
        for group in had.groups:
            now = self.groups.get(group.id)
            members = () if now is None else now.actions
            changed = (now or group).model_copy(update={"actions": (*members, name)})
            self.groups[group.id] = changed
        if had.goal:
            self.whole["goals"] = (*self.whole.get("goals", self.task.goals), name)


def _without(events: tuple[Event, ...], event: Event) -> tuple[Event, ...]:
    """The events without the first that equals `event`."""
    place = events.index(event) if event in events else len(events)
    return (*events[:place], *events[place + 1 :])


def _add(table: dict[str, Any], elements: Iterable[Any]) -> None:
    table.update((element.id, element) for element in elements)


def _cancel_groups(editor: _TaskEditor, change: CancelGroups) -> None:
    """Removes groups and cancels their members, except members of other groups."""
    taken_back = [editor.groups.pop(name) for name in dict.fromkeys(change.groups)]
    gone = set(change.groups)
    for name, had in editor.lapsed.items():
        left = tuple(group for group in had.groups if group.id not in gone)
        if len(left) < len(had.groups):
            editor.lapsed[name] = had.model_copy(update={"groups": left})
    wanted = {action for group in editor.groups.values() for action in group.actions}
    editor.cancel({a for group in taken_back for a in group.actions} - wanted)


def _remove_precedence(editor: _TaskEditor, change: RemovePrecedence) -> None:
    removed = {(edge.before, edge.after) for edge in change.precedence}
    editor.precedence = [e for e in editor.precedence if (e.before, e.after) not in removed]


def _set_capacity(editor: _TaskEditor, change: SetCapacity) -> None:
    clock = editor.clock
    start = editor.at if change.from_ is None else max(editor.at, clock.number(change.from_))
    end = None if change.to is None else clock.number(change.to)
    resource = editor.resources[change.resource]
    known = (c for c in editor.task.calendars if c.id == resource.calendar)
    calendar = next(known, None)
    editor.resources[resource.id] = with_capacity(
        resource, change.capacity, start, end, clock, calendar
    )


def _set_deadline(editor: _TaskEditor, change: SetDeadline) -> None:
    if change.action is not None:
        editor.change_action(change.action, deadline=change.deadline)
    elif change.group is not None:
        group = editor.groups[change.group]
        editor.groups[group.id] = group.model_copy(update={"deadline": change.deadline})
    else:
        editor.whole["deadline"] = change.deadline


def _set_state(editor: _TaskEditor, change: SetState) -> None:
    fact, order = world_change(
        editor.state[change.var], change.value, editor.at, editor.actions, editor.clock
    )
    editor.actions[fact.id] = fact
    editor.precedence += [] if order is None else [order]


def _observe(editor: _TaskEditor, change: Observe) -> None:
    """Writes an observation into the task: as a fixed start, an exact duration, a cancellation.

    A task cannot express this for one of several occurrences: only the history has it.
    """
    name, clock = change.action, editor.clock
    if editor.actions[name].may_repeat or change.status == "not_begun":
        return
    if change.started is not None:
        started = clock.number(change.started)
        editor.actions[name] = with_start(editor.actions[name], started, clock)
    end = clock.number(change.finished) if change.finished is not None else editor.at
    if change.status == "failed":
        _fail(editor, name, end)
    elif change.finished is not None or change.status == "finished":
        _end_at(editor, name, end)
    elif change.expected_end is not None:
        _end_at(editor, name, clock.number(change.expected_end))
    elif change.status == "running":
        started_at = _start_of(editor, name)
        if started_at is not None:
            action = editor.actions[name]
            work = working_time(editor.task, action, started_at, editor.at)
            editor.actions[name] = lasting(action, work, clock)


def _start_of(editor: _TaskEditor, name: str) -> Number | None:
    """The start of an action, if the task or `starts` has it."""
    start = editor.actions[name].start
    return editor.starts.get(name) if start is None else editor.clock.number(start)


def _end_at(editor: _TaskEditor, name: str, finished: Number) -> None:
    started = _start_of(editor, name)
    if started is None or started > finished:
        raise _NoStart(name)
    action = ended_at(editor.actions[name], finished, editor.clock)
    editor.actions[name] = with_length(action, working_time(editor.task, action, started, finished))


def _fail(editor: _TaskEditor, name: str, failed: Number) -> None:
    """Ends an action before it was done, at a time that may have passed."""
    started = _start_of(editor, name)
    if started is not None and started <= failed:
        action = editor.actions[name]
        work = working_time(editor.task, action, started, failed)
        editor.actions[name] = lasting(action, work, editor.clock)
    editor.cancel([name], at=failed)


def _replace(field: str) -> Callable[[_TaskEditor, Any], None]:
    def replace(editor: _TaskEditor, change: Any) -> None:
        editor.whole[field] = getattr(change, field)

    return replace


_OPERATIONS: Mapping[type, Callable[[_TaskEditor, Any], None]] = MappingProxyType(
    {
        AddActions: lambda editor, change: _add(editor.actions, change.actions),
        CancelActions: lambda editor, change: editor.cancel(change.actions),
        SetDuration: lambda editor, c: editor.change_action(c.action, duration=c.duration),
        AddPrecedence: lambda editor, change: editor.precedence.extend(change.precedence),
        RemovePrecedence: _remove_precedence,
        AddResources: lambda editor, change: _add(editor.resources, change.resources),
        SetCapacity: _set_capacity,
        SetDeadline: _set_deadline,
        SetRelease: lambda editor, c: editor.change_action(c.action, release=c.release),
        AddGroups: lambda editor, change: _add(editor.groups, change.groups),
        CancelGroups: _cancel_groups,
        SetGoals: _replace("goals"),
        SetState: _set_state,
        AddState: lambda editor, change: _add(editor.state, change.state),
        SetObjective: _replace("objective"),
        RetryAction: lambda editor, change: editor.repeat(change),
        Observe: _observe,
    }
)
