"""The parts of the text of a schedule that are quick to find where its task is kept as columns."""

from __future__ import annotations

from fractions import Fraction

from irc.model.garbage import without_garbage
from irc.problem import Bound, Bounds, Problem
from irc.problem.precedence_times import earliest_times, slacks_of
from irc.schedule import Schedule


@without_garbage()
def frame_and_slacks(schedule: Schedule) -> tuple[Problem, dict[str, int]] | None:
    """(a problem with no activities but the bound on the makespan, the slack of each action).

    A tick is a time unit. None where the schedule's task is not kept as columns.
    """
    columns = None if schedule.made_for is None else schedule.made_for.columns
    if columns is None or not schedule.answered:
        return None
    times = earliest_times(columns.durations, columns.before, columns.after)
    if times is None:
        return None
    bounds = Bounds(makespan=Bound(times.makespan, "critical path"))
    frame = Problem(columns.head.name, columns.head.time_unit, Fraction(1), (), bounds=bounds)
    slacks = slacks_of(times, columns.durations)
    return frame, dict(zip(columns.ids, slacks, strict=True))
