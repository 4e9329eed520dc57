"""Actions that an event breaks off: those that are done again, and the order that lapses."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from irc.diagnostics import Code, Diagnostic
from irc.diagnostics.listing import and_more
from irc.diagnostics.source import Pointer
from irc.execution.state import ExecutionState
from irc.execution.work_spans import WorkSpans
from irc.model import Action, Event, Precedence, Task
from irc.model.cancellation import latest
from irc.model.details import Lapsed
from irc.model.events import CancelActions, Change, RetryAction, SetCapacity
from irc.model.quantities import Number
from irc.model.times import json_number
from irc.schedule import Entry

_SHOWN = 5
"""Longer lists end in "and N more"."""


def with_repetitions(event: Event, task: Task, running: Collection[Entry]) -> Event:
    """The event with a `retry_action` for each action that runs on a resource that it breaks.

    These are the actions with an `on_failure` that hold a resource of which they hold more than is
    left from the event on, and those that pause, where it has no capacity any more. Those that
    began last are broken off first. `task` is in force before the event.
    """
    at = task.number(event.at)
    actions = {action.id: action for action in task.actions}
    broken: dict[str, RetryAction] = {}
    named = {c.action for c in event.changes if isinstance(c, RetryAction)}
    for change in event.changes:
        if isinstance(change, SetCapacity) and _begins_now(change, task, at):
            for entry in _too_many(change, running, actions, {*broken, *named}):
                action = actions[entry.id]
                broken[entry.id] = _again(action, entry, at, task)
    if not broken:
        return event
    changes: tuple[Change, ...] = (*event.changes, *broken.values())
    return event.model_copy(update={"changes": changes})


def _begins_now(change: SetCapacity, task: Task, at: Number) -> bool:
    return change.from_ is None or task.number(change.from_) <= at


def _too_many(
    change: SetCapacity,
    running: Collection[Entry],
    actions: dict[str, Action],
    gone: Collection[str],
) -> Iterator[Entry]:
    """The running occurrences to break off, so that the others fit the capacity."""
    holding = [e for e in running if e.resources.get(change.resource) and e.id not in gone]
    held = sum(e.resources[change.resource] for e in holding)
    for entry in sorted(holding, key=lambda e: (e.start, e.id), reverse=True):
        if held <= change.capacity:
            return
        action = actions.get(entry.id)
        if action is not None and (action.on_failure is not None or _stands(action, change)):
            held -= entry.resources[change.resource]
            yield entry


def breaks_off(action: Action) -> bool:
    """Whether a running action may be broken off by a change of capacity."""
    return action.on_failure is not None or action.breaks == "pause"


def _stands(action: Action, change: SetCapacity) -> bool:
    """Whether an action pauses on a resource from now on and never goes on."""
    return action.breaks == "pause" and change.capacity == 0 and change.to is None


def _again(action: Action, entry: Entry, at: Number, task: Task) -> RetryAction:
    fields: dict[str, object] = {"op": "retry_action", "action": action.id}
    if action.on_failure != "restart":
        fields["done"] = json_number(WorkSpans(task, (entry.start, at)).work(action, entry, at))
        if action.modes:
            fields["mode"] = entry.mode
    return RetryAction.model_validate(fields)


def lapses(
    before: Task, after: Task, event: Event, ended: Collection[str]
) -> tuple[Diagnostic, ...]:
    """Warnings on what lapses with actions that an event has cancelled and not repeated.

    `before` and `after` are the tasks in force. `ended` are the actions that have ended: what they
    had with the cancelled ones binds nothing any more.
    """
    places = {
        name: ("changes", k, "actions", i)
        for k, change in enumerate(event.changes)
        if isinstance(change, CancelActions)
        for i, name in enumerate(change.actions)
    }
    known = {had.action for had in before.lapsed}
    lapsed = {had.action: had for had in after.lapsed}
    notes = []
    for had in after.lapsed:
        if had.action not in known and had.repetition is None:
            words = _in_words(had, after, lapsed, ended)
            if words:
                notes.append(_warning(had.action, words, places.get(had.action, ())))
    return tuple(notes)


def _in_words(
    had: Lapsed, after: Task, lapsed: dict[str, Lapsed], ended: Collection[str]
) -> list[str]:
    words = []
    before = [e.before for e in had.precedence if e.after == had.action]
    following = [e.after for e in had.precedence if e.before == had.action]
    for names, word in ((before, "after"), (following, "before")):
        open_ones = dict.fromkeys(latest(name, lapsed) for name in names)
        left = [repr(n) for n in open_ones if n not in lapsed and n not in ended]
        if left:
            words.append(f"that it comes {word} {and_more(left[:_SHOWN], len(left))}")
    groups = {group.id for group in after.groups}
    left = [repr(group.id) for group in had.groups if group.id in groups]
    if left:
        words.append(f"its part in {and_more(left[:_SHOWN], len(left))}")
    if had.goal:
        words.append("the goal that it occurs")
    return words


def _warning(action: str, words: list[str], at: Pointer) -> Diagnostic:
    return Diagnostic(
        Code.LAPSED,
        f"action {action!r} is cancelled, and with it lapses {', and '.join(words)}",
        at,
        hint=f"`retry_action` of {action!r} does it again and keeps all of this",
    )


def without_the_past(
    before: Task, after: Task, state: ExecutionState
) -> tuple[Task, tuple[Diagnostic, ...]]:
    """(a task without precedences that a new repetition can no longer meet, warnings on them).

    Those are the ones by which it comes before what has happened already. `before` and `after` are
    the task before and after an event.
    """
    known = {had.repetition for had in before.lapsed}
    new = {had.repetition for had in after.lapsed} - known - {None}
    if not new:
        return after, ()
    ended = {entry.id for entry in state.completed}
    begun = ended | {entry.id for entry in state.running}
    lost = [e for e in after.precedence if e.before in new and _has_passed(e, begun, ended)]
    if not lost:
        return after, ()
    notes = []
    for name in dict.fromkeys(edge.before for edge in lost):
        others = dict.fromkeys(repr(edge.after) for edge in lost if edge.before == name)
        listed = and_more(list(others)[:_SHOWN], len(others))
        message = f"that {name!r} comes before {listed} lapses: it is too late for that"
        notes.append(Diagnostic(Code.LAPSED, message, hint=_BEGUN))
    kept = tuple(edge for edge in after.precedence if edge not in lost)
    return after.model_copy(update={"precedence": kept}), tuple(notes)


_BEGUN = "what has begun goes on; cancel it, and do it again too, to keep the order"


def _has_passed(edge: Precedence, begun: Collection[str], ended: Collection[str]) -> bool:
    """Whether what a precedence makes wait has happened already."""
    at_end = edge.type in ("finish-finish", "start-finish")
    return edge.after in (ended if at_end else begun)
