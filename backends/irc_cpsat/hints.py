"""A list schedule as the solution from which CP-SAT starts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irc_cpsat.builder import Builder, Model


def add_hint(
    builder: Builder,
    built: Model,
    decisions: Sequence[Any],
    choices: Sequence[tuple[int, ...]],
) -> None:
    """A complete assignment, so that CP-SAT starts from a schedule."""
    for i, decision in enumerate(decisions):
        builder.model.add_hint(built.starts[i], decision.start)
        end = built.ends[i]
        if end is not None:
            builder.model.add_hint(end, decision.end)
        for taken, literals in zip(choices[i], built.literals[i], strict=True):
            for r, literal in literals:
                builder.model.add_hint(literal, int(r == taken))
    for i, size in built.sizes.items():
        builder.model.add_hint(size, decisions[i].end - decisions[i].start)
    for i, literal in built.positive.items():
        builder.model.add_hint(literal, int(decisions[i].end > decisions[i].start))
    hinted = builder.model.proto.solution_hint
    values = dict(zip(hinted.vars, hinted.values, strict=True))
    for both, a, b in builder.both_of:
        builder.model.add_hint(both, values[a.index] * values[b.index])
    latest = max((int(d.end) for d in decisions), default=0)
    builder.model.add_hint(built.makespan, max(latest, builder.problem.bound.value))
