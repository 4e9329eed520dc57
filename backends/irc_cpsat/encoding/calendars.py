"""Calendars in a CP-SAT model: fixed intervals for the capacity that is missing."""

from __future__ import annotations

from itertools import pairwise

from irc.problem import ContendedPool
from irc_cpsat.encoding.builder import Builder, ResourceUses


def with_windows(
    builder: Builder, pool: ContendedPool, uses: ResourceUses, moments: int
) -> ResourceUses:
    """The uses of a resource, and a fixed interval for the capacity that each window lacks.

    With several `moments` a tick, one for each rank, a capacity that falls does so behind all
    ranks of its instant, and one that rises before them.
    """
    filled = ResourceUses(list(uses.intervals), list(uses.amounts), list(uses.pauses))
    steps = _steps(builder, pool)
    capacity = steps[0][1]
    placed = []
    for time, following in steps:
        falls = following < capacity
        placed.append(((time + 1) * moments - 1 if falls else time * moments, following))
        capacity = following
    for (start, capacity), (end, _) in pairwise(placed):
        if start < end and capacity < pool.capacity:
            away = builder.model.new_fixed_size_interval_var(start, end - start, f"away {pool.id}")
            filled.add(away, pool.capacity - capacity)
    return filled


def _steps(builder: Builder, pool: ContendedPool) -> list[tuple[int, int]]:
    """The times from which the resource has each capacity; the last one is after the horizon."""
    *steps, last = pool.levels()
    until = max(builder.horizon + 1, last[0])
    if last[0] < until:
        steps.append(last)
    return [*steps, (until, pool.capacity)]
