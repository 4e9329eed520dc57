"""Reachable values of state variables, if values were never lost again.

The delete relaxation (Hoffmann and Nebel, "The FF planning system", JAIR 14, 2001): a value that
is not reachable even if nothing were ever lost is not reachable at all. A number to which
activities only add ends between its first level with the least, and with the most, of what they
may add in all.
"""

from __future__ import annotations

from irc.problem import Activity, Problem

Value = tuple[int, int]
"""A variable and one of its values, by index."""


def is_out_of_reach(problem: Problem) -> bool:
    """Whether a goal, or a condition of a mandatory activity, can never hold."""
    if any(_ends_beyond(problem, n) for n in range(len(problem.numbers))):
        return True
    if not problem.variables:
        return False
    reached = reachable_values(problem)
    if any(goal not in reached for goal in problem.goals):
        return True
    return any(
        not _needs(activity) <= reached for activity in problem.activities if _must_happen(activity)
    )


def reachable_values(problem: Problem) -> set[Value]:
    """The values that some activity could give, once all that it needs has been given."""
    reached = {
        (v, value)
        for v, variable in enumerate(problem.variables)
        for value in variable.known_values
    }
    waiting = list(problem.activities)
    while True:
        ready = [activity for activity in waiting if _needs(activity) <= reached]
        if not ready:
            return reached
        waiting = [activity for activity in waiting if not _needs(activity) <= reached]
        for activity in ready:
            reached |= _gives(activity)


def _needs(activity: Activity) -> set[Value]:
    """The values that an activity requires in every mode, without those that it gives itself."""
    return {(c.var, c.value) for c in activity.details.conditions} - _gives(activity)


def _gives(activity: Activity) -> set[Value]:
    return {(e.var, e.value) for e in activity.details.all_effects}


def _must_happen(activity: Activity) -> bool:
    repeats = activity.details.repeats
    return not activity.details.optional if repeats is None else repeats[0] > 0


def _ends_beyond(problem: Problem, n: int) -> bool:
    """Whether the last level of a number is outside its bounds or goals in every schedule."""
    number = problem.numbers[n]
    if number.changes:
        return False
    least = greatest = number.initial
    for activity in problem.activities:
        nets = _nets(activity, n)
        if nets is None:
            return False
        least, greatest = least + min(nets), greatest + max(nets)
    limits = [(number.least, number.greatest)]
    limits += [(goal.least, goal.greatest) for goal in problem.number_goals if goal.number == n]
    return any(
        (low is not None and greatest < low) or (high is not None and least > high)
        for low, high in limits
    )


def _nets(activity: Activity, n: int) -> list[int] | None:
    """The sums that an activity may add to a number; None where it sets it, or may repeat."""
    effects = [[e for e in way.number_effects if e.number == n] for way in activity.details.ways]
    if any(e.sets or activity.details.repeats is not None for way in effects for e in way):
        return None
    nets = [sum(e.amount for e in way) for way in effects]
    return [*nets, 0] if activity.details.optional else nets
