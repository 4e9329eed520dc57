"""What every schedule of a problem contains: the part that bounds and checks can count on."""

from __future__ import annotations

from dataclasses import replace

from irc.problem import PLAIN, Activity, Arc, Bounds, Contention, PreviousPlan, Problem


def mandatory_part(problem: Problem) -> Problem:
    """A relaxation with plain activities only: what holds of it holds of every valid schedule.

    Optional activities, state, stock, modes (their shortest and longest duration remain) and
    windows (their greatest capacity remains) are left out. The problem itself where it has none
    of them. Activities keep their order; of repeated ones the occurrences that must be there
    stay, one after the other.
    """
    if problem.is_plain and not problem.has_calendars:
        return problem
    places = mandatory_places(problem)
    activities: list[Activity] = []
    chains: list[Arc] = []
    for activity in problem.activities:
        for k in range(_least(activity)):
            if k:
                chains.append(Arc(len(activities) - 1, len(activities), origin=-1))
            activities.append(_plain(activity))
    return replace(
        problem,
        activities=tuple(activities),
        resources=tuple(
            replace(r, capacity=max((r.capacity, *(w.capacity for w in r.windows))), windows=())
            for r in problem.resources
        ),
        contention=Contention(
            tuple(replace(p, base=None, windows=()) for p in problem.contention.pools)
        ),
        arcs=(
            *(
                arc._replace(before=places[arc.before], after=places[arc.after])
                for arc in problem.arcs
                if arc.before in places and arc.after in places
            ),
            *chains,
        ),
        bounds=Bounds(makespan=problem.bounds.makespan),
        reservoirs=(),
        variables=(),
        groups=(),
        goals=(),
        required=(),
        state_precedences=(),
        previous=PreviousPlan(stability=problem.previous.stability),
    )


MOST_REPEATED = 1_000
"""So many occurrences of one action are counted at most; more must not cost more."""


def _least(activity: Activity) -> int:
    if activity.details.repeats is not None:
        return min(activity.details.repeats[0], MOST_REPEATED)
    return 0 if activity.details.optional else 1


def _plain(activity: Activity) -> Activity:
    details = activity.details
    if details is PLAIN:
        return activity
    own = [u for k, u in enumerate(activity.uses) if details.use_mode(k) is None]
    claims = tuple(c for c in activity.open_demands if details.use_mode(c.use) is None)
    # (Its own uses come first, so the claims still point to them.)
    return replace(activity, uses=tuple(own), open_demands=claims, details=PLAIN)


def mandatory_places(problem: Problem) -> dict[int, int]:
    """Where each activity's (first) occurrence stands in the mandatory part."""
    places: dict[int, int] = {}
    size = 0
    for i, activity in enumerate(problem.activities):
        least = _least(activity)
        if least:
            places[i] = size
        size += least
    return places
