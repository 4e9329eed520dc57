"""The assignment of rows to columns of greatest total weight."""

from __future__ import annotations

from collections.abc import Sequence

_INFINITE = float("inf")


def best_assignment(weights: Sequence[Sequence[float]]) -> dict[int, int]:
    """By row: its column, so that the sum of the weights is greatest; no column is used twice.

    Where there are more rows than columns, the rows that are left have none. The method is the
    Hungarian one with potentials and shortest augmenting paths (Jonker, Volgenant 1987).
    """
    rows = len(weights)
    columns = len(weights[0]) if rows else 0
    if rows > columns:
        turned = [[weights[r][c] for r in range(rows)] for c in range(columns)]
        return {row: column for column, row in best_assignment(turned).items()}
    owner = _owners([[-w for w in row] for row in weights], rows, columns)
    return {row: column for column, row in enumerate(owner) if row >= 0}


def _owners(cost: list[list[float]], rows: int, columns: int) -> list[int]:
    """By column: the row that has it, -1 for none, at the least total cost."""
    row_price = [0.0] * rows
    column_price = [0.0] * columns
    owner = [-1] * columns
    for start in range(rows):
        distance = [_INFINITE] * columns
        came_from = [-1] * columns
        done = [False] * columns
        row, last = start, -1
        while row >= 0:
            nearest, step = -1, _INFINITE
            prices, base = cost[row], row_price[row]
            for c in range(columns):
                if done[c]:
                    continue
                reduced = prices[c] - base - column_price[c]
                if reduced < distance[c]:
                    distance[c], came_from[c] = reduced, last
                if distance[c] < step:
                    nearest, step = c, distance[c]
            _reprice(step, start, owner, done, row_price, column_price, distance)
            done[nearest], last, row = True, nearest, owner[nearest]
        _augment(last, start, came_from, owner)
    return owner


def _reprice(
    step: float,
    start: int,
    owner: list[int],
    done: list[bool],
    row_price: list[float],
    column_price: list[float],
    distance: list[float],
) -> None:
    """Moves the prices by the length of the step, which makes the nearest column free."""
    row_price[start] += step
    for c, is_done in enumerate(done):
        if is_done:
            row_price[owner[c]] += step
            column_price[c] -= step
        else:
            distance[c] -= step


def _augment(column: int, start: int, came_from: list[int], owner: list[int]) -> None:
    """Gives each column on the path back to the start to the row before it."""
    while column >= 0:
        before = came_from[column]
        owner[column] = start if before < 0 else owner[before]
        column = before
