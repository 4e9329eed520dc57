"""The set-ups that a schedule of a problem needs, between two consecutive uses of a resource."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from irc.problem.activity import Activity
from irc.problem.decisions import Decision, Moment, Placed
from irc.problem.problem import Problem
from irc.problem.resources import NO_SETUP, Renewable, Setup, Setups


class SetupLink(NamedTuple):
    """The set-up of a resource before activity `after`, since `before` (None: since `since`)."""

    resource: int
    before: int | None
    after: int
    setup: Setup


def setup_links(
    resources: Sequence[Renewable],
    activities: Sequence[Activity],
    decisions: Sequence[Decision | Placed],
    chosen: Sequence[Sequence[int | None]],
    tolerance: Moment = 0,
) -> Iterator[SetupLink]:
    """The set-ups of all resources, in the order of the decisions.

    `chosen` has the resource (index) of each use. What lasts no longer than the `tolerance` holds
    nothing.
    """
    for r, held in sorted(_held(resources, activities, decisions, chosen, tolerance).items()):
        setups = resources[r].setups
        assert setups is not None
        previous: tuple[int, int] | None = None
        for _, _, i, family in sorted(held):
            if previous is None:
                yield SetupLink(r, None, i, setups.first(family))
            else:
                yield SetupLink(r, previous[0], i, setups.between(previous[1], family))
            previous = i, family


def _held(
    resources: Sequence[Renewable],
    activities: Sequence[Activity],
    decisions: Sequence[Decision | Placed],
    chosen: Sequence[Sequence[int | None]],
    tolerance: Moment,
) -> dict[int, list[tuple[Moment, Moment, int, int]]]:
    """(start, end, activity, family) of each use of each resource with set-ups."""
    held: dict[int, list[tuple[Moment, Moment, int, int]]] = {}
    for i, (place, taken) in enumerate(zip(decisions, chosen, strict=True)):
        if place.end - place.start > tolerance:
            for use, r in zip(activities[i].uses, taken, strict=True):
                if r is not None and resources[r].setups is not None:
                    held.setdefault(r, []).append((place.start, place.end, i, use.family))
    return held


def total_setup(links: Iterable[SetupLink]) -> Setup:
    """The time (ticks) and the cost of set-ups together."""
    time = cost = 0
    for link in links:
        time += link.setup.time
        cost += link.setup.cost
    return Setup(time, cost)


def has_ended(problem: Problem, activity: Activity, use: int) -> bool:
    """Whether a use is history: its activity has ended, and nobody decides about it any more.

    (No pass decides a use of a resource with set-ups.)
    """
    return (
        has_ended_in(activity, use)
        and problem.resources[activity.uses[use].alternatives[0]].setups is not None
    )


def has_ended_in(activity: Activity, use: int) -> bool:
    """Whether a use of a resource whose uses no pass decides is history."""
    return (
        activity.start is not None
        and activity.duration_min > 0
        and len(activity.uses[use].alternatives) == 1
        and all(demand.use != use for demand in activity.open_demands)
    )


def setups_from_now(problem: Problem, resource: int) -> tuple[Setups, Setup]:
    """The set-ups of a resource after what has ended, and those that have taken place."""
    setups = problem.resources[resource].setups
    assert setups is not None
    ended = sorted(
        (activity.start or 0, activity.duration_min, activity.uses[use].family)
        for activity in problem.activities
        for use in range(len(activity.uses))
        if activity.uses[use].alternatives == (resource,) and has_ended(problem, activity, use)
    )
    time = cost = 0
    for start, duration, family in ended:
        done = setups.first(family)
        time, cost = time + done.time, cost + done.cost
        setups = replace(setups, initial=family, since=start + duration)
    return setups, Setup(time, cost) if ended else NO_SETUP
