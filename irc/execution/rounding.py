"""Times that come from outside a running task, as multiples of its resolution.

A robot's clock gives 0.10003671646118173. Read exactly, such a time makes the common unit of all
times so fine that no target can plan with it. So the times of events, of observations and of a plan
are rounded as they come in, and the first rounding is reported.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction

from irc.diagnostics import Code, Diagnostic
from irc.diagnostics.source import Pointer
from irc.model import Event, Task
from irc.model.base import write_time
from irc.model.events import AddActions, SetDuration
from irc.model.quantities import Number, TimeError
from irc.model.resolution import (
    durations,
    fine_enough,
    in_words,
    running_resolution,
    times_of,
    with_times,
)
from irc.model.times import Instant, common_tick, format_number, rounded
from irc.schedule import Schedule


@dataclass(frozen=True)
class Rounding:
    """The resolution of a running task, in its unit.

    Where the task does not give it, times stay as they are that are no finer (such as 1/3), or are
    multiples of `own_tick`, the greatest unit that divides all times of the task at the beginning.
    `reported` says whether a rounding was.
    """

    resolution: Number
    own_tick: Fraction | None
    reported: bool = False

    @classmethod
    def of(cls, task: Task) -> Rounding:
        """The rounding of a task that begins to run."""
        clock = task.clock
        own = None if clock.resolution is not None else _own_tick(task)
        return cls(running_resolution(task, clock), own)

    def time(self, value: Number) -> Number:
        """The time as a multiple of the resolution, or of the task's own unit."""
        if self.own_tick is not None and (
            value.denominator <= self.resolution.denominator
            or (Fraction(value) / self.own_tick).denominator == 1
        ):
            return value
        return rounded(value, self.resolution)

    def moment(
        self, task: Task, value: Number, what: str, at: Pointer
    ) -> tuple[Number, Rounding, Notes]:
        """(a time that came in, the rounding from then on, a note if it is the first one)."""
        near = self.time(value)
        return near, *self._after(task, [(at, value, near)] if near != value else [], what)

    def event(self, task: Task, event: Event) -> tuple[Event, Rounding, Notes]:
        """(an event with all of its times rounded, the rounding from then on, a note)."""
        rounding = self._fine_enough_for(task, event)
        changed: list[tuple[Pointer, Instant, Number]] = []
        clock = task.clock

        def near(value: Instant, place: Pointer) -> Instant:
            with suppress(TimeError):  # The check of the event reports it.
                exact = clock.exact(value)
                time = rounding.time(exact)
                # (A duration that would vanish is a fault, which the check of the event reports.)
                if time != exact and (time or "duration" not in place):
                    changed.append((place, value, time))
                    return time
            return value

        event = with_times(event, near)
        changed.sort(key=lambda found: tuple(map(str, found[0])))
        return event, *rounding._after(task, changed, "")

    def schedule(self, task: Task, schedule: Schedule) -> tuple[Schedule, Rounding, Notes]:
        """(a schedule with its times rounded, the rounding from then on, a note)."""
        entries = []
        changed: list[tuple[Pointer, Instant, Number]] = []
        for k, entry in enumerate(schedule.entries):
            start, end = self.time(entry.start), self.time(entry.end)
            if start != entry.start:
                changed.append((("actions", k, "start"), entry.start, start))
            if end != entry.end:
                changed.append((("actions", k, "end"), entry.end, end))
            same = start == entry.start and end == entry.end
            entries.append(entry if same else replace(entry, start=start, end=end))
        if not changed:
            return schedule, self, ()
        return replace(schedule, entries=tuple(entries)), *self._after(task, changed, "the plan's ")

    def _fine_enough_for(self, task: Task, event: Event) -> Rounding:
        """The rounding with a resolution that is fine enough for new durations, too."""
        if task.resolution is not None:
            return self
        lengths: list[Instant] = []
        for change in event.changes:
            if isinstance(change, AddActions):
                lengths += durations(change.actions)
            elif isinstance(change, SetDuration):
                lengths += [value for place, value in times_of(change)]
        if not lengths:
            return self
        finer = min(self.resolution, fine_enough(lengths, task.clock))
        return self if finer == self.resolution else replace(self, resolution=finer)

    def _after(
        self, task: Task, changed: list[tuple[Pointer, Instant, Number]], what: str
    ) -> tuple[Rounding, Notes]:
        if not changed or self.reported:
            return self, ()
        place, value, time = changed[0]
        unit = task.time_unit
        name = next((part for part in reversed(place) if isinstance(part, str)), "a time")
        note = Diagnostic(
            Code.ROUNDED,
            f"{what}'{name}' {write_time(value)} is taken as {format_number(time)} {unit}: times "
            "that come in while the task runs are rounded to its resolution, "
            f"{in_words(self.resolution, task.clock)}",
            place,
            'a "resolution" of the task chooses another one; later roundings are not reported',
        )
        return replace(self, reported=True), (note,)


Notes = tuple[Diagnostic, ...]
"""At most one note: only the first rounding is reported."""


def _own_tick(task: Task) -> Fraction:
    clock = task.clock
    numbers = []
    for _, value in times_of(task.model_copy(update={"events": ()})):
        with suppress(TimeError):
            numbers.append(clock.exact(value))
    return common_tick(numbers)
