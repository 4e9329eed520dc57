"""Lowers calendars and work that pauses. Loaded only for tasks that have them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from math import prod

from irc.lowering.calendar_horizon import COMBINATIONS, CalendarTimes, horizon
from irc.lowering.calendars import Interval, without
from irc.lowering.elements import ToTicks, ticks_or_none
from irc.model import Action, Task
from irc.model.quantities import Number, TimeError
from irc.model.times import Clock
from irc.problem import PLAIN, Activity, OpenCalendar, Problem, Renewable, Window
from irc.problem.work_times import WorkTimesOf, work_range


@dataclass(frozen=True)
class Expanded:
    """The open times of each calendar by its id, up to the horizon, in the task's unit.

    `instants` are the times that a tick must divide on their account, and those given before.
    """

    task: Task
    horizon: Number
    open: dict[str, list[Interval]]
    instants: tuple[Number, ...]

    def renewable(self, resource: Renewable, to_ticks: ToTicks) -> Renewable:
        """A resource with its open times as windows; windows that it has already come first."""
        node = self.task.resources[int(resource.origin[1])]
        if node.calendar is None or node.calendar not in self.open:
            return resource
        given: list[Interval] = [(w.start, w.end) for w in resource.windows]
        opened = [(to_ticks(start), to_ticks(end)) for start, end in self.open[node.calendar]]
        left = without(opened, given, to_ticks(self.horizon))
        windows = [*resource.windows, *(Window(int(s), int(e), resource.capacity) for s, e in left)]
        return replace(resource, capacity=0, windows=tuple(sorted(windows)))


def expanded(task: Task, clock: Clock, instants: Iterable[Number]) -> Expanded:
    """The calendars of a task, expanded as far as a schedule needs."""
    times, known = CalendarTimes(task, clock), tuple(instants)
    until = horizon(task, times, known, _deadline(task, clock))
    found = {
        name: [
            interval for interval in times.of(frozenset([name])).until(until) if interval[0] < until
        ]
        for name in times.by_id
    }
    bounds = (time for intervals in found.values() for interval in intervals for time in interval)
    return Expanded(task, until, found, (*known, until, *dict.fromkeys(bounds)))


def _deadline(task: Task, clock: Clock) -> Number | None:
    if task.deadline is None:
        return None
    try:
        return max(0, clock.number(task.deadline))
    except TimeError:
        return None


def add_work(
    problem: Problem, task: Task, calendars: Expanded | None, to_ticks: ToTicks
) -> Problem:
    """The problem with the calendars of its actions, and with their pauses."""
    used = sorted({a.calendar for a in task.actions if a.calendar is not None})
    known = [name for name in used if calendars is not None and name in calendars.open]
    places = {c.id: k for k, c in reversed(list(enumerate(task.calendars)))}
    if calendars is not None:
        lowered = (
            OpenCalendar(
                name,
                tuple((to_ticks(s), to_ticks(e)) for s, e in calendars.open[name]),
                ("calendars", places[name]),
            )
            for name in known
        )
        end = to_ticks(calendars.horizon)
        problem = replace(problem, calendars=tuple(lowered), horizon=end)
    index = {name: k for k, name in enumerate(known)}
    times = WorkTimesOf(problem)
    activities = []
    for activity in problem.activities:
        action = task.actions[int(activity.origin[1])]
        if action.calendar in index or action.breaks == "pause":
            activity = _with_work(activity, action, index, to_ticks, times)
        activities.append(activity)
    return replace(problem, activities=tuple(activities))


def _with_work(
    activity: Activity,
    action: Action,
    index: dict[str, int],
    to_ticks: ToTicks,
    times: WorkTimesOf,
) -> Activity:
    calendar = index.get(action.calendar) if action.calendar is not None else None
    details = replace(activity.details, calendar=calendar)
    if action.breaks == "pause":
        modes = range(len(details.modes)) if details.modes else (None,)
        limit = None if action.max_pause is None else ticks_or_none(action.max_pause, to_ticks)
        work = tuple(work_range(activity, mode) for mode in modes)
        pauses = [
            _longest_pause(replace(activity, details=details), mode, times, limit) for mode in modes
        ]
        details = replace(
            details,
            work=work,
            max_pause=limit,
            modes=tuple(
                m._replace(duration_max=m.duration_max + pause)
                for m, pause in zip(details.modes, pauses, strict=False)
            ),
        )
        longest = max(most + pause for (_, most), pause in zip(work, pauses, strict=True))
        activity = replace(activity, duration_max=longest)
    return replace(activity, details=PLAIN if details == PLAIN else details)


def _longest_pause(
    activity: Activity, mode: int | None, times: WorkTimesOf, limit: int | None
) -> int:
    """An upper limit of the closed time within an activity, however it is carried out.

    It is above every pause, so that the time from start to end never counts as the greatest.
    """
    least, most = work_range(activity, mode)
    longest = 1
    for chosen in _resources(activity, mode, times.problem):
        open_times = times.of(activity, chosen)
        if least < most or len(chosen) > len(activity.uses):
            # (Work that does not fit in any more may still do so with less of a range.)
            gaps = zip(open_times.ends, open_times.starts[1:], strict=False)
            longest = max(longest, sum(opened - closed for closed, opened in gaps))
        else:
            longest = max([longest, *(piece.pause for piece in open_times.pieces(most))])
    return 1 + (longest if limit is None else min(longest, limit))


def _resources(activity: Activity, mode: int | None, problem: Problem) -> Iterator[tuple[int, ...]]:
    """The resources that may be chosen together, one for each different calendar.

    Where there are too many combinations, all resources at once, whose closed times are the most.
    """
    uses = [activity.uses[u] for u in activity.uses_in(mode)]
    choices = [
        list({problem.resources[r].windows: r for r in use.alternatives}.values()) for use in uses
    ]
    if prod(map(len, choices)) <= COMBINATIONS:
        return product(*choices)
    return iter([tuple(r for choice in choices for r in choice)])
