"""Takes an observation into the history of a running task."""

from __future__ import annotations

from dataclasses import replace

from irc.diagnostics import Code, Diagnostic
from irc.diagnostics.source import Pointer
from irc.execution.event_step import EventStep
from irc.execution.observations import (
    ENDED,
    FAILED,
    NOT_BEGUN,
    RUNNING,
    STARTED,
    Fact,
    Observed,
    facts_of,
    with_fact,
)
from irc.execution.possible import Happened
from irc.execution.presumed import presumed, way_of
from irc.execution.state import Key
from irc.model import Action
from irc.model.cancellation import is_over
from irc.model.events import Observe
from irc.model.quantities import Number
from irc.model.world_changes import is_world_change
from irc.schedule import CANCELLED, Entry

_FIELDS = {
    STARTED: "started",
    NOT_BEGUN: "status",
    RUNNING: "status",
    ENDED: "finished",
    FAILED: "status",
}
"""The field of an observation that says each fact."""


def observe(step: EventStep, change: Observe, at: Pointer) -> None:
    """Takes an observation into the history; adds what contradicts it in the same event."""
    key = (change.action, change.occurrence)
    action = step.action(change.action)
    if action is None:
        return  # The event does not fit the task; `check_event` has said so.
    if is_world_change(action, step.clock):
        step.add_finding(
            Code.UNSUITED_CHANGE,
            f"{change.action!r} is a change of the world, which an event has reported",
            (*at, "action"),
            "set the state to what it really is",
        )
        return
    if action.may_repeat and change.status == "failed":
        step.add_finding(
            Code.UNSUITED_CHANGE,
            f"{change.action!r} may occur several times, so one of them cannot fail: the task "
            "cannot express that",
            (*at, "status"),
            "observe that it finished, and what did not come of it",
        )
        return
    facts = tuple(facts_of(change, step.at, step.history.count, step.clock))
    if _is_over(step, action, key, facts, at) or _is_too_early(step, key, at):
        return
    known = step.history.observed.get(key, Observed())
    for fact in facts:
        known, corrected, by = with_fact(known, fact)
        _note(step, key, fact, corrected, by, at)
    step.history.observed[key] = known
    step.forget()
    if not known.has_begun:
        _require_order(step, action, at)
    elif not _takes_no_time(step, action, key, known, at) and _has_a_start(
        step, action, key, known, change, at
    ):
        _require_order(step, action, at)
        _require_way(step, action, key, known, at)
        _expect_as_planned(step, key, facts)


def expects(step: EventStep, key: Key, end: Number) -> None:
    """Takes the end that an event gives to what was observed to run as the expected one."""
    known = step.history.observed.get(key)
    if known is not None and known.end is not None and known.end.what == RUNNING:
        _expect(step, key, known.end, end)


def _expect(step: EventStep, key: Key, runs: Fact, end: Number) -> None:
    """Adds the expected end to the fact that an occurrence runs."""
    known = step.history.observed[key]
    expecting = replace(runs, expected=end, as_planned=True)
    facts = tuple(expecting if fact is runs else fact for fact in known.facts)
    step.history.observed[key] = Observed(facts)
    step.forget()


def _is_over(
    step: EventStep, action: Action, key: Key, facts: tuple[Fact, ...], at: Pointer
) -> bool:
    """Reports an observation that what was cancelled has gone on since."""
    entry = step.history.entries.get(key)
    since = step.history.cancelled.get(action.id)
    if since is None and entry is None and is_over(action, step.at, step.clock):
        since = step.clock.number(action.deadline or 0)
    if since is None or (entry is not None and entry.status != CANCELLED):
        return False
    if any(f.what == NOT_BEGUN for f in facts):
        return False
    known = step.history.observed.get(key, Observed())
    ended = next((f.time for f in facts if f.what in (ENDED, FAILED)), known.ended)
    goes_on = any(f.what == RUNNING for f in facts) or any(f.time > since for f in facts)
    if not goes_on and (entry is not None or ended is not None):
        return False
    step.add_finding(
        Code.OVER,
        f"action {action.id!r} was cancelled at {step.text(since)}, so it cannot have started or "
        "ended since",
        (*at, "action"),
        "leave this out, or add what happened as another action",
    )
    return True


def _is_too_early(step: EventStep, key: Key, at: Pointer) -> bool:
    """Reports an occurrence before which others must have begun."""
    name, number = key
    before = {k for k in (*step.history.entries, *step.history.observed) if k[0] == name}
    if key in before or number <= 1 + len(before):
        return False
    step.add_finding(
        Code.OBSERVED,
        f"occurrence {number} of {name!r} cannot have begun: there are only {len(before)} before "
        "it",
        (*at, "occurrence"),
        "occurrences are numbered by start, from 1 on",
    )
    return True


def _note(
    step: EventStep,
    key: Key,
    fact: Fact,
    corrected: tuple[Fact, ...],
    by: Fact | None,
    at: Pointer,
) -> None:
    """Reports which of two observations counts; of one event none does."""
    name, unit = key[0], step.task.time_unit
    field = _FIELDS.get(fact.what, "action")
    same = next((old for old in corrected if old.number == fact.number), None)
    if same is not None:
        step.add_finding(
            Code.OBSERVED,
            f"action {name!r} {same.in_words(unit)}, this event says, and {fact.in_words(unit)}",
            (*at, field),
            "two observations of one event contradict each other; leave out the wrong one",
        )
        return
    for old in corrected:
        _add_note(
            step,
            f"action {name!r} {fact.in_words(unit)}; that corrects what was observed at "
            f"{step.text(old.at)}: it {old.in_words(unit)}",
            (*at, field),
        )
    if by is not None:
        _add_note(
            step,
            f"that action {name!r} {fact.in_words(unit)} comes too late: at {step.text(by.at)} it "
            f"was observed that it {by.in_words(unit)}",
            (*at, field),
        )


def _add_note(step: EventStep, message: str, pointer: Pointer) -> None:
    hint = "the later observation counts"
    step.notes.append(Diagnostic(Code.CORRECTED, message, pointer, hint=hint))


def _has_a_start(
    step: EventStep, action: Action, key: Key, known: Observed, change: Observe, at: Pointer
) -> bool:
    """Reports an observation of what has begun where it is not known when it did."""
    if known.started is not None:
        return True
    entry = step.history.entries.get(key)
    latest = min((f.time for f in (known.end,) if f is not None), default=step.at)
    begun = entry is not None and entry.start <= latest
    if begun and entry is not None and known.begin is not None:
        begun = entry.start >= known.begin.time  # It had not begun then.
    if begun and entry is not None and _began_as_planned(step, key, entry):
        return True
    finished = change.finished is not None
    field = "finished" if finished else "status" if change.status is not None else "action"
    so = "so its end gives no duration" if finished else "so neither is how long it has run"
    if action.may_repeat:
        what, code = f"when occurrence {key[1]} of {key[0]!r} started is not known", Code.OBSERVED
    else:
        what, code = f"the start of action {key[0]!r} is not known", Code.UNSUITED_CHANGE
    step.add_finding(code, f"{what}, {so}", (*at, field), 'add the start: "started": …')
    return False


def _began_as_planned(step: EventStep, key: Key, entry: Entry) -> bool:
    """Whether it can have begun when the plan says, beside what else is known."""
    history = step.history
    if not history.assumes or key in history.begun:
        return True
    others = replace(history, observed={k: o for k, o in history.observed.items() if k != key})
    taken = presumed(others, step.task, step.now, step.actions)
    begun = (e for k, e in taken.entries.items() if k in taken.begun and k != key)
    happened = Happened.all_of(step.task, begun, step.now)
    happened.planned = {k: e for k, e in taken.entries.items() if k not in taken.begun}
    return happened.can_begin(entry)


def _takes_no_time(step: EventStep, action: Action, key: Key, known: Observed, at: Pointer) -> bool:
    """Reports an occurrence that would begin and end just now, of an action that may repeat.

    Its start is history, and a task does not fix one of several starts."""
    entry = step.history.entries.get(key)
    planned = None if entry is None else entry.start
    started = planned if known.started is None else known.started
    if not action.may_repeat or started != step.now or known.ended != step.now:
        return False
    step.add_finding(
        Code.UNSUITED_CHANGE,
        f"{action.id!r} may occur several times, so one of them cannot have begun and ended just "
        "when that is observed",
        (*at, "finished"),
        "observe that it started, and later that it finished",
    )
    return True


def _require_order(step: EventStep, action: Action, at: Pointer) -> None:
    """Reports occurrences that would not be numbered by their starts any more."""
    if not action.may_repeat:
        return
    found = sorted(step.occurrences(action.id), key=lambda e: e.occurrence)
    begun = [step.is_frozen(entry) for entry in found]
    in_order = begun == sorted(begun, reverse=True)
    starts = [entry.start for entry, has in zip(found, begun, strict=True) if has]
    if in_order and starts == sorted(starts):
        return
    step.add_finding(
        Code.OBSERVED,
        f"by this the occurrences of {action.id!r} would not have begun in their order",
        (*at, "occurrence"),
        "occurrences are numbered by start, from 1 on: observe the earlier ones first",
    )


def _require_way(step: EventStep, action: Action, key: Key, known: Observed, at: Pointer) -> None:
    """Reports resources that an action cannot be done by, and a mode that is not known."""
    if known.way is None:
        return
    entry = step.history.entries.get(key)
    mode = known.way.mode or (None if entry is None else entry.mode)
    own = next((m for m in action.modes if m.id == mode), None)
    if action.modes and own is None:
        step.add_finding(
            Code.UNSUITED_CHANGE,
            f"the mode of action {key[0]!r} is not known, so neither is what else it uses",
            (*at, "resources"),
            'add the mode: "mode": …',
        )
        return
    uses = [*action.uses, *(own.uses if own is not None else ())]
    planned = {} if entry is None else entry.resources
    if known.way.resources and way_of(uses, known.way.resources, planned) is None:
        named = ", ".join(map(repr, known.way.resources))
        step.add_finding(
            Code.UNSUITED_CHANGE,
            f"action {key[0]!r} cannot be done by {named} alone: that does not say what it uses",
            (*at, "resources"),
            "name one resource for each use that has a choice, and none twice",
        )


def _expect_as_planned(step: EventStep, key: Key, facts: tuple[Fact, ...]) -> None:
    """Expects what runs, and need not have ended yet, to end as planned."""
    known = step.history.observed[key]
    if known.end is None or known.end not in facts or known.end.what != RUNNING:
        return
    if known.end.expected is None:
        others = tuple(fact for fact in known.facts if fact is not known.end)
        unseen = {**step.history.observed, key: Observed(others)}
        without = replace(step.history, observed=unseen)
        entry = presumed(without, step.task, step.now, step.actions).entries.get(key)
        if entry is not None and entry.end > step.at:
            _expect(step, key, known.end, entry.end)
