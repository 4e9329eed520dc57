"""Finds demands above capacity, which no schedule can meet, without a solver."""

from __future__ import annotations

from collections.abc import Iterator

from irc.explanation.minimise import Conflict
from irc.problem import Activity, Problem
from irc.problem.statements import Kind, Side, Statement


def demand_conflict(problem: Problem) -> Conflict[Statement] | None:
    """The conflict of an action's demand and the capacities below it; None if there is none.

    It is minimal: each use is needed for the sum, and a larger capacity of any alternative, or a
    duration of 0, would remove the conflict.
    """
    for i, activity in enumerate(problem.activities):
        if not activity.duration_min:
            continue  # A zero duration uses nothing.
        found = next(_above_capacity(problem, activity), None)
        if found is not None:
            uses, resources = found
            statements = (
                *(Statement(Kind.CAPACITY, r) for r in resources),
                *(Statement(Kind.USE, i, u) for u in sorted(uses)),
                Statement(Kind.DURATION, i, side=Side.LEAST),
            )
            return Conflict(statements, minimal=True)
    return None


def _above_capacity(
    problem: Problem, activity: Activity
) -> Iterator[tuple[list[int], tuple[int, ...]]]:
    """(uses that cannot be met together, the resources that are too small for them)."""
    for u, use in enumerate(activity.uses):
        if all(use.amount > problem.resources[r].capacity for r in use.alternatives):
            yield [u], use.alternatives
    of_one: dict[int, list[int]] = {}
    for u, use in enumerate(activity.uses):
        if len(use.alternatives) == 1:
            of_one.setdefault(use.alternatives[0], []).append(u)
    for r, uses in sorted(of_one.items()):
        excess = sum(activity.uses[u].amount for u in uses) - problem.resources[r].capacity
        if excess <= 0:
            continue
        needed = []
        for u in sorted(uses, key=lambda u: activity.uses[u].amount):
            if activity.uses[u].amount < excess:
                excess -= activity.uses[u].amount
            else:
                needed.append(u)
        yield needed, (r,)
