"""Calendars in a CP-SAT model: fixed intervals for the capacity that is missing."""

from __future__ import annotations

from irc.problem import Shared
from irc_cpsat.encoding.builder import Builder, ResourceUses


def with_windows(builder: Builder, shared: Shared, uses: ResourceUses) -> ResourceUses:
    """The uses of a resource, and a fixed interval for the capacity that each window lacks."""
    filled = ResourceUses(list(uses.intervals), list(uses.amounts))
    base = shared.capacity if shared.base is None else shared.base
    at = 0
    for window in (*shared.windows, None):
        until = builder.horizon + 1 if window is None else window.start
        _fill(builder, filled, shared, at, until, base)
        if window is not None:
            _fill(builder, filled, shared, window.start, window.end, window.capacity)
            at = window.end
    return filled


def _fill(
    builder: Builder, filled: ResourceUses, shared: Shared, start: int, end: int, capacity: int
) -> None:
    if start < end and capacity < shared.capacity:
        away = builder.model.new_fixed_size_interval_var(start, end - start, f"away {shared.id}")
        filled.add(away, shared.capacity - capacity)
