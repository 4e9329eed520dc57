"""What a schedule is worth by the objectives of its problem, so that plans can be compared."""

from __future__ import annotations

from fractions import Fraction

from irc.problem import Problem
from irc.schedule import Schedule

Worth = tuple[Fraction | int, ...]
"""One value for each objective, in order; less is better (a reward counts as its negative)."""


def worth_of(problem: Problem, schedule: Schedule) -> Worth:
    """The values of a schedule; times in ticks."""
    return tuple(_value(problem, schedule, name) for name in problem.objectives or ("makespan",))


def _value(problem: Problem, schedule: Schedule, objective: str) -> Fraction | int:
    if objective == "makespan":
        return _ticks(problem, schedule.makespan)
    if objective == "reward":
        return -reward_of(problem, schedule)
    if objective == "cost":
        return _sum_of_costs(problem, schedule)
    return _tardiness(problem, schedule)


def reward_of(problem: Problem, schedule: Schedule) -> int:
    """The rewards of the entries and of the groups that are there."""
    index = {activity.id: i for i, activity in enumerate(problem.activities)}
    present = {index[entry.id] for entry in schedule.entries}
    total = sum(problem.activities[index[e.id]].details.reward for e in schedule.entries)
    return total + sum(g.reward for g in problem.groups if present.issuperset(g.members))


def _sum_of_costs(problem: Problem, schedule: Schedule) -> int:
    cost = {activity.id: activity.details.cost for activity in problem.activities}
    return sum(cost[entry.id] for entry in schedule.entries)


def _tardiness(problem: Problem, schedule: Schedule) -> Fraction | int:
    """Σ weight · max(0, end − due) over entries and groups that are there."""
    index = {activity.id: i for i, activity in enumerate(problem.activities)}
    ends: dict[int, Fraction | int] = {}
    total: Fraction | int = 0
    for entry in schedule.entries:
        end = _ticks(problem, entry.end)
        i = index[entry.id]
        ends[i] = max(end, ends.get(i, end))
        details = problem.activities[i].details
        if details.due is not None:
            total += details.weight * max(0, end - details.due)
    for group in problem.groups:
        if group.due is not None and ends.keys() >= set(group.members):
            last = max(ends[i] for i in group.members)
            total += group.weight * max(0, last - group.due)
    return total


def _ticks(problem: Problem, time: Fraction | int) -> Fraction | int:
    exact = time / problem.tick
    return int(exact) if exact.denominator == 1 else exact
