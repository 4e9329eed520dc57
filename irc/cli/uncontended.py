"""The parts of the text of a schedule that are quick to find where its task is kept as columns."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from irc.model.columns import Columns
from irc.problem import Bound, Bounds, Problem
from irc.problem.precedence_times import PrecedenceTimes, slacks_of
from irc.schedule import Entry


def frame_of(columns: Columns, times: PrecedenceTimes) -> Problem:
    """A problem with no activities but the bound on the makespan; a tick is a time unit."""
    bounds = Bounds(makespan=Bound(times.makespan, "critical path"))
    return Problem(columns.head.name, columns.head.time_unit, Fraction(1), (), bounds=bounds)


def slacks_and_critical(
    columns: Columns, times: PrecedenceTimes, shown: Sequence[Entry]
) -> tuple[dict[str, int], int]:
    """(the slacks of the actions that are shown, the number of all that are critical)."""
    slacks = slacks_of(times, columns.durations, columns.following)
    names = {entry.id for entry in shown}
    pairs = zip(columns.ids, slacks, strict=True)
    return {name: slack for name, slack in pairs if name in names}, slacks.count(0)
