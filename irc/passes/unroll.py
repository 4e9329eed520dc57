"""Unrolls repeated actions: an activity for each occurrence."""

from __future__ import annotations

from dataclasses import replace

from irc.problem import Activity, PreviousPlace, Problem
from irc.problem.projection import restricted

MOST_OCCURRENCES = 4_000
"""The greatest number of occurrences of all repeated actions together."""


def unroll(problem: Problem, depth: int) -> Problem:
    """The problem with at most `depth` occurrences of each action that may repeat (and its least).

    The first occurrence keeps its index; the others follow after all activities, each with its
    predecessor as `previous_occurrence`. Heads and tails are carried over.
    """
    if all(a.details.repeats is None for a in problem.activities):
        return problem
    activities: list[Activity] = []
    further: list[tuple[int, Activity]] = []
    for i, activity in enumerate(problem.activities):
        repeats = activity.details.repeats
        if repeats is None:
            activities.append(activity)
            continue
        least = repeats[0]
        activities.append(_occurrence(activity, 1, activity.details.previous_occurrence, least))
        previous = i
        for k in range(2, slots(activity, depth) + 1):
            here = len(problem.activities) + len(further)
            further.append((i, _occurrence(activity, k, previous, least)))
            previous = here
    whole = range(len(problem.activities))
    longer, _ = restricted(problem, activities=(*whole, *(i for i, _ in further)))
    return replace(
        longer,
        activities=(*activities, *(a for _, a in further)),
        bounds=replace(
            problem.bounds,
            heads=_further_heads(problem, further),
            tails=_further_tails(problem, further),
        ),
        previous=replace(
            problem.previous,
            places=_further_places(problem, further),
            recurring={},
            warm_start=(),
        ),
    )


def slots(activity: Activity, depth: int) -> int:
    """The greatest number of occurrences of an activity at a depth."""
    repeats = activity.details.repeats
    if repeats is None:
        return 1
    least, greatest = repeats
    wanted = max(least, depth, 1)
    return wanted if greatest is None else min(wanted, greatest)


def _occurrence(activity: Activity, k: int, previous: int | None, least: int) -> Activity:
    """The k-th open occurrence of an activity (some may have run)."""
    details = activity.details
    return replace(
        activity,
        details=replace(
            details,
            repeats=None,
            occurrence=details.occurrence + k - 1,
            previous_occurrence=previous,
            optional=k > least,
        ),
    )


def _further_heads(problem: Problem, further: list[tuple[int, Activity]]) -> tuple[int, ...]:
    """The heads of further occurrences: k - 1 others run before the k-th one."""
    heads = problem.bounds.heads
    return heads and (
        *heads,
        *(heads[i] + (_number(problem, i, a) - 1) * a.duration_min for i, a in further),
    )


def _further_tails(problem: Problem, further: list[tuple[int, Activity]]) -> tuple[int, ...]:
    """The tails of further occurrences: the required ones run after the k-th one."""
    tails = problem.bounds.tails
    return tails and (
        *tails,
        *(
            max(0, _least(problem.activities[i]) - _number(problem, i, a)) * a.duration_min
            for i, a in further
        ),
    )


def _further_places(
    problem: Problem, further: list[tuple[int, Activity]]
) -> tuple[PreviousPlace | None, ...]:
    """The previous places of further occurrences, as far as the previous plan has them."""
    if not problem.previous.places:
        return ()
    found = []
    for i, activity in further:
        known, k = problem.previous.recurring.get(i, ()), _number(problem, i, activity) - 2
        found.append(known[k] if k < len(known) else None)
    return (*problem.previous.places, *found)


def _number(problem: Problem, i: int, occurrence: Activity) -> int:
    """The number of an occurrence among those that activity i stands for, from 1."""
    return occurrence.details.occurrence - problem.activities[i].details.occurrence + 1


def _least(activity: Activity) -> int:
    return activity.details.repeats[0] if activity.details.repeats else 1
