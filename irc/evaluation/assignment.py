"""The assignment of rows to columns of greatest total weight, by OR-Tools."""

from __future__ import annotations

from collections.abc import Sequence

_STEPS = 10**6
"""Weights are compared in whole steps of a millionth."""


def best_assignment(weights: Sequence[Sequence[float]]) -> dict[int, int]:
    """By row: its column, so that the sum of the weights is greatest; no column is used twice.

    Where there are more rows than columns, the rows that are left have none. Weights are rounded
    to a millionth.
    """
    from ortools.graph.python.linear_sum_assignment import SimpleLinearSumAssignment

    rows = len(weights)
    columns = len(weights[0]) if rows else 0
    size = max(rows, columns)
    solver = SimpleLinearSumAssignment()
    # The solver wants as many rows as columns: those that are added weigh nothing.
    for row in range(size):
        for column in range(size):
            real = row < rows and column < columns
            weight = round(_STEPS * weights[row][column]) if real else 0
            solver.add_arc_with_cost(row, column, -weight)
    if size and solver.solve() != solver.OPTIMAL:
        raise ValueError("the weights are too large to be compared")
    taken = {row: solver.right_mate(row) for row in range(rows)}
    return {row: column for row, column in taken.items() if column < columns}
