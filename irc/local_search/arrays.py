"""Arrays of whole numbers, on which loops of searches work. numpy is loaded when one is made."""

from __future__ import annotations

from collections.abc import Iterable
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
