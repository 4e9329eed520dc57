"""Sequences of half-open intervals [start, end) in order, in ticks or in the task's unit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeVar

from irc.model.quantities import Number

T = TypeVar("T", int, Number)


def intersection(one: Sequence[tuple[T, T]], other: Sequence[tuple[T, T]]) -> Iterator[tuple[T, T]]:
    """The times in both, in order; the intervals of each are in order and do not overlap."""
    i = j = 0
    while i < len(one) and j < len(other):
        start, end = max(one[i][0], other[j][0]), min(one[i][1], other[j][1])
        if start < end:
            yield start, end
        if one[i][1] <= other[j][1]:
            i += 1
        else:
            j += 1
