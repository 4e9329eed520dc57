"""Rules 2.7 and 2.8: actions keep to open times; their pauses are not too long, and as stated."""

from __future__ import annotations

from collections.abc import Sequence

from irc.model.quantities import Number
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.open_times import Span, holds, time_in
from irc.validation.verdict import Violations


def check_breaks(bound: BoundSchedule, violations: Violations) -> None:
    """Checks the open times of every occurrence that has a calendar or pauses."""
    for occurrence in bound.occurrences:
        action = occurrence.action
        if action.calendar is None and action.breaks == "avoid":
            if occurrence.entry.paused:
                _add_pause(occurrence, 0, violations)
            continue
        closed = bound.closed_times(occurrence)
        _check_ends(occurrence, closed, violations)
        if action.breaks == "avoid":
            _check_whole(occurrence, closed, violations)
        else:
            _check_pause(bound, occurrence, violations)


def _check_ends(
    occurrence: Occurrence, closed: Sequence[Sequence[Span]], violations: Violations
) -> None:
    where = []
    if holds(closed, occurrence.start):
        where.append(("starts", occurrence.start))
    # (What is broken off ends where its entry says.)
    done = occurrence.start < occurrence.end and not occurrence.cancelled
    if done and holds(closed, occurrence.end, at_end=True):
        where.append(("ends", occurrence.end))
    for verb, time in where:
        past = occurrence.past
        violations.add(
            "calendar",
            f"{occurrence.name} {verb} at {violations.time(time)}, which is a closed time",
            [occurrence.entry.id],
            (time,),
            carried=past is not None and (verb == "starts" or past.over),
        )


def _check_whole(
    occurrence: Occurrence, closed: Sequence[Sequence[Span]], violations: Violations
) -> None:
    shut = time_in(closed, occurrence.start, occurrence.end)
    if shut and not occurrence.cancelled:
        violations.add(
            "calendar",
            f"{occurrence.name} goes on for {violations.time(shut)} of closed time "
            f"between {violations.time(occurrence.start)} and {violations.time(occurrence.end)}",
            [occurrence.entry.id],
            (occurrence.start, occurrence.end),
            carried=occurrence.past is not None,
        )


def _check_pause(bound: BoundSchedule, occurrence: Occurrence, violations: Violations) -> None:
    paused, longest = occurrence.paused or 0, occurrence.action.max_pause
    if longest is not None and paused > (limit := bound.clock.number(longest)):
        violations.add(
            "pause",
            f"{occurrence.name} pauses for {violations.time(paused)}, "
            f"longer than its maximum of {violations.time(limit)}",
            [occurrence.entry.id],
            (paused, limit),
            carried=occurrence.past is not None,
        )
    if occurrence.entry.paused and occurrence.entry.paused != paused:
        _add_pause(occurrence, paused, violations)


def _add_pause(occurrence: Occurrence, paused: Number, violations: Violations) -> None:
    violations.add(
        "pause",
        f"{occurrence.name} pauses for {violations.time(paused)}, "
        f"not for the stated {violations.time(occurrence.entry.paused)}",
        [occurrence.entry.id],
        (paused, occurrence.entry.paused),
    )
