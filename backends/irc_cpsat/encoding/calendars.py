"""Calendars in a CP-SAT model: fixed intervals for the capacity that is missing."""

from __future__ import annotations

from irc.problem import ContendedPool
from irc_cpsat.encoding.builder import Builder, ResourceUses


def with_windows(builder: Builder, pool: ContendedPool, uses: ResourceUses) -> ResourceUses:
    """The uses of a resource, and a fixed interval for the capacity that each window lacks."""
    filled = ResourceUses(list(uses.intervals), list(uses.amounts))
    base = pool.capacity if pool.base is None else pool.base
    at = 0
    for window in (*pool.windows, None):
        until = builder.horizon + 1 if window is None else window.start
        _fill(builder, filled, pool, at, until, base)
        if window is not None:
            _fill(builder, filled, pool, window.start, window.end, window.capacity)
            at = window.end
    return filled


def _fill(
    builder: Builder,
    filled: ResourceUses,
    pool: ContendedPool,
    start: int,
    end: int,
    capacity: int,
) -> None:
    if start < end and capacity < pool.capacity:
        away = builder.model.new_fixed_size_interval_var(start, end - start, f"away {pool.id}")
        filled.add(away, pool.capacity - capacity)
