"""The limits on time in a frozen problem: finds, drops and describes them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from enum import Enum
from typing import NamedTuple

from irc.problem import IMPOSSIBLE_DEADLINE, Arc, Problem
from irc.problem.arc_text import arc_in_words
from irc.problem.statements import Side
from irc.schedule import Schedule


class Sort(Enum):
    """The sort of a limit on time."""

    ALL = "the task's deadline"
    DEADLINE = "the deadline of an action, or of a group that it is in"
    START = "a fixed start"
    LATEST_START = "the latest start of an action"
    LAG = "a maximum lag"


class Limit(NamedTuple):
    """A limit on the time of an activity or an arc; `of` is its index."""

    sort: Sort
    of: int = 0


def time_limits(problem: Problem, begun: Collection[int]) -> Iterator[Limit]:
    """The limits that still bind something; activities that have `begun` are not bound."""
    if problem.deadline is not None:
        yield Limit(Sort.ALL)
    for i, activity in enumerate(problem.activities):
        if i in begun or activity.deadline == IMPOSSIBLE_DEADLINE:
            continue
        if activity.deadline is not None:
            yield Limit(Sort.DEADLINE, i)
        if activity.start is not None:
            yield Limit(Sort.START, i)
        if activity.latest_start is not None:
            yield Limit(Sort.LATEST_START, i)
    for k, arc in enumerate(problem.arcs):
        if arc.max_lag is not None and not (arc.before in begun and arc.after in begun):
            yield Limit(Sort.LAG, k)


def without(problem: Problem, limits: Collection[Limit]) -> Problem:
    """The problem without these limits; a dropped fixed start remains as a release."""
    activities, arcs = list(problem.activities), list(problem.arcs)
    for sort, i in limits:
        if sort is Sort.DEADLINE:
            activities[i] = replace(activities[i], deadline=None)
        elif sort is Sort.START:
            release = max(activities[i].release, activities[i].start or 0)
            activities[i] = replace(activities[i], start=None, release=release)
        elif sort is Sort.LATEST_START:
            activities[i] = replace(activities[i], latest_start=None)
        elif sort is Sort.LAG:
            arcs[i] = arcs[i]._replace(max_lag=None)
    deadline = None if Limit(Sort.ALL) in limits else problem.deadline
    return replace(problem, activities=tuple(activities), arcs=tuple(arcs), deadline=deadline)


def broken(problem: Problem, limits: Collection[Limit], schedule: Schedule) -> dict[Limit, str]:
    """The limits that a schedule breaks, each with the value it has instead."""
    starts, ends = _times(problem, schedule, False), _times(problem, schedule, True)
    found: dict[Limit, str] = {}
    for limit in limits:
        sort, i = limit
        if sort is Sort.ALL:
            last = max(ends, key=lambda k: ends[k], default=None)
            if last is not None and ends[last] > (problem.deadline or 0):
                name = problem.activities[last].id
                found[limit] = f"{problem.time_text(ends[last])}, the end of {name!r}"
        elif sort is Sort.DEADLINE:
            if i in ends and ends[i] > (problem.activities[i].deadline or 0):
                found[limit] = problem.time_text(ends[i])
        elif sort is Sort.START:
            if i in starts and starts[i] != problem.activities[i].start:
                found[limit] = problem.time_text(starts[i])
        elif sort is Sort.LATEST_START:
            if i in starts and starts[i] > (problem.activities[i].latest_start or 0):
                found[limit] = problem.time_text(starts[i])
        else:
            lag = _lag(problem.arcs[i], starts, ends)
            if lag is not None and lag > (problem.arcs[i].max_lag or 0):
                found[limit] = problem.time_text(lag)
    return found


def _lag(arc: Arc, starts: Mapping[int, int], ends: Mapping[int, int]) -> int | None:
    if arc.before not in starts or arc.after not in starts:
        return None
    return (ends if arc.to_end else starts)[arc.after] - (ends if arc.from_end else starts)[
        arc.before
    ]


def _times(problem: Problem, schedule: Schedule, at_end: bool) -> dict[int, int]:
    """The start or the end of each activity that is present, in ticks."""
    entries = {(e.id, e.occurrence): e for e in schedule.entries}
    times = {}
    for i, activity in enumerate(problem.activities):
        entry = entries.get((activity.id, activity.details.occurrence))
        if entry is not None:
            times[i] = problem.whole_ticks(entry.end if at_end else entry.start)
    return times


def in_words(problem: Problem, limit: Limit, needed: str, only: bool) -> str:
    """A limit, and the time that a continuation `needed`; `only`: no earlier time is possible."""
    sort, i = limit
    text = problem.time_text
    found = "but the best plan found has"
    ends = "but cannot end before" if only else found
    if sort is Sort.ALL:
        limited = text(problem.deadline or 0)
        return f"all actions must end by {limited}, {ends} {needed}"
    if sort is Sort.LAG:
        lag = arc_in_words(problem, problem.arcs[i], Side.MOST, must=True)
        return f"{lag}, {found} {needed}"
    activity = problem.activities[i]
    if sort is Sort.DEADLINE:
        return f"{activity.id!r} must end by {text(activity.deadline or 0)}, {ends} {needed}"
    starts = "but cannot start before" if only else found
    if sort is Sort.LATEST_START:
        latest = text(activity.latest_start or 0)
        return f"{activity.id!r} must start by {latest}, {starts} {needed}"
    return f"{activity.id!r} must start at {text(activity.start or 0)}, {starts} {needed}"


HINTS = {
    Sort.ALL: "a later deadline of the task would help",
    Sort.DEADLINE: "a later deadline for it, or cancelling a predecessor, would help",
    Sort.START: "another start for it would help",
    Sort.LATEST_START: "a later latest start for it, or cancelling a predecessor, would help",
    Sort.LAG: "a longer maximum lag would help",
}
