"""The check that an action fits into the open times of the resources that it uses.

An action is not interrupted, so that it needs an open time of its length: one in which each of its
resources has enough capacity, within the action's own release and deadline.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from itertools import product
from math import prod

from irc.diagnostics import Code, Findings
from irc.lowering.calendar_horizon import MOST_WINDOWS
from irc.problem import Problem
from irc.problem.needs import Requirement
from irc.problem.work_times import FOREVER, Piece, WorkTimes, WorkTimesOf, work_range

OpenTimes = tuple[tuple[int, int | None], ...]
"""Intervals in order, in ticks; the end None is never."""


def check_open_times(problem: Problem, findings: Findings) -> None:
    """Reports each action that must occur and fits into no open time of what it uses."""
    _check_size(problem, findings)
    optional = {i for group in problem.groups if not group.required for i in group.members}
    times = WorkTimesOf(problem)

    @cache
    def open_times(resource: int, amount: int) -> OpenTimes:
        return tuple(problem.resources[resource].open_times(amount))

    for i, activity in enumerate(problem.activities):
        details = activity.details
        if i in optional or details.optional or details.repeats is not None:
            continue
        if details.work:
            _check_pauses(problem, i, times, findings)
            continue
        shared: OpenTimes = ((0, None),)
        if details.calendar is not None:
            shared = tuple(
                (start, None if end >= FOREVER else end)
                for start, end in times.of_calendar(activity).intervals
            )
            if not _fits(problem, i, shared):
                _report(problem, i, [shared], [], findings)
                continue
        if details.modes or activity.duration_min == 0 or not activity.uses:
            continue  # A zero duration uses nothing.
        for use in activity.uses:
            found = [open_times(r, use.amount) for r in use.alternatives]
            if len(found) == 1:
                shared = tuple(_both(shared, found[0]))
            if not any(_fits(problem, i, each) for each in found):
                if any(found):  # Otherwise the demand is above the capacity, which is reported.
                    _report(problem, i, found, [use], findings)
                break
        else:
            if not _fits(problem, i, shared):
                single = [use for use in activity.uses if len(use.alternatives) == 1]
                _report(problem, i, [shared], single, findings)


def _check_size(problem: Problem, findings: Findings) -> None:
    """Reports calendars with more open times until the horizon than are planned with."""
    sizes = [len(resource.windows) for resource in problem.resources]
    sizes += [len(calendar.times) for calendar in problem.calendars]
    if max(sizes, default=0) > MOST_WINDOWS:
        findings.add(
            Code.TOO_MANY,
            f"a calendar opens more than {MOST_WINDOWS} times before every schedule has ended",
            ("calendars",),
            hint="give the task a deadline, or leave out open times that are too short to matter",
        )


def _check_pauses(problem: Problem, i: int, times: WorkTimesOf, findings: Findings) -> None:
    """Reports an action that pauses and finds no start in any of its ways."""
    activity = problem.activities[i]
    closest: Piece | None = None
    for mode in range(len(activity.details.modes)) or (None,):
        least = work_range(activity, mode)[0]
        uses = [activity.uses[u] for u in activity.uses_in(mode)] if least else []
        choices = [use.alternatives for use in uses]
        if prod(map(len, choices)) > _MOST_WAYS:
            return
        for chosen in product(*choices):
            piece = _shortest_pause(problem, i, times.of(activity, chosen), least)
            if piece is not None and (closest is None or piece.pause < closest.pause):
                closest = piece
    limit = activity.details.max_pause
    if closest is not None and (limit is None or closest.pause <= limit):
        return
    takes = problem.time_text(work_range(activity, 0 if activity.details.modes else None)[0])
    what = f"action {activity.id!r} works for {takes}"
    if closest is None:
        findings.add(
            Code.WINDOW,
            f"{what}, and what it uses is not open for so long{_between(problem, i)}",
            activity.origin,
            hint="open what it uses for longer, or move its deadline",
        )
        return
    shortest = problem.time_text(closest.pause)
    findings.add(
        Code.WINDOW,
        f"{what} and must not pause for more than {problem.time_text(limit or 0)}, "
        f"but every start{_between(problem, i)} leads to a pause of {shortest} or more",
        (*activity.origin, "max_pause"),
        hint=f"the maximum must be at least {shortest}",
    )


_MOST_WAYS = 1000


def _shortest_pause(problem: Problem, i: int, times: WorkTimes, work: int) -> Piece | None:
    """The starts with the shortest pause within the action's own limits; None if there are none."""
    activity, deadline = problem.activities[i], problem.effective_deadline(i)
    earliest = activity.release if activity.start is None else activity.start
    latest = (t for t in (activity.start, activity.latest_start) if t is not None)
    last = min(latest, default=FOREVER)
    pieces = times.pieces(work, FOREVER if deadline is None else deadline)
    within = (p for p in pieces if p.last >= earliest and p.first <= last)
    return min(within, key=lambda p: p.pause, default=None)


def _between(problem: Problem, i: int) -> str:
    has_limits = problem.activities[i].release > 0 or problem.effective_deadline(i) is not None
    return " between its release and its deadline" if has_limits else ""


def _both(one: OpenTimes, other: OpenTimes) -> Iterator[tuple[int, int | None]]:
    """The times that are in both."""
    i = j = 0
    while i < len(one) and j < len(other):
        start = max(one[i][0], other[j][0])
        ends = [end for end in (one[i][1], other[j][1]) if end is not None]
        end = min(ends, default=None)
        if end is None or start < end:
            yield start, end
        if end is None:
            return
        i, j = i + (one[i][1] == end), j + (other[j][1] == end)


def _fits(problem: Problem, index: int, times: OpenTimes) -> bool:
    """Whether the action fits into one of the times, within its own release and deadline."""
    activity, deadline = problem.activities[index], problem.effective_deadline(index)
    earliest = activity.release if activity.start is None else activity.start
    for start, end in times:
        begin = max(start, earliest)
        last = min((t for t in (end, deadline) if t is not None), default=None)
        if last is None or begin + activity.duration_min <= last:
            return True
    return False


def _report(
    problem: Problem,
    index: int,
    times: Iterable[OpenTimes],
    uses: Iterable[Requirement],
    findings: Findings,
) -> None:
    activity = problem.activities[index]
    spans = [(s, e) for found in times for s, e in found]
    names = dict.fromkeys(
        " or ".join(repr(problem.resources[r].id) for r in use.alternatives) for use in uses
    )
    if activity.details.calendar is not None:
        calendar = problem.calendars[activity.details.calendar].id
        names = dict.fromkeys([f"calendar {calendar!r}", *names])
    between = _between(problem, index)
    longest = max((e - s for s, e in spans if e is not None), default=0)
    known = "" if between else f", only for {problem.time_text(longest)} at most"
    findings.add(
        Code.WINDOW,
        f"action {activity.id!r} takes {problem.time_text(activity.duration_min)} without a break, "
        f"and {' with '.join(names)} is never open for so long{between}{known}",
        activity.origin,
        hint='open it for longer, divide the action, or let it pause: "breaks": "pause"',
    )
