"""Stock in a CP-SAT model: one reservoir constraint each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irc_cpsat.builder import Builder


def add_stock(builder: Builder) -> None:
    """Adds every reservoir.

    Levels count from the initial one; changes of one instant are seen together.
    """
    times: list[list[Any]] = [[] for _ in builder.problem.reservoirs]
    amounts: list[list[int]] = [[] for _ in builder.problem.reservoirs]
    actives: list[list[Any]] = [[] for _ in builder.problem.reservoirs]
    for i, activity in enumerate(builder.problem.activities):
        for change in activity.details.stock:
            r = change.reservoir
            times[r].append(builder.end(i) if change.at_end else builder.starts[i])
            amounts[r].append(change.amount)
            literal = builder.present[i]
            actives[r].append(True if literal is None else literal)
    for r, reservoir in enumerate(builder.problem.reservoirs):
        if not times[r]:
            continue
        most = sum(a for a in amounts[r] if a > 0)
        greatest = reservoir.greatest
        above = most if greatest is None else min(most, greatest - reservoir.initial)
        below = sum(a for a in amounts[r] if a < 0)
        builder.model.add_reservoir_constraint_with_active(
            times[r],
            amounts[r],
            actives[r],
            max(below, reservoir.least - reservoir.initial),
            above,
        )
