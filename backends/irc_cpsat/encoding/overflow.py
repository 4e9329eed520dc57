"""Refusals of models whose sums do not fit the 64-bit integers in which CP-SAT computes."""

from __future__ import annotations

from irc.problem import Details, Problem
from irc.targets import Refusal

MAX_SUM = 2**62
"""A model that comes near the limit is refused."""

_MARGIN = 8
"""How many times beyond the horizon the moments of `irc_cpsat.encoding.state` reach."""


def greatest_horizon(problem: Problem) -> int:
    """A horizon, in ticks, up to which `refuse_overflow` takes the times of a problem.

    (It counts more ranks and places than a model has, so that none need be built to know it.)
    """
    happenings = 2 * len(problem.activities) + 1
    ranks = happenings if problem.has_state else 1
    places = happenings if problem.reservoirs else 1
    return MAX_SUM // (_MARGIN * ranks * places * happenings) - 1


def refuse_overflow(problem: Problem, horizon: int, rank_count: int) -> None:
    """Raises `Refusal`, saying which numbers are too large, where a sum would not fit."""
    count = max(1, len(problem.activities))
    times = _MARGIN * (horizon + 1) * rank_count * count
    if times >= MAX_SUM:
        raise Refusal(
            f"the times of this task reach {horizon} ticks, "
            "beyond what CP-SAT's 64-bit sums can hold",
            hint="use a coarser common unit for its times",
        )
    _refuse_capacities(problem, horizon, times)
    _refuse_weights(problem, horizon, times)
    _refuse_reward_and_cost(problem)
    _refuse_stock(problem)
    _refuse_numbers(problem)


def _refuse_capacities(problem: Problem, horizon: int, times: int) -> None:
    demanded = {r for a in problem.activities for c in a.open_demands for r in c.alternatives}
    for pool in (problem.contention.pools[r] for r in sorted(demanded)):
        if times * pool.capacity >= MAX_SUM:
            raise Refusal(
                f"{pool.capacity} units of {pool.id!r} over {horizon} ticks are beyond what "
                "CP-SAT's 64-bit sums can hold",
                problem.resources[pool.members[0]].origin,
                hint="count its capacity and amounts in larger units",
            )


def _refuse_weights(problem: Problem, horizon: int, times: int) -> None:
    weights = sum(a.details.weight for a in problem.activities if a.details.due is not None)
    weights += sum(g.weight for g in problem.groups if g.due is not None)
    if times * weights >= MAX_SUM:
        raise Refusal(
            f"the weights of this task's due dates, {weights} in all, over {horizon} ticks are "
            "beyond what CP-SAT's 64-bit sums can hold",
            hint="use smaller weights in the same proportions",
        )


def _refuse_reward_and_cost(problem: Problem) -> None:
    total = sum(abs(a.details.reward) + _most_cost(a.details) for a in problem.activities)
    total += sum(abs(g.reward) for g in problem.groups)
    if total >= MAX_SUM:
        raise Refusal(
            f"the rewards and costs of this task, {total} in all, are beyond what "
            "CP-SAT's 64-bit sums can hold",
            hint="count them in larger units",
        )


def _most_cost(details: Details) -> int:
    return abs(details.cost) + sum(abs(mode.cost) for mode in details.modes)


def _refuse_stock(problem: Problem) -> None:
    moved = [0] * len(problem.reservoirs)
    for activity in problem.activities:
        for change in activity.details.all_stock:
            moved[change.reservoir] += abs(change.amount)
    for reservoir, amount in zip(problem.reservoirs, moved, strict=True):
        if amount and amount + abs(reservoir.initial) + abs(reservoir.least) >= MAX_SUM:
            raise Refusal(
                f"the amounts of reservoir {reservoir.id!r} are beyond CP-SAT's 64-bit sums",
                reservoir.origin,
            )


def _refuse_numbers(problem: Problem) -> None:
    moved = [abs(n.initial) + abs(n.least or 0) + abs(n.greatest or 0) for n in problem.numbers]
    for k, number in enumerate(problem.numbers):
        moved[k] += sum(abs(change.value) for change in number.changes)
    for activity in problem.activities:
        for effect in activity.details.all_number_effects:
            moved[effect.number] += abs(effect.amount)
        for condition in activity.details.all_number_conditions:
            moved[condition.number] += abs(condition.least or 0) + abs(condition.greatest or 0)
    for goal in problem.number_goals:
        moved[goal.number] += abs(goal.least or 0) + abs(goal.greatest or 0)
    for number, amount in zip(problem.numbers, moved, strict=True):
        if _MARGIN * amount >= MAX_SUM:
            raise Refusal(
                f"the levels of number variable {number.id!r} are beyond CP-SAT's 64-bit sums",
                number.origin,
                hint="count it in larger units, or round its levels",
            )
