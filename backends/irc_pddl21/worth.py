"""Comparing plans by the objectives of their problem."""

from __future__ import annotations

from irc.model.quantities import Number
from irc.problem import Problem
from irc.problem.objective_values import costs
from irc.schedule import Schedule

Worth = tuple[Number, ...]
"""One value for each objective, in order; less is better (a reward counts as its negative)."""


def worth_of(problem: Problem, schedule: Schedule) -> Worth:
    """The values of a schedule, times in the task's unit."""
    values = costs(problem, schedule)
    return tuple(values[name] for name in problem.objectives)
