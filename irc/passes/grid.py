"""Finds the times that a makespan can have: not every tick, where durations are far apart.

Fix the choices and the order on every resource as some optimal schedule has them. In the least
solution of the resulting temporal network, which is optimal too, every time is a floor plus the
lengths of edges (`irc.problem.horizon`). So it is congruent to some floor, modulo the greatest
common divisor of all edges. An event at t = 2.29 makes ticks of 0.01, yet durations of whole
seconds leave two residues: those of 0 and of 0.29. A bound of 51.97 is then a bound of 52, and
proofs are shorter.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from math import gcd

from irc.problem import Problem


@dataclass(frozen=True, slots=True)
class Grid:
    """The times that equal one of the `residues` (in order) modulo `step` ticks."""

    step: int
    residues: tuple[int, ...]

    def up(self, time: int) -> int:
        """The first time of the grid from `time` on."""
        base, rest = divmod(time, self.step)
        k = bisect_left(self.residues, rest)
        if k == len(self.residues):
            return (base + 1) * self.step + self.residues[0]
        return base * self.step + self.residues[k]

    def between(self, first: int, last: int) -> Iterator[int]:
        """The times of the grid from `first` to `last`, both included."""
        time = self.up(first)
        while time <= last:
            yield time
            time = self.up(time + 1)

    def count(self, first: int, last: int) -> int:
        """The approximate number of times."""
        return (1 + (last - first) // self.step) * len(self.residues)


EVERY_TICK = Grid(1, (0,))


def grid_of(problem: Problem) -> Grid:
    """The grid of the makespans of best schedules.

    Where heads are known they are the floors: they are implied, and on the grid themselves.
    """
    step = gcd(_step(problem), _step_of_setups(problem))
    pausing = any(a.details.work for a in problem.activities)
    if step == 1 or problem.has_state or pausing or not problem.is_regular:
        # (Where ranks cannot tell two happenings apart, state may keep them a tick apart. Work that
        # pauses lasts as long as closed times do.)
        return EVERY_TICK
    floors = {0}
    for i, activity in enumerate(problem.activities):
        if activity.earliest_end is not None:
            floors.add(activity.earliest_end)
        if activity.start is not None and activity.is_fixed:
            floors.update((activity.start, activity.start + activity.duration_min))
            continue
        head = problem.bounds.heads[i] if problem.bounds.heads else activity.release
        floors.add(head if activity.start is None else activity.start)
    for resource in problem.resources:
        floors.update(time for window in resource.windows for time in (window.start, window.end))
        setups = resource.setups
        if setups is not None and setups.initial is not None:
            floors.add(setups.since)
    for calendar in problem.calendars:
        floors.update(start for start, _ in calendar.times)
    if problem.previous.stability or "changes" in problem.objectives:
        # An activity that stays where the previous plan has it has its start as its floor.
        for places in (problem.previous.places, *problem.previous.recurring.values()):
            floors.update(place.start for place in places if place is not None)
    step = step or 1 + max(floors)
    return Grid(step, tuple(sorted({floor % step for floor in floors})))


def _step(problem: Problem) -> int:
    """The greatest common divisor of all edges of open activities; 0 where there are none."""
    step = 0
    for activity in problem.activities:
        if activity.start is not None and activity.is_fixed:
            continue
        step = gcd(step, activity.duration_min, activity.duration_max)
        for mode in activity.details.modes:
            step = gcd(step, mode.duration_min, mode.duration_max)
        if step == 1:
            return 1
    for arc in problem.arcs:
        step = gcd(step, arc.min_lag, arc.max_lag or 0)
        if step == 1:
            return 1
    return step


def _step_of_setups(problem: Problem) -> int:
    """The greatest common divisor of all set-ups; 0 where there are none.

    It is a tick where a use may have no length, because re-timing may keep it at one tick.
    """
    times = [s.time for r in problem.resources if r.setups for s in r.setups.table.values()]
    if problem.has_setups and any(a.uses and a.duration_min == 0 for a in problem.activities):
        times.append(1)
    return gcd(*times)


def bound_on_grid(problem: Problem) -> Problem:
    """Raises the bound to the next time that a makespan can have."""
    if not problem.has_contention:
        return problem  # The critical path is reached.
    value = grid_of(problem).up(problem.bounds.makespan.value)
    if value == problem.bounds.makespan.value:
        return problem
    return problem.with_bound(value, problem.bounds.makespan.reason)
