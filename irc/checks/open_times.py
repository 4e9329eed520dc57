"""The check that an action fits into the open times of the resources that it uses.

An action is not interrupted, so that it needs an open time of its length: one in which each of its
resources has enough capacity, within the action's own release and deadline.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache

from irc.diagnostics import Code, Findings
from irc.problem import Problem
from irc.problem.problem import Requirement

OpenTimes = tuple[tuple[int, int | None], ...]
"""Intervals in order, in ticks; the end None is never."""


def check_open_times(problem: Problem, findings: Findings) -> None:
    """Reports each action that must occur and fits into no open time of what it uses."""
    optional = {i for group in problem.groups if not group.required for i in group.members}

    @cache
    def open_times(resource: int, amount: int) -> OpenTimes:
        return tuple(problem.resources[resource].open_times(amount))

    for i, activity in enumerate(problem.activities):
        details = activity.details
        if i in optional or details.optional or details.modes or details.repeats is not None:
            continue
        if activity.duration_min == 0 or not activity.uses:
            continue  # A zero duration uses nothing.
        shared: OpenTimes = ((0, None),)
        for use in activity.uses:
            times = [open_times(r, use.amount) for r in use.alternatives]
            if len(times) == 1:
                shared = tuple(_both(shared, times[0]))
            if not any(_fits(problem, i, found) for found in times):
                if any(times):  # Otherwise the demand is above the capacity, which is reported.
                    _report(problem, i, times, [use], findings)
                break
        else:
            if not _fits(problem, i, shared):
                single = [use for use in activity.uses if len(use.alternatives) == 1]
                _report(problem, i, [shared], single, findings)


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
    has_limits = activity.release > 0 or problem.effective_deadline(index) is not None
    between = " between its release and its deadline" if has_limits else ""
    longest = max((e - s for s, e in spans if e is not None), default=0)
    known = "" if between else f", only for {problem.time_text(longest)} at most"
    findings.add(
        Code.WINDOW,
        f"action {activity.id!r} takes {problem.time_text(activity.duration_min)} without a break, "
        f"and {' with '.join(names)} is never open for so long{between}{known}",
        activity.origin,
        hint="open the resource for longer, or divide the action into shorter ones",
    )
