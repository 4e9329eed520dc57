"""The first objective in PDDL: a counter in the metric, where it is not the makespan."""

from __future__ import annotations

from typing import NamedTuple

from irc.problem import Problem
from irc_pddl21.encoding.builder import Builder


class ObjectiveCounter(NamedTuple):
    """The amount that each occurrence of an activity adds to the counter of the objective.

    `of_modes`: what (activity, mode) adds besides.
    """

    counter: str
    amounts: dict[int, int]
    of_modes: dict[tuple[int, int | None], int]


def add_objective(builder: Builder) -> ObjectiveCounter:
    """Declares the counter of the first objective and makes it the metric, if it needs one."""
    first, *beyond = builder.problem.objectives
    builder.grounded.beyond = tuple(beyond)
    amounts = _amounts(builder.problem, first)
    of_modes: dict[tuple[int, int | None], int] = {}
    if first == "cost":
        of_modes = {
            (i, m): mode.cost
            for i, activity in enumerate(builder.problem.activities)
            for m, mode in enumerate(activity.details.modes)
            if mode.cost
        }
    if not (any(amounts.values()) or of_modes):
        return ObjectiveCounter("", {}, {})
    counter = builder.names.new(f"sum_of_{first}")
    builder.encoding.counters[counter] = 0
    builder.grounded.tokens[counter] = f"the {first} so far"
    direction = "maximize" if first == "reward" else "minimize"
    builder.encoding.metric = f"{direction} ({counter})"
    return ObjectiveCounter(counter, amounts, of_modes)


def _amounts(problem: Problem, objective: str) -> dict[int, int]:
    """The reward or cost of each activity; a group's reward comes with its first member."""
    if objective == "cost":
        return {i: a.details.cost for i, a in enumerate(problem.activities)}
    if objective != "reward":
        return {}
    amounts = {i: a.details.reward for i, a in enumerate(problem.activities)}
    for group in problem.groups:
        amounts[group.members[0]] += group.reward
    return amounts
