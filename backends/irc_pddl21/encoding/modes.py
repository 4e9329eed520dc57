"""Modes of an activity: their durations, and the open demands that they have."""

from __future__ import annotations

from dataclasses import replace

from irc.problem import Activity, OpenDemand
from irc.problem.work_times import work_range


def modes_of(activity: Activity) -> range | tuple[None]:
    """The indexes of an activity's modes; None alone where it has none."""
    return range(len(activity.details.modes)) if activity.details.modes else (None,)


def in_mode(activity: Activity, mode: int | None) -> Activity:
    """The activity with the stock, state and cost of a mode among its own."""
    details = activity.details.in_mode(mode)
    return activity if details is activity.details else replace(activity, details=details)


def span_of(activity: Activity, mode: int | None) -> tuple[int, int]:
    """Least and greatest duration in a mode, in ticks; of what pauses, its working time."""
    return work_range(activity, mode)


def demands_in(activity: Activity, mode: int | None) -> tuple[OpenDemand, ...]:
    """The open demands of an activity in a mode."""
    if mode is None:
        return activity.open_demands
    use_mode = activity.details.use_mode
    return tuple(c for c in activity.open_demands if use_mode(c.use) in (None, mode))
