"""The lists of activities from which a search begins: orders by due dates and by urgency."""

from __future__ import annotations

from collections.abc import Iterator

from irc.local_search.arcs import adjacent, order_by
from irc.local_search.listing import NEVER, Listing
from irc.problem import Arc


def first_lists(listing: Listing) -> Iterator[list[int]]:
    """Orders that precedence allows, each by a rule."""
    problem = listing.problem
    lasts = [min(choice.work for choice in own) for own in listing.choices]
    heads = problem.bounds.heads or [a.release for a in problem.activities]
    rests = _rests(listing, lasts)
    yield order_by(problem, [-rest for rest in rests])
    yield order_by(problem, [float(head) for head in heads])
    dues = _dues(listing, lasts)
    if any(due < NEVER for due in dues):
        yield order_by(problem, [float(due) for due in dues])
        slacks = (due - work for due, work in zip(dues, lasts, strict=True))
        yield order_by(problem, [float(slack) for slack in slacks])


def _rests(listing: Listing, lasts: list[int]) -> list[int]:
    """The least time from the start of each activity to the end of all that follow it."""
    problem, rests = listing.problem, list(lasts)
    order = order_by(problem, [0] * len(rests))
    into: dict[int, list[Arc]] = {}
    for arc in problem.arcs:
        into.setdefault(arc.after, []).append(arc)
    for i in reversed(order):
        for arc in into.get(i, ()):
            since = lasts[arc.before] if arc.from_end else 0
            rests[arc.before] = max(rests[arc.before], since + arc.min_lag + rests[i])
    return rests


def _dues(listing: Listing, lasts: list[int]) -> list[int]:
    """The due date of each activity, or the time that those of what follows leave for it."""
    problem = listing.problem
    dues = [NEVER if a.details.due is None else a.details.due for a in problem.activities]
    for group in problem.groups:
        for i in group.members if group.due is not None else ():
            dues[i] = min(dues[i], group.due or 0)
    into = adjacent(problem, after=False)
    for i in reversed(order_by(problem, [0] * len(dues))):
        for before, lag in into[i]:
            dues[before] = min(dues[before], dues[i] - lasts[i] - lag)
    return dues
