"""Writes what was observed of actions into their task: starts, durations, failures."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import Any, NamedTuple

from irc.model import Action, DurationRange, Task
from irc.model.quantities import Number, exact
from irc.model.times import Clock


class Outcome(NamedTuple):
    """The known facts about an action that occurs at most once, in the task's unit.

    `started` is an observed start. `length` is how long it took, or takes as far as is known;
    `at_least`: how long it takes at least. `failed` is when it failed, `began` its start, observed
    or planned, and `resources` those that it held, if that is known.
    """

    action: str
    started: Number | None = None
    length: Number | None = None
    at_least: Number | None = None
    failed: Number | None = None
    began: Number = 0
    resources: tuple[str, ...] | None = None


def with_start(action: Action, started: Number, clock: Clock) -> Action:
    """The action with an observed start, and without the limits that this start breaks."""
    fields: dict[str, Any] = {"start": started}
    if clock.number(action.release) > started:  # It started before its release.
        fields["release"] = started
    latest = action.latest_start
    if latest is not None and clock.number(latest) < started:
        fields["latest_start"] = started
    return action.model_copy(update=fields)


def working_time(
    task: Task,
    action: Action,
    start: Number,
    end: Number,
    resources: tuple[str, ...] | None = None,
) -> Number:
    """How much of an action's time was work: what lies between its start and its end, less pauses.

    `resources` are those that it took. Where these are not known, the first that it might have
    taken count.
    """
    if action.breaks != "pause" or start >= end:
        return end - start
    from irc.validation.open_times import Calendars, time_in

    calendars = Calendars(task, task.clock, end)
    closed = [] if action.calendar is None else [calendars.closed(action.calendar)]
    taken = {use.alternatives[0] for use in action.uses if use.alternatives}
    taken = taken if resources is None else set(resources)
    closed += [calendars.without_capacity(r) for r in task.resources if r.id in taken]
    return exact(Fraction(end - start - time_in(closed, start, end)))


def ended_at(action: Action, end: Number, clock: Clock) -> Action:
    """The action without an earliest end that its observed end breaks."""
    earliest = action.earliest_end
    if earliest is None or clock.number(earliest) <= end:
        return action
    return action.model_copy(update={"earliest_end": end})


def with_length(action: Action, length: Number) -> Action:
    """The action with an exact duration, in every mode."""
    return _with_durations(action, lambda _: length)


def lasting(action: Action, at_least: Number, clock: Clock) -> Action:
    """The action with no shorter duration than this, in every mode."""

    def longer(duration: Any) -> Any:
        if not isinstance(duration, DurationRange):
            return max(at_least, clock.number(duration))
        least, most = clock.number(duration.min), clock.number(duration.max)
        if most <= at_least:
            return at_least
        return duration if least >= at_least else DurationRange(min=at_least, max=duration.max)

    return _with_durations(action, longer)


def _with_durations(action: Action, change: Callable[[Any], Any]) -> Action:
    if action.modes:
        modes = tuple(m.model_copy(update={"duration": change(m.duration)}) for m in action.modes)
        return action.model_copy(update={"modes": modes})
    return action.model_copy(update={"duration": change(action.duration)})


def written(task: Task, action: Action, outcome: Outcome) -> Action:
    """The action as it was observed; that it failed is not written here."""
    clock = task.clock
    if outcome.started is not None:
        action = with_start(action, outcome.started, clock)
    began = outcome.began
    if outcome.length is not None:
        work = working_time(task, action, began, began + outcome.length, outcome.resources)
        action = with_length(ended_at(action, began + outcome.length, clock), work)
    if outcome.at_least is not None:
        work = working_time(task, action, began, began + outcome.at_least, outcome.resources)
        action = lasting(action, work, clock)
    return action


def failures(outcomes: Iterable[Outcome]) -> dict[str, Number]:
    """When each action that failed did."""
    return {o.action: o.failed for o in outcomes if o.failed is not None}
