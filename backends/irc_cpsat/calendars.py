"""Calendars in a CP-SAT model."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from irc.problem import Shared

if TYPE_CHECKING:
    from irc_cpsat.builder import Builder, Users


def with_windows(builder: Builder, shared: Shared, users: Users) -> Users:
    """What is missing from the greatest capacity is held by an interval that cannot move."""
    filled = replace(users, intervals=list(users.intervals), amounts=list(users.amounts))
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
    builder: Builder, filled: Users, shared: Shared, start: int, end: int, capacity: int
) -> None:
    if start < end and capacity < shared.capacity:
        away = builder.model.new_fixed_size_interval_var(start, end - start, f"away {shared.id}")
        filled.intervals.append(away)
        filled.amounts.append(shared.capacity - capacity)
