"""Checks of a task's resolution: what is rounded to it, and what is too short for it."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from irc.diagnostics import Code, Diagnostic, Findings
from irc.diagnostics.source import Pointer
from irc.model import Action, Task
from irc.model.base import write_time
from irc.model.quantities import Number, TimeError
from irc.model.times import Clock, Instant, format_number

if TYPE_CHECKING:
    from irc.model.events import SetDuration


def check_resolution(task: Task, findings: Findings) -> bool:
    """Whether no duration is shorter than the task's resolution; reports the first that is."""
    from irc.model.resolution import durations

    for action in task.actions:
        for duration in durations([action]):
            if (short := too_short(duration, task.clock)) is not None:
                findings.add(*_too_coarse(action.id, short, task, ("resolution",)), hint=_FINER)
                return False
    return True


_FINER = "write a finer resolution, or leave it out"


def check_changed_durations(
    change: Action | SetDuration, task: Task, at: Pointer, findings: Findings
) -> None:
    """Adds a fault for each duration in a part of an event that is shorter than the resolution."""
    from irc.model.resolution import times_of

    if task.clock.resolution is None:
        return
    name = change.id if isinstance(change, Action) else change.action
    for place, value in times_of(change):
        if "duration" in place and (short := too_short(value, task.clock)) is not None:
            found = _too_coarse(name, short, task, (*at, *place))
            findings.add(*found, hint="a task in use keeps its resolution; begin with a finer one")


def too_short(duration: Instant, clock: Clock) -> Number | None:
    """The exact duration, if it is more than 0 and shorter than the resolution."""
    with suppress(TimeError):  # It is reported where the element is checked.
        exact = clock.exact(duration)
        if clock.resolution is not None and 0 < exact < clock.resolution:
            return exact
    return None


def _too_coarse(name: str, short: Number, task: Task, place: Pointer) -> tuple[Code, str, Pointer]:
    from irc.model.resolution import in_words

    resolution = task.clock.resolution
    assert resolution is not None
    unit = task.time_unit
    message = (
        f"the resolution is {in_words(resolution, task.clock)}, coarser than the duration of "
        f"{name!r}, {format_number(short)} {unit}"
    )
    return Code.COARSE_RESOLUTION, message, place


def rounding_note(task: Task) -> tuple[Diagnostic, ...]:
    """A note on the times of a task that are rounded to its resolution, if there are any.

    It has its own source, so that it can be shown without the report of the task.
    """
    clock = task.clock
    if clock.resolution is None:
        return ()
    from irc.model.resolution import in_words, times_of

    changed = []
    for place, value in times_of(task.model_copy(update={"events": ()})):
        with suppress(TimeError):
            number = clock.exact(value)
            if clock.number(value) != number and place != ("resolution",):
                changed.append((place, value))
    if not changed:
        return ()
    first, value = min(changed, key=lambda found: tuple(map(str, found[0])))
    others = len(changed) - 1
    more = f", and {others} more time{'s' if others > 1 else ''}" if others else ""
    unit = task.time_unit
    note = Diagnostic(
        Code.ROUNDED,
        f"{write_time(value)} is read as {format_number(clock.number(value))} {unit}{more}: "
        f"the resolution is {in_words(clock.resolution, clock)}",
        first,
        _DERIVED if task.resolution is None else "write a finer resolution to keep more digits",
    )
    return (note,)


_DERIVED = (
    "a time with more digits than a clock is the result of a computation; "
    'give the task a "resolution" to choose another one'
)


_TOO_FAR_APART = 10**15
"""No target holds two times whose ratio is greater."""


def times_far_apart(task: Task, refusal: Diagnostic) -> Diagnostic:
    """A refusal of the times of a task as a whole, with the finest and the longest of them."""
    from irc.model.resolution import times_of

    clock, unit = task.clock, task.time_unit
    found: list[tuple[Number, Pointer]] = []
    for place, value in times_of(task.model_copy(update={"events": ()})):
        with suppress(TimeError):
            number = clock.number(value)
            if number and place != ("resolution",):
                found.append((number, place))
    if not found:
        return refusal
    longest, at_longest = max(found, key=lambda f: (f[0], tuple(map(str, f[1]))))
    finest, at_finest = min(found, key=lambda f: (-f[0].denominator, f[0], tuple(map(str, f[1]))))
    if finest.denominator == 1:
        text, place = f"{format_number(longest)} {unit} is its longest time", at_longest
    else:
        text = f"{format_number(finest)} {unit} stands beside {format_number(longest)} {unit}"
        place = at_finest
    hint = 'give the task a coarser "resolution", and leave out what is too short for it'
    if longest < finest * _TOO_FAR_APART and refusal.hint:
        hint = f"{refusal.hint}, or {hint}"
    return replace(refusal, message=f"{refusal.message}: {text}", pointer=place, hint=hint)
