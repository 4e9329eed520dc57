"""Finds the activities that every schedule contains, and those that none can contain."""

from __future__ import annotations

from collections import defaultdict

from irc.diagnostics import Code, Findings
from irc.problem import Activity, Problem


def least_occurrences(activity: Activity) -> int:
    """The least number of occurrences by an activity's own `occurs`, without groups and goals."""
    if activity.details.repeats is not None:
        return activity.details.repeats[0]
    return 0 if activity.details.optional else 1


def greatest_occurrences(activity: Activity) -> int | None:
    """The greatest number of occurrences of an activity (None: no limit)."""
    if is_ruled_out(activity):
        return 0
    return 1 if activity.details.repeats is None else activity.details.repeats[1]


def is_ruled_out(activity: Activity) -> bool:
    """Whether it may occur at most 0 times (lowering then gives it a deadline before t = 0)."""
    return activity.deadline is not None and activity.deadline < 0


def required_activities(problem: Problem) -> frozenset[int]:
    """The activities that occur by themselves, by a goal, or because others of their group do."""
    found = {i for i, a in enumerate(problem.activities) if least_occurrences(a)}
    found.update(problem.required)
    groups: dict[int, list[int]] = defaultdict(list)
    for g, group in enumerate(problem.groups):
        for member in group.members:
            groups[member].append(g)
    todo = [i for i in found if i in groups]
    seen: set[int] = set()
    while todo:
        for g in groups.get(todo.pop(), ()):
            if g not in seen:
                seen.add(g)
                more = set(problem.groups[g].members) - found
                found |= more
                todo += more
    return frozenset(found)


def check_required(problem: Problem, required: frozenset[int], findings: Findings) -> None:
    """Reports activities that must occur and cannot."""
    for i in sorted(required):
        activity = problem.activities[i]
        if is_ruled_out(activity):
            findings.add(
                Code.NEVER,
                f"action {activity.id!r} may occur at most 0 times, but {_who_wants(problem, i)}",
                (*activity.origin, "occurs"),
                hint='give "occurs" a "max" of 1 or more, or do not require the action',
            )


def _who_wants(problem: Problem, i: int) -> str:
    if i in problem.required:
        return "a goal requires it"
    for group in problem.groups:
        if i in group.members:
            return f"group {group.id!r} requires it"
    return "it is required"
