"""Comparing plans by the objectives of their problem."""

from __future__ import annotations

from irc.problem import Problem
from irc.schedule import Schedule
from irc.times import Number
from irc.worth import costs

ObjectiveValues = tuple[Number, ...]
"""One value for each objective, in order; less is better (a reward counts as its negative)."""


def objective_values(problem: Problem, schedule: Schedule) -> ObjectiveValues:
    """The values of a schedule, times in the task's unit."""
    values = costs(problem, schedule)
    return tuple(values[name] for name in problem.objectives)
