"""The parts of the text of a schedule that are quick to find where its task is kept as columns."""

from __future__ import annotations

from fractions import Fraction

from irc.model.columns import Columns
from irc.model.garbage import without_garbage
from irc.problem import Bound, Bounds, Problem
from irc.problem.precedence_times import PrecedenceTimes, slacks_of


@without_garbage()
def frame_and_slacks(columns: Columns, times: PrecedenceTimes) -> tuple[Problem, dict[str, int]]:
    """(a problem with no activities but the bound on the makespan, the slack of each action).

    A tick is a time unit.
    """
    bounds = Bounds(makespan=Bound(times.makespan, "critical path"))
    frame = Problem(columns.head.name, columns.head.time_unit, Fraction(1), (), bounds=bounds)
    slacks = slacks_of(times, columns.durations, columns.following)
    return frame, dict(zip(columns.ids, slacks, strict=True))
