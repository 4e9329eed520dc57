"""Objectives as expressions over a CP-SAT model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ortools.sat.python import cp_model

from irc.model.objectives import is_sum, terms_of
from irc.passes.grid import grid_of
from irc.problem import Activity
from irc.problem.objective_values import whole_terms
from irc_cpsat.encoding.builder import (
    Builder,
    DemandLiterals,
    Expression,
    Literal,
    Model,
    name_of,
)
from irc_cpsat.encoding.due_dates import dated_values
from irc_cpsat.encoding.setups import setup_values

MAX_MAKESPAN_VALUES = 5_000
"""With more possible makespans than this, the makespan is any number in between."""


def add_makespan(builder: Builder) -> cp_model.IntVar:
    """A variable that no end exceeds; with bounds one of the makespans of best schedules."""
    least = builder.problem.bounds.makespan.value if builder.bounds else 0
    domain = cp_model.Domain(least, builder.horizon)
    grid = grid_of(builder.problem)
    if builder.bounds and 1 < grid.count(least, builder.horizon) <= MAX_MAKESPAN_VALUES:
        last = grid.up(builder.horizon)
        domain = cp_model.Domain.from_values([*grid.between(least, last)])
    makespan = builder.model.new_int_var_from_domain(domain, "makespan")
    for i in range(len(builder.starts)):
        tail = builder.problem.bounds.tails[i] if builder.bounds else 0
        builder.enforced(builder.model.add(makespan >= builder.end(i) + tail), i)
    return makespan


def values_of(
    builder: Builder, makespan: cp_model.IntVar, literals: DemandLiterals
) -> dict[str, Expression]:
    """The expression of each objective of the problem, and of the makespan."""
    problem = builder.problem
    named = {part for name in problem.objectives for _, part in terms_of(name)}
    values: dict[str, Expression] = {"makespan": makespan}
    values |= dated_values(builder, named)
    if "reward" in named:
        rewards = [(a.details.reward, p) for a, p in _occurring(builder) if a.details.reward]
        rewards += [
            (g.reward, builder.groups[k])
            for k, g in enumerate(problem.groups)
            if g.reward and g.members
        ]
        values["reward"] = _sum_of_present(rewards)
    if "cost" in named:
        costs = [(a.details.cost, p) for a, p in _occurring(builder) if a.details.cost]
        costs += [
            (mode.cost, chosen)
            for a, literals in zip(problem.activities, builder.modes, strict=True)
            for mode, chosen in zip(a.details.modes, literals, strict=True)
            if mode.cost
        ]
        values["cost"] = _sum_of_present(costs)
    for name in ("setup_time", "setup_cost"):
        if name in named:
            values[name] = setup_values(builder, name)
    if "changes" in named or "changes" in problem.levels:
        values["changes"] = _changes(builder, literals)
    for name in problem.objectives:
        if is_sum(name):
            values[name] = sum(w * values[part] for w, part in whole_terms(problem, name))
    return values


def add_objective(built: Model) -> None:
    """Sets the first objective of the problem."""
    name = built.problem.objectives[0]
    set_objective(built.model, name, built.values[name])


def set_objective(model: cp_model.CpModel, name: str, value: Any) -> None:
    """Makes a value the objective of a model: a reward is maximised, all others are minimised."""
    if name == "reward":
        model.maximize(value)
    else:
        model.minimize(value)


def _changes(builder: Builder, literals: DemandLiterals) -> Expression:
    """The number of activities that are not where the previous plan has them."""
    changed: list[Expression] = []
    for i, place in enumerate(builder.problem.previous.places):
        if place is None:
            continue
        activity = builder.problem.activities[i]
        stays = builder.model.new_bool_var(f"as before {name_of(activity)}")
        changed.append(~stays)
        implied = [] if (present := builder.present[i]) is None else [present]
        if place.mode is not None:
            implied.append(builder.modes[i][place.mode])
        for demand, choices in zip(activity.open_demands, literals[i], strict=True):
            taken = place.resources[demand.use]
            implied += [
                literal
                for r, literal in choices
                if taken in builder.problem.contention.pools[r].members
            ]
        for literal in implied:
            builder.model.add_implication(stays, literal)
        start = builder.model.add(builder.starts[i] == place.start)
        start.only_enforce_if(stays)
    return sum(changed) if changed else 0


def _occurring(builder: Builder) -> list[tuple[Activity, Literal | None]]:
    return list(zip(builder.problem.activities, builder.present, strict=True))


def _sum_of_present(amounts: Sequence[tuple[int, Literal | None]]) -> Expression:
    """Σ amount · present."""
    return sum(amount if present is None else amount * present for amount, present in amounts)
