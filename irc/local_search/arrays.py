"""Arrays of whole numbers, on which loops of searches work. numpy is loaded when one is made."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Sized
from itertools import accumulate
from typing import Any

Ints = Any
"""An array of whole numbers of 64 bits, or a table of them."""


def ints(values: Iterable[int]) -> Ints:
    """Whole numbers as loops take them."""
    import numpy

    return numpy.fromiter(values, numpy.int64)


def constant(value: int, count: int) -> Ints:
    """A number, `count` times."""
    import numpy

    return numpy.full(count, value, numpy.int64)


def table(rows: int, columns: int) -> Ints:
    """A table of zeros."""
    import numpy

    return numpy.zeros((rows, columns), numpy.int64)


def places(rows: Iterable[Sized]) -> Ints:
    """Where the entries of each row begin in one list of all, and where the last one ends."""
    return ints([0, *accumulate(map(len, rows))])


def columns(rows: Sequence[Sequence[tuple[int, ...]]], count: int) -> tuple[Ints, ...]:
    """The entries of all rows in one list, each of their parts as an array."""
    return tuple(ints(entry[k] for row in rows for entry in row) for k in range(count))


def stacked(rows: Sequence[Ints]) -> Ints:
    """Arrays as the rows of one table, which is as wide as the longest."""
    found = table(len(rows), max(map(len, rows)))
    for own, row in zip(found, rows, strict=True):
        own[: len(row)] = row
    return found


def first_random(seed: int) -> int:
    """The number from which a compiled search draws its random numbers; never 0."""
    return 1 + (seed * 7919 + 12345) % 2147483646
