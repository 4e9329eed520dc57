"""Turns placed activities into the schedule, in the task's words and time unit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from irc.problem import Activity, Problem
from irc.problem.decisions import Placed
from irc.problem.work_times import WorkTimesOf
from irc.schedule import Entry, Schedule


def schedule_of(problem: Problem, placed: Sequence[Placed]) -> Schedule:
    """The schedule of the present activities, in the task's time unit, by start, end and name.

    Occurrences of one action are numbered by start, whichever activities stand for them.
    """
    order = sorted(
        (i for i, place in enumerate(placed) if place.present),
        key=lambda i: (placed[i].start, placed[i].end, problem.activities[i].id, placed[i].rank),
    )
    times = WorkTimesOf(problem)
    entries = tuple(_entry(problem, i, placed[i], times) for i in order)
    if len({entry.id for entry in entries}) < len(entries):
        entries = _numbered(entries)
    return Schedule(entries, task=problem.name)


def _numbered(entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """Entries in order of time, the k-th of each action as its k-th occurrence."""
    counts: Counter[str] = Counter()
    numbered = []
    for entry in entries:
        counts[entry.id] += 1
        numbered.append(replace(entry, occurrence=counts[entry.id]))
    return tuple(numbered)


def _entry(problem: Problem, index: int, placed: Placed, times: WorkTimesOf) -> Entry:
    activity = problem.activities[index]
    held: dict[str, int] = {}
    for use, r in zip(activity.uses, placed.resources, strict=True):
        if r is not None:
            name = problem.resources[r].id
            held[name] = held.get(name, 0) + use.amount
    return Entry(
        activity.id,
        problem.to_units(placed.start),
        problem.to_units(placed.end),
        held,
        mode=None if placed.mode is None else activity.details.modes[placed.mode].id,
        rank=placed.rank,
        end_rank=None if placed.end_rank == placed.rank else placed.end_rank,
        paused=problem.to_units(_paused(activity, placed, times)),
    )


def _paused(activity: Activity, placed: Placed, times: WorkTimesOf) -> int:
    """The closed time between the start and the end of an activity that pauses, in ticks."""
    if not activity.details.keeps_units:
        return 0
    held = () if placed.end == placed.start else [r for r in placed.resources if r is not None]
    own = times.of(activity, held)
    worked = own.work_before(placed.end) - own.work_before(placed.start)
    return placed.end - placed.start - worked
