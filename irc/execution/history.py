"""The schedule that is being carried out, as events and observations change it.

`irc.events.apply` revises the task; here the schedule follows: an observation replaces what was
planned, a new duration moves the end of a running action, a cancellation ends it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from irc.diagnostics import Code, Findings
from irc.diagnostics.source import Pointer
from irc.execution.state import ExecutionState, Key, key_of, state_at
from irc.model import Action, DurationRange, Event, Group, Task
from irc.model.cancellation import is_over
from irc.model.events import (
    AddActions,
    AddGroups,
    CancelActions,
    CancelGroups,
    Observe,
    SetDuration,
    SetGoals,
)
from irc.model.quantities import Number
from irc.model.times import Clock, format_number
from irc.schedule import CANCELLED, Entry, Schedule


@dataclass
class History:
    """Entries by occurrence: completed, running and planned.

    `started` and `finished` are the occurrences with an observed start or end; `cancelled` are ids
    of actions that must not begin any more. `plan` has the entries as planned; events do not
    change it.
    """

    entries: dict[Key, Entry] = field(default_factory=dict)
    started: set[Key] = field(default_factory=set)
    finished: set[Key] = field(default_factory=set)
    cancelled: set[str] = field(default_factory=set)
    plan: Mapping[Key, Entry] = field(default_factory=dict)

    @classmethod
    def of(cls, schedule: Schedule) -> History:
        """The history with the entries of a schedule."""
        entries = {key_of(entry): entry for entry in schedule.entries}
        cancelled = {entry.id for entry in schedule.entries if entry.status == CANCELLED}
        return cls(entries, cancelled=cancelled, plan=dict(entries))

    def copy(self) -> History:
        """Another history with the same contents."""
        return History(
            dict(self.entries),
            set(self.started),
            set(self.finished),
            set(self.cancelled),
            self.plan,
        )

    def state(self, at: Number) -> ExecutionState:
        """The entries that are completed, running and open at `at`."""
        return state_at(Schedule(tuple(self.entries.values())), at, self.started)

    def starts(self, at: Number) -> Mapping[str, Number]:
        """The start of each action that has begun by `at`; of several occurrences the first."""
        return {
            name: entry.start
            for (name, number), entry in self.entries.items()
            if number == 1 and entry.start <= at
        }

    def take(self, task: Task, event: Event, findings: Findings, at: Pointer = ()) -> None:
        """Applies an event that revises `task`; adds contradictions with the history to `findings`.

        The event must fit the task (`irc.checks.events.check_event`). After a fault the history
        cannot be used any more.
        """
        step = _EventStep(
            self,
            task.clock,
            task.time_unit,
            task.number(event.at),
            findings,
            {action.id: action for action in reversed(task.actions)},
            {group.id: group for group in reversed(task.groups)},
        )
        for k, change in enumerate(event.changes):
            follow = _FOLLOWED.get(type(change))
            if follow is not None:
                follow(step, change, (*at, "changes", k))


def length_of(action: Action, entry: Entry, clock: Clock) -> Number | None:
    """The duration of an occurrence: by the task if fixed, by the plan if a range.

    None where the action has modes and the entry gives none.
    """
    duration = action.duration
    if action.modes:
        duration = next((m.duration for m in action.modes if m.id == entry.mode), None)
    if duration is None:
        return None
    if isinstance(duration, DurationRange):
        planned = entry.end - entry.start
        return max(clock.number(duration.min), min(planned, clock.number(duration.max)))
    return clock.number(duration)


@dataclass(frozen=True, slots=True)
class _EventStep:
    """An event that is applied to a history.

    `actions` and `groups` are those of the task, after the previous changes.
    """

    history: History
    clock: Clock
    unit: str
    at: Number
    findings: Findings
    actions: dict[str, Action]
    groups: dict[str, Group]
    keys: dict[str, list[Key]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for key in self.history.entries:
            self.keys.setdefault(key[0], []).append(key)

    def action(self, name: str) -> Action | None:
        return self.actions.get(name)

    def occurrences(self, name: str) -> list[Entry]:
        entries = self.history.entries
        return [entries[key] for key in self.keys.get(name, ()) if key in entries]

    def is_frozen(self, entry: Entry) -> bool:
        return entry.start < self.at or key_of(entry) in self.history.started

    def is_running(self, entry: Entry) -> bool:
        return self.is_frozen(entry) and entry.end > self.at

    def add_finding(self, code: Code, message: str, pointer: Pointer, hint: str) -> None:
        self.findings.add(code, message, pointer, hint=hint)

    def put(self, entry: Entry, **fields: Any) -> None:
        key = key_of(entry)
        if key not in self.history.entries:
            self.keys.setdefault(entry.id, []).append(key)
        self.history.entries[key] = replace(entry, **fields)

    def text(self, time: Number) -> str:
        return f"{format_number(time)} {self.unit}"


def _cancel_actions(step: _EventStep, change: CancelActions, at: Pointer) -> None:
    for k, name in enumerate(change.actions):
        found = step.occurrences(name)
        done = [e for e in found if step.is_frozen(e) and not step.is_running(e)]
        action = step.action(name)
        repeats = action is not None and action.may_repeat
        if done and not repeats:
            step.add_finding(
                Code.ALREADY_DONE,
                f"action {name!r} cannot be cancelled: it ended at {step.text(done[-1].end)}",
                (*at, "actions", k),
                "leave it out; what is done stays done",
            )
        else:
            _end(step, [name])


def _cancel_groups(step: _EventStep, change: CancelGroups, at: Pointer) -> None:
    gone = set(change.groups)
    kept = {name for g in step.groups.values() if g.id not in gone for name in g.actions}
    for k, group_id in enumerate(change.groups):
        group = step.groups.pop(group_id, None)
        members = () if group is None else group.actions
        entries = [e for name in members for e in step.occurrences(name)]
        if (
            members
            and len(entries) == len(members)
            and not any(not step.is_frozen(e) or step.is_running(e) for e in entries)
        ):
            step.add_finding(
                Code.ALREADY_DONE,
                f"group {group_id!r} cannot be cancelled: all of it is done",
                (*at, "groups", k),
                "leave it out; what is done stays done",
            )
        else:
            _end(step, [name for name in members if name not in kept])


def _end(step: _EventStep, names: Iterable[str]) -> None:
    """Ends running actions now, and keeps others from starting."""
    for name in names:
        step.history.cancelled.add(name)
        for entry in step.occurrences(name):
            if step.is_running(entry):
                step.put(entry, end=step.at, status=CANCELLED)
            elif not step.is_frozen(entry):
                del step.history.entries[key_of(entry)]


def _set_duration(step: _EventStep, change: SetDuration, at: Pointer) -> None:
    action = step.action(change.action)
    if action is not None:
        step.actions[action.id] = action.model_copy(update={"duration": change.duration})
    duration = change.duration
    if isinstance(duration, DurationRange):
        least, most = step.clock.number(duration.min), step.clock.number(duration.max)
    else:
        least = most = step.clock.number(duration)
    for entry in step.occurrences(change.action):
        if not step.is_frozen(entry):
            continue
        if not step.is_running(entry):
            if action is not None and not action.may_repeat:
                step.add_finding(
                    Code.ALREADY_DONE,
                    f"action {change.action!r} ended at {step.text(entry.end)}, "
                    f"so it cannot get another duration at {step.text(step.at)}",
                    (*at, "action"),
                    "report what happened with an observation, or leave this out",
                )
            continue
        if entry.start + most < step.at:
            step.add_finding(
                Code.EVENT_TIME,
                f"action {change.action!r} started at {step.text(entry.start)}; with this duration "
                f"it would have ended at {step.text(entry.start + most)}, before the event "
                f"({step.text(step.at)})",
                (*at, "duration"),
                f"at least {step.text(step.at - entry.start)} is needed; to end it now, cancel "
                "it or observe that it finished",
            )
            continue
        length = max(least, step.at - entry.start, min(entry.end - entry.start, most))
        step.put(entry, end=entry.start + length)


def _observe(step: _EventStep, change: Observe, at: Pointer) -> None:
    key = (change.action, change.occurrence)
    entry = step.history.entries.get(key)
    action = step.action(change.action)
    if action is None:
        return  # The event does not fit the task; `check_event` has said so.
    if (entry is not None and entry.status == CANCELLED) or (
        entry is None
        and (change.action in step.history.cancelled or is_over(action, step.at, step.clock))
    ):
        step.add_finding(
            Code.OVER,
            f"action {change.action!r} was cancelled, so it cannot have started or ended since",
            (*at, "action"),
            "leave this out, or add what happened as another action",
        )
        return
    if entry is None and change.occurrence > 1 + len(step.occurrences(change.action)):
        step.add_finding(
            Code.OBSERVED,
            f"occurrence {change.occurrence} of {change.action!r} cannot have begun: "
            f"there are only {len(step.occurrences(change.action))} before it",
            (*at, "occurrence"),
            "occurrences are numbered by start, from 1 on",
        )
        return
    started = None if change.started is None else step.clock.number(change.started)
    finished = None if change.finished is None else step.clock.number(change.finished)
    if _contradicts(step, key, entry, started, finished, at):
        return
    if started is not None:
        step.history.started.add(key)
        entry = entry or Entry(change.action, started, started, occurrence=change.occurrence)
        planned = entry.end - entry.start
        entry = replace(entry, start=started, end=started + planned)
        length = length_of(action, entry, step.clock)
        entry = replace(entry, end=started + (planned if length is None else length))
    if entry is None or (finished is not None and entry.start > finished):
        if action.may_repeat:
            step.add_finding(
                Code.OBSERVED,
                f"when occurrence {change.occurrence} of {change.action!r} started is not known, "
                "so its end gives no duration",
                (*at, "finished"),
                'give its start too: "started": …',
            )
        return  # (`apply` reports this for actions that occur at most once.)
    if finished is not None:
        step.history.started.add(key)
        step.history.finished.add(key)
        entry = replace(entry, end=finished)
    step.put(entry)


def _contradicts(
    step: _EventStep,
    key: Key,
    entry: Entry | None,
    started: Number | None,
    finished: Number | None,
    at: Pointer,
) -> bool:
    """Reports an earlier observation that says something else; returns whether there is one."""
    seen = False
    if entry is None:
        return False
    for field_name, stated, observed, planned in (
        ("started", started, step.history.started, entry.start),
        ("finished", finished, step.history.finished, entry.end),
    ):
        if stated is not None and key in observed and stated != planned:
            step.add_finding(
                Code.OBSERVED,
                f"action {key[0]!r} was already observed to have {field_name} at "
                f"{step.text(planned)}, not {step.text(stated)}",
                (*at, field_name),
                "two observations contradict each other; leave out the wrong one",
            )
            seen = True
    return seen


def _set_goals(step: _EventStep, change: SetGoals, at: Pointer) -> None:
    """Checks that no goal is a cancelled action."""
    for k, goal in enumerate(change.goals):
        if not isinstance(goal, str) or goal not in step.history.cancelled:
            continue
        if all(entry.status == CANCELLED for entry in step.occurrences(goal)):
            step.add_finding(
                Code.OVER,
                f"action {goal!r} was cancelled, so it cannot be a goal",
                (*at, "goals", k),
                "leave it out, or add it again under another id",
            )


def _add_actions(step: _EventStep, change: AddActions, _: Pointer) -> None:
    step.actions.update((action.id, action) for action in change.actions)


def _add_groups(step: _EventStep, change: AddGroups, _: Pointer) -> None:
    step.groups.update((group.id, group) for group in change.groups)


_FOLLOWED: Mapping[type, Callable[[_EventStep, Any, Pointer], None]] = MappingProxyType(
    {
        AddActions: _add_actions,
        AddGroups: _add_groups,
        CancelActions: _cancel_actions,
        CancelGroups: _cancel_groups,
        SetDuration: _set_duration,
        Observe: _observe,
        SetGoals: _set_goals,
    }
)


def ids(entries: Collection[Entry]) -> tuple[str, ...]:
    """The ids of entries, each once, in their order."""
    return tuple(dict.fromkeys(entry.id for entry in entries))
