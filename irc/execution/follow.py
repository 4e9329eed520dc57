"""Applies an event to the history of a running task: to what has begun, and to the plan.

`irc.events.apply` revises the task; here the schedule follows: a new duration moves the end of a
running action, a cancellation ends it. Observations are in `irc.execution.observe`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings
from irc.diagnostics.source import Pointer
from irc.execution.event_step import EventStep
from irc.execution.history import History
from irc.execution.observe import expects, observe
from irc.execution.possible import precedence_reason
from irc.execution.presumed import fix_begun
from irc.execution.state import key_of
from irc.execution.work_spans import WorkSpans
from irc.model import DurationRange, Event, Task
from irc.model.events import (
    AddActions,
    AddGroups,
    AddPrecedence,
    CancelActions,
    CancelGroups,
    Observe,
    RetryAction,
    SetDuration,
    SetGoals,
)
from irc.model.quantities import Number
from irc.schedule import CANCELLED


def follow(
    history: History,
    task: Task,
    event: Event,
    findings: Findings,
    now: Number | None = None,
) -> list[Diagnostic]:
    """Changes a history as an event that revises `task` does. Returns notes on corrections.

    `task` is without observations, and the event must fit it (`irc.checks.events.check_event`). The
    event is at `now`, or is an observation that comes in late. Contradictions with the history are
    added to `findings`; after one the history cannot be used any more.
    """
    at = task.number(event.at)
    history.count += 1
    if not is_observation(event):
        fix_begun(history, task, at)
    history.disturbed = True
    step = EventStep(
        history,
        task,
        at,
        at if now is None else now,
        findings,
        {action.id: action for action in reversed(task.actions)},
        {group.id: group for group in reversed(task.groups)},
    )
    for k, change in enumerate(event.changes):
        follows = _FOLLOWED.get(type(change))
        if follows is not None:
            follows(step, change, ("changes", k))
    return step.notes


def is_observation(event: Event) -> bool:
    """Whether an event only says what has happened."""
    return bool(event.changes) and all(isinstance(change, Observe) for change in event.changes)


def _cancel_actions(step: EventStep, change: CancelActions, at: Pointer) -> None:
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


def _cancel_groups(step: EventStep, change: CancelGroups, at: Pointer) -> None:
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


def _end(step: EventStep, names: Iterable[str]) -> None:
    """Ends running actions now, and keeps others from starting."""
    for name in names:
        step.history.cancelled.setdefault(name, step.at)
        for entry in step.occurrences(name):
            if step.is_running(entry):
                step.put(entry, end=step.at, status=CANCELLED)
            elif not step.is_frozen(entry):
                step.remove(key_of(entry))


def _retry_action(step: EventStep, change: RetryAction, at: Pointer) -> None:
    """Interrupts an action that runs; reports one that has nothing to be done again."""
    name, place = change.action, (*at, "action")
    found = step.occurrences(name)
    stopped = name in step.history.cancelled or any(e.status == CANCELLED for e in found)
    stopped = stopped or any(had.action == name for had in step.task.lapsed)
    running = [e for e in found if step.is_running(e)]
    done = [e for e in found if step.is_frozen(e) and e not in running and e.status is None]
    action = step.action(name)
    if done and not running and not stopped and not (action is not None and action.may_repeat):
        step.add_finding(
            Code.ALREADY_DONE,
            f"action {name!r} ended at {step.text(done[-1].end)}, so there is nothing to do again",
            place,
            'if it failed, observe that first ("status": "failed"); to do it twice, add an action',
        )
    elif not running and not stopped:
        step.add_finding(
            Code.UNSUITED_CHANGE,
            f"action {name!r} has not begun, so there is nothing to do again",
            place,
            "leave this out; it is still planned",
        )
    else:
        _end(step, [name])


def _set_duration(step: EventStep, change: SetDuration, at: Pointer) -> None:
    action = step.action(change.action)
    if action is not None:
        step.actions[action.id] = action.model_copy(update={"duration": change.duration})
    duration = change.duration
    if isinstance(duration, DurationRange):
        least, most = step.clock.number(duration.min), step.clock.number(duration.max)
    else:
        least = most = step.clock.number(duration)
    for entry in step.occurrences(change.action):
        if action is None or not step.is_frozen(entry):
            continue
        if not step.is_running(entry):
            if not action.may_repeat:
                step.add_finding(
                    Code.ALREADY_DONE,
                    f"action {change.action!r} ended at {step.text(entry.end)}, "
                    f"so it cannot get another duration at {step.text(step.at)}",
                    (*at, "action"),
                    'report what happened with an observation ("status": "running" if it has not '
                    "ended), or leave this out",
                )
            continue
        spans = WorkSpans(step.task, (entry.start, entry.end, step.at, least, most))
        done, planned = spans.work(action, entry, step.at), spans.work(action, entry)
        if most < done:
            step.add_finding(
                Code.EVENT_TIME,
                f"action {change.action!r} started at {step.text(entry.start)}; with this duration "
                f"it would have ended at {step.text(spans.end(action, entry, most))}, before the "
                f"event ({step.text(step.at)})",
                (*at, "duration"),
                f"at least {step.text(done)} is needed; to end it now, cancel "
                "it or observe that it finished",
            )
            continue
        end = spans.end(action, entry, max(least, done, min(planned, most)))
        step.put(entry, end=end)
        expects(step, key_of(entry), end)


def _set_goals(step: EventStep, change: SetGoals, at: Pointer) -> None:
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


def _add_actions(step: EventStep, change: AddActions, _: Pointer) -> None:
    step.actions.update((action.id, action) for action in change.actions)


def _add_precedence(step: EventStep, change: AddPrecedence, _: Pointer) -> None:
    """Notes which precedences come after the start that they bind: it has not waited for them."""
    added = (edge for edge in change.precedence if (edge.after, 1) in step.history.begun)
    step.history.came_later |= frozenset(map(precedence_reason, added))


def _add_groups(step: EventStep, change: AddGroups, _: Pointer) -> None:
    step.groups.update((group.id, group) for group in change.groups)


_FOLLOWED: Mapping[type, Callable[[EventStep, Any, Pointer], None]] = MappingProxyType(
    {
        AddActions: _add_actions,
        AddGroups: _add_groups,
        AddPrecedence: _add_precedence,
        CancelActions: _cancel_actions,
        CancelGroups: _cancel_groups,
        RetryAction: _retry_action,
        SetDuration: _set_duration,
        Observe: observe,
        SetGoals: _set_goals,
    }
)
