"""Problems with fewer choices: what must be there is mandatory, what cannot be there is gone."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace

from irc.problem import PLAIN, Activity, Problem


def restrict(problem: Problem, present: Collection[int], absent: Collection[int]) -> Problem:
    """The problem in which some optional activities (indexes) are there, and others are not.

    Groups whose members are all there become required; groups without members go. Heads, tails
    and the bound are left to the passes that find them, for they hold of fewer schedules now.
    """
    settled = replace(
        problem,
        activities=tuple(
            _mandatory(a) if i in present else a for i, a in enumerate(problem.activities)
        ),
        bounds=replace(problem.bounds, heads=(), tails=()),
    )
    return _without(settled, absent)


def settle_presence(problem: Problem) -> Problem:
    """Makes mandatory what is wanted or belongs to a group that must be there; drops the rest
    of what can never occur (its deadline is before the start), with its group.
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
    changed = restrict(problem, present, never)
    return replace(
        changed,
        bounds=replace(
            changed.bounds,
            heads=_kept(problem.bounds.heads, never),
            tails=_kept(problem.bounds.tails, never),
        ),
    )


def drop_ample_stock(problem: Problem) -> Problem:
    """Drops reservoirs that no order of the activities can bring to their limits.

    Those with more takers than stock stay, as do all that repeated activities touch.
    """
    if not problem.reservoirs:
        return problem
    lowest = [r.initial for r in problem.reservoirs]
    highest = [r.initial for r in problem.reservoirs]
    endless: set[int] = set()
    for activity in problem.activities:
        for change in activity.details.stock:
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
    place = {k: n for n, k in enumerate(kept)}
    return replace(
        problem,
        reservoirs=tuple(problem.reservoirs[k] for k in kept),
        activities=tuple(_with_stock(a, place) for a in problem.activities),
    )


def _with_stock(activity: Activity, place: dict[int, int]) -> Activity:
    if not activity.details.stock:
        return activity
    stock = tuple(
        c._replace(reservoir=place[c.reservoir])
        for c in activity.details.stock
        if c.reservoir in place
    )
    details = replace(activity.details, stock=stock)
    return replace(activity, details=PLAIN if details == PLAIN else details)


def _may_never_happen(activity: Activity) -> bool:
    """Whether it may happen several times, or not at all."""
    repeats = activity.details.repeats
    return repeats is not None and repeats[0] == 0


def _mandatory(activity: Activity) -> Activity:
    repeats = activity.details.repeats
    if repeats is not None:
        repeats = max(1, repeats[0]), repeats[1]
    details = replace(activity.details, optional=False, repeats=repeats)
    return replace(activity, details=PLAIN if details == PLAIN else details)


def _kept(values: tuple[int, ...], gone: Collection[int]) -> tuple[int, ...]:
    return tuple(v for i, v in enumerate(values) if i not in gone)


def _without(problem: Problem, gone: Collection[int]) -> Problem:
    """The problem without some activities; the numbers of the others close up."""
    place: dict[int, int] = {}
    for i in range(len(problem.activities)):
        if i not in gone:
            place[i] = len(place)

    def moved(indexes: Iterable[int]) -> tuple[int, ...]:
        return tuple(place[i] for i in indexes if i in place)

    groups = []
    for group in problem.groups:
        members = moved(group.members)
        if members:
            optional = any(
                problem.activities[i].details.optional for i in group.members if i in place
            )
            groups.append(replace(group, members=members, required=group.required or not optional))
    return replace(
        problem,
        activities=tuple(a for i, a in enumerate(problem.activities) if i in place),
        arcs=tuple(
            arc._replace(before=place[arc.before], after=place[arc.after])
            for arc in problem.arcs
            if arc.before in place and arc.after in place
        ),
        contention=replace(
            problem.contention,
            fixed_choices={
                (place[i], u): r
                for (i, u), r in problem.contention.fixed_choices.items()
                if i in place
            },
        ),
        groups=tuple(groups),
        required=moved(problem.required),
        previous=replace(
            problem.previous,
            places=tuple(e for i, e in enumerate(problem.previous.places) if i in place),
            recurring={place[i]: m for i, m in problem.previous.recurring.items() if i in place},
            warm_start=(),
        ),
        state_precedences=tuple(
            (place[a], place[b]) for a, b in problem.state_precedences if a in place and b in place
        ),
    )
