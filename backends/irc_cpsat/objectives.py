"""What counts, as expressions over a CP-SAT model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ortools.sat.python import cp_model

from irc.passes.grid import grid_of
from irc.problem import Activity
from irc_cpsat.names import name_of

if TYPE_CHECKING:
    from irc_cpsat.builder import Builder, Expression, Literal

    Claims = Sequence[Sequence[Sequence[tuple[int, Literal]]]]


MAKESPANS = 5_000
"""With more than so many possible ones the makespan is any number in between."""


def makespan(builder: Builder) -> cp_model.IntVar:
    """A variable that no end is behind; with bounds one of the makespans of best schedules."""
    least = builder.problem.bound.value if builder.bounds else 0
    domain = cp_model.Domain(least, builder.horizon)
    grid = grid_of(builder.problem)
    if builder.bounds and 1 < grid.count(least, builder.horizon) <= MAKESPANS:
        last = grid.up(builder.horizon)
        domain = cp_model.Domain.from_values([*grid.between(least, last)])
    latest = builder.model.new_int_var_from_domain(domain, "makespan")
    for i in range(len(builder.starts)):
        tail = builder.problem.tails[i] if builder.bounds else 0
        builder.enforced(builder.model.add(latest >= builder.end(i) + tail), i)
    return latest


def values_of(builder: Builder, latest: cp_model.IntVar, literals: Claims) -> dict[str, Expression]:
    """What each objective of the problem comes to, and the makespan, which is `latest`.

    `literals` are those of the claims, as in the `Model`.
    """
    values: dict[str, Expression] = {"makespan": latest}
    objectives = builder.problem.objectives
    if "tardiness" in objectives:
        values["tardiness"] = _tardiness(builder)
    if "reward" in objectives:
        worth = [(a.details.reward, p) for a, p in _occurring(builder) if a.details.reward]
        worth += [
            (g.reward, builder.groups[k])
            for k, g in enumerate(builder.problem.groups)
            if g.reward and g.members
        ]
        values["reward"] = _weighted(worth)
    if "cost" in objectives:
        values["cost"] = _weighted(
            [(a.details.cost, p) for a, p in _occurring(builder) if a.details.cost]
        )
    if "changes" in builder.problem.levels:
        values["changes"] = _changes(builder, literals)
    return values


def _changes(builder: Builder, literals: Claims) -> Expression:
    """How many activities are not where the earlier schedule has them."""
    changed: list[Expression] = []
    for i, earlier in enumerate(builder.problem.earlier):
        if earlier is None:
            continue
        activity = builder.problem.activities[i]
        stays = builder.model.new_bool_var(f"as before {name_of(activity)}")
        changed.append(~stays)
        implied = [] if (present := builder.present[i]) is None else [present]
        if earlier.mode is not None:
            implied.append(builder.modes[i][earlier.mode])
        for claim, choices in zip(activity.claims, literals[i], strict=True):
            taken = earlier.resources[claim.use]
            implied += [
                literal for r, literal in choices if taken in builder.problem.shared[r].members
            ]
        for literal in implied:
            builder.model.add_implication(stays, literal)
        start = builder.model.add(builder.starts[i] == earlier.start)
        start.only_enforce_if(stays)
    return sum(changed) if changed else 0


def _occurring(builder: Builder) -> list[tuple[Activity, Literal | None]]:
    return list(zip(builder.problem.activities, builder.present, strict=True))


def _tardiness(builder: Builder) -> Expression:
    late = []
    for i, activity in enumerate(builder.problem.activities):
        due, weight = activity.details.due, activity.details.weight
        if due is not None and weight:
            late.append(weight * _late(builder, [i], due, builder.present[i], name_of(activity)))
    for k, group in enumerate(builder.problem.groups):
        if group.due is not None and group.weight and group.members:
            late.append(
                group.weight
                * _late(builder, list(group.members), group.due, builder.groups[k], group.id)
            )
    return sum(late) if late else 0


def _late(
    builder: Builder, whose: list[int], due: int, literal: Literal | None, name: str
) -> Expression:
    late = builder.model.new_int_var(0, max(0, builder.horizon - due), f"late {name}")
    for i in whose:
        constraint = builder.model.add(late >= builder.end(i) - due)
        if literal is not None:
            constraint.only_enforce_if(literal)
    return late


def _weighted(worth: Sequence[tuple[int, Literal | None]]) -> Expression:
    """Σ amount · present."""
    return sum(amount if literal is None else amount * literal for amount, literal in worth)
