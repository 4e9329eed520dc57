"""The working time of what has begun: what lies between its start and an end, less its pauses."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

from irc.lowering.lower import lower
from irc.model import Action, Task
from irc.model.quantities import Number
from irc.problem import Problem
from irc.problem.work_times import WorkTimes, WorkTimesOf
from irc.schedule import Entry


class WorkSpans:
    """Working times of occurrences of a task, in its unit; `instants` are the times in question.

    What does not pause works all the time.
    """

    def __init__(self, task: Task, instants: Iterable[Number]) -> None:
        self._task, self._instants = task, instants

    def work(self, action: Action, entry: Entry, until: Number | None = None) -> Number:
        """The working time of an occurrence until its end, or until another time."""
        end = entry.end if until is None else until
        if action.breaks != "pause" or end <= entry.start:
            return end - entry.start
        times, problem = self._times(action, entry), self._problem
        before = times.work_before(problem.whole_ticks(entry.start))
        return problem.to_units(times.work_before(problem.whole_ticks(end)) - before)

    def end(self, action: Action, entry: Entry, work: Number) -> Number:
        """The end of an occurrence that starts as its entry says and works so long.

        Where the open times that are known do not last, it does not pause beyond them.
        """
        if action.breaks != "pause" or not work:
            return entry.start + work
        times, problem = self._times(action, entry), self._problem
        start = problem.whole_ticks(entry.start)
        end = times.end(start, problem.whole_ticks(work))
        return entry.start + work if end is None else problem.to_units(end)

    @cached_property
    def _problem(self) -> Problem:
        return lower(self._task, tuple(self._instants))

    @cached_property
    def _work_times(self) -> WorkTimesOf:
        return WorkTimesOf(self._problem)

    def _times(self, action: Action, entry: Entry) -> WorkTimes:
        activity = next(a for a in self._problem.activities if a.id == action.id)
        resources = enumerate(self._problem.resources)
        held = [r for r, resource in resources if resource.id in entry.resources]
        return self._work_times.of(activity, held)
