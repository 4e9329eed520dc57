"""The first objective in PDDL: a counter in the metric, where it is not the makespan alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from irc.model.objectives import is_sum
from irc.problem import Details, Problem, Setup
from irc.problem.objective_values import whole_terms
from irc_pddl21.encoding.builder import Builder

COUNTED = frozenset(["reward", "cost", "setup_time", "setup_cost"])
"""Objectives that add up over what happens, so that a counter can follow them."""


class ObjectiveCounter(NamedTuple):
    """The amount that each occurrence of an activity adds to the counter of the objective.

    `of_modes`: what (activity, mode) adds besides. `of_setups`: the weights of the time (ticks) and
    of the cost of set-ups.
    """

    counter: str
    amounts: dict[int, int]
    of_modes: dict[tuple[int, int | None], int]
    of_setups: Setup = Setup(0, 0)


def add_objective(builder: Builder) -> ObjectiveCounter:
    """Declares the counter of the first objective and makes it the metric, if it needs one.

    A sum has one counter, to which the metric adds the total time. A sum with other parts is not in
    the metric.
    """
    problem = builder.problem
    first, *beyond = problem.objectives
    builder.grounded.beyond = tuple(beyond)
    weights: dict[str, int] = {}
    for weight, name in whole_terms(problem, first):
        weights[name] = weights.get(name, 0) + weight
    if is_sum(first) and not weights.keys() <= COUNTED | {"makespan"}:
        builder.grounded.beyond = problem.objectives
        weights = {}
    counter = _counter_of(problem, weights)
    if not (counter.amounts or counter.of_modes or any(counter.of_setups)):
        return counter
    counted = "objective" if is_sum(first) else first
    name = builder.names.new(f"sum_of_{counted}")
    builder.encoding.counters[name] = 0
    builder.grounded.tokens[name] = f"the {counted} so far"
    if "makespan" in weights:
        units = builder.scale.units_per_tick
        total = f"(+ (* {weights['makespan']} (total-time)) (* {units} ({name})))"
        builder.encoding.metric = f"minimize {total}"
    else:
        builder.encoding.metric = f"{'maximize' if first == 'reward' else 'minimize'} ({name})"
    return counter._replace(counter=name)


def _counter_of(problem: Problem, weights: Mapping[str, int]) -> ObjectiveCounter:
    """The amounts that activities and set-ups add to a counter of objectives with these weights.

    A group's reward comes with its first member.
    """
    # (A sum counts rewards negatively; alone, they are maximised.)
    cost, reward = weights.get("cost", 0), weights.get("reward", 0)
    activities = problem.activities
    amounts = {i: _amount(a.details, cost, reward) for i, a in enumerate(activities)}
    for group in problem.groups if reward else ():
        amounts[group.members[0]] += reward * group.reward
    of_modes: dict[tuple[int, int | None], int] = {
        (i, m): cost * mode.cost
        for i, activity in enumerate(activities)
        for m, mode in enumerate(activity.details.modes)
        if cost * mode.cost
    }
    of_setups = Setup(0, 0)
    if problem.has_setups:
        of_setups = Setup(weights.get("setup_time", 0), weights.get("setup_cost", 0))
    return ObjectiveCounter("", amounts if any(amounts.values()) else {}, of_modes, of_setups)


def _amount(details: Details, cost: int, reward: int) -> int:
    return cost * details.cost + reward * details.reward
