"""Reservoirs in a CP-SAT model: one reservoir constraint each."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from irc.problem import Reservoir
from irc_cpsat.encoding.builder import Builder


@dataclass
class _StockChanges:
    """The changes of one reservoir: when, by how much, and whether they happen."""

    times: list[Any] = field(default_factory=list)
    amounts: list[int] = field(default_factory=list)
    actives: list[Any] = field(default_factory=list)


def add_reservoirs(builder: Builder) -> None:
    """Adds every reservoir.

    Levels count from the initial one; changes of one instant are seen together.
    """
    changes = [_StockChanges() for _ in builder.problem.reservoirs]
    for i, activity in enumerate(builder.problem.activities):
        for change in activity.details.stock:
            own = changes[change.reservoir]
            own.times.append(builder.end(i) if change.at_end else builder.starts[i])
            own.amounts.append(change.amount)
            literal = builder.present[i]
            own.actives.append(True if literal is None else literal)
    for reservoir, own in zip(builder.problem.reservoirs, changes, strict=True):
        if own.times:
            _add_reservoir(builder, reservoir, own)


def _add_reservoir(builder: Builder, reservoir: Reservoir, changes: _StockChanges) -> None:
    below = sum(a for a in changes.amounts if a < 0)
    above = sum(a for a in changes.amounts if a > 0)
    if reservoir.greatest is not None:
        above = min(above, reservoir.greatest - reservoir.initial)
    builder.model.add_reservoir_constraint_with_active(
        changes.times,
        changes.amounts,
        changes.actives,
        max(below, reservoir.least - reservoir.initial),
        above,
    )
