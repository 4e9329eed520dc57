"""Precedence in a CP-SAT model: minimum and maximum lags between starts and ends."""

from __future__ import annotations

from irc.problem import Arc
from irc_cpsat.encoding.builder import Builder


def add_precedence(builder: Builder) -> None:
    """Adds every arc; where ranks exist, minimum lags hold in moments."""
    state_precedences = frozenset(builder.problem.state_precedences)
    for arc in builder.problem.arcs:
        follows_by_state = builder.ranked and (arc.before, arc.after) in state_precedences
        _add_arc(builder, arc, follows_by_state)


def _add_arc(builder: Builder, arc: Arc, follows_by_state: bool) -> None:
    model, horizon = builder.model, builder.horizon
    i, j = arc.before, arc.after
    # Lags beyond the horizon never bind; one that reaches just as far may, in ranks.
    if arc.min_lag >= -horizon:
        apart = builder.moment(j, at_end=arc.to_end) - builder.moment(i, at_end=arc.from_end)
        least = builder.rank_count * arc.min_lag
        least += 1 if follows_by_state and arc.min_lag == 0 else 0
        builder.enforced(model.add(apart >= least), i, j)
    if arc.max_lag is not None and arc.max_lag < horizon:
        before = builder.end(i) if arc.from_end else builder.starts[i]
        after = builder.end(j) if arc.to_end else builder.starts[j]
        builder.enforced(model.add(after - before <= arc.max_lag), i, j)
