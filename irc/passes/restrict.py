"""Problems with fewer choices: required activities are mandatory, impossible ones are gone."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from irc.problem import PLAIN, Activity, Bounds, Group, Problem, Selection
from irc.problem.projection import restricted


def restrict(problem: Problem, present: Collection[int], absent: Collection[int]) -> Problem:
    """The problem in which some optional activities (indexes) are present, and others absent.

    Groups whose members are all present become required; groups without members go. Heads and tails
    are left to the passes that find them, because fewer schedules remain.
    """
    smaller = _with_presence(problem, present, absent)
    return replace(smaller, bounds=Bounds(makespan=smaller.bounds.makespan))


def _with_presence(problem: Problem, present: Collection[int], absent: Collection[int]) -> Problem:
    activities = tuple(
        _mandatory(a) if i in present else a for i, a in enumerate(problem.activities)
    )
    kept = (i for i in range(len(activities)) if i not in absent)
    selections = tuple(_without(s, absent) for s in problem.selections if _may_count(s, absent))
    changed = replace(problem, activities=activities, selections=selections)
    smaller, _ = restricted(changed, activities=kept)
    return replace(
        smaller,
        groups=tuple(_required(smaller, group) for group in smaller.groups),
        previous=replace(smaller.previous, warm_start=()),
    )


def _may_count(selection: Selection, absent: Collection[int]) -> bool:
    """Whether the condition of a selection can hold."""
    return selection.condition is None or not any(i in absent for i in selection.condition)


def _without(selection: Selection, absent: Collection[int]) -> Selection:
    items = tuple(item for item in selection.items if not any(i in absent for i in item))
    if selection.all_or_none and len(items) < len(selection.items):
        return selection._replace(items=items, least=0, most=0, all_or_none=False)
    return selection._replace(items=items)


def _required(problem: Problem, group: Group) -> Group:
    """The group; it is required where none of its members is optional."""
    if group.required or any(problem.activities[i].details.optional for i in group.members):
        return group
    return replace(group, required=True)


def decide_presence(problem: Problem) -> Problem:
    """Makes goals and members of required groups mandatory; drops activities that can never occur.

    An activity whose deadline is before its start can never occur; its group goes with it.
    """
    if problem.is_plain:
        return problem
    optional = {i for i, a in enumerate(problem.activities) if a.details.optional}
    bound_to_be = {i for i in range(len(problem.activities)) if i not in optional}
    bound_to_be |= set(problem.required)
    never = {i for i in optional if (problem.activities[i].deadline or 0) < 0}
    for group in problem.groups:  # An activity is in one such group at most.
        members = set(group.members)
        if group.required or members & bound_to_be:
            bound_to_be |= members
        elif members & never:
            never |= members
    present = {i for i in bound_to_be if problem.activities[i].details.optional}
    present |= {i for i in problem.required if _may_never_happen(problem.activities[i])}
    never -= bound_to_be
    if not (present or never):
        return problem
    return _with_presence(problem, present, never)


def drop_ample_stock(problem: Problem) -> Problem:
    """Drops reservoirs that no order of the activities can bring to their limits.

    Reservoirs with more consumers than stock stay, and so do all that repeated activities change.
    """
    if not problem.reservoirs:
        return problem
    lowest = [r.initial for r in problem.reservoirs]
    highest = [r.initial for r in problem.reservoirs]
    endless: set[int] = set()
    for activity in problem.activities:
        for change in activity.details.all_stock:
            if activity.details.repeats is not None:
                endless.add(change.reservoir)
            extreme = lowest if change.amount < 0 else highest
            extreme[change.reservoir] += change.amount
    kept = [
        k
        for k, r in enumerate(problem.reservoirs)
        if k in endless
        or lowest[k] < r.least
        or (r.greatest is not None and highest[k] > r.greatest)
    ]
    if len(kept) == len(problem.reservoirs):
        return problem
    return restricted(problem, reservoirs=kept)[0]


def _may_never_happen(activity: Activity) -> bool:
    """Whether an activity may happen several times, or not at all."""
    repeats = activity.details.repeats
    return repeats is not None and repeats[0] == 0


def _mandatory(activity: Activity) -> Activity:
    repeats = activity.details.repeats
    if repeats is not None:
        repeats = max(1, repeats[0]), repeats[1]
    details = replace(activity.details, optional=False, repeats=repeats)
    return replace(activity, details=PLAIN if details == PLAIN else details)
