"""Functions with all that can be compiled."""

# Arrays have no types here.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from typing import Annotated

from irc.local_search.compiled import Ints, Row, Table, Tables

STEP = 3
IS_ON = True
Two = Annotated[tuple[Row, ...], 2]
Pair = tuple[Row, Row]


def arithmetic(a: int, b: int, out: Row) -> int:
    """All operations; of division by 0, an error with its line."""
    out[0], out[1], out[2] = a + b, a - b, a * b
    out[3] = a // b
    out[4] = a % b
    out[5], out[6], out[7] = a & b, a | b, a ^ b
    out[8], out[9] = a << (b & 7), a >> (b & 7)
    out[10], out[11] = -a, a // -7 + a % 5 + a % -5
    out[12] += a
    out[13] -= b
    return min(a, b, 4) + max(a, b) * STEP


def truths(a: int, b: int, on: bool) -> int:
    """Comparisons, `and`, `or`, `not`, and choices between values."""
    found = 0
    if 0 <= a < b or not (a != b and on):
        found += 1
    both = a > 0 and b > 0
    both = both or _is_even(a)
    if both == on:
        found += 10
    if a and not b:
        found += 100
    low, high = (a, b) if a <= b else (b, a)
    found += 1000 * (1 if IS_ON else 0)
    return found if low == high else found - high + low


def _is_even(a: int) -> bool:
    return a % 2 == 0


def loops(a: int, b: int, seen: Row) -> int:
    """Loops, in and out of which the control jumps."""
    at = 0
    for k in range(a, b, -2):
        for m in range(3):
            if m == 1 and k % 3 == 0:
                continue
            if at >= len(seen):
                break
            seen[at] = k * 10 + m
            at += 1
        if k < -20:
            return -at
    k = 5
    for k in range(a):
        k += 7
    rest = 0
    while True:
        rest += k
        if rest > 50 or k <= 0:
            break
        k -= 1
    for _ in range(b):
        rest += STEP
    return at + 1000 * rest


def arrays(table: Table, cube: Tables, two: Two, more: Row) -> int:
    """Rows, parts of tuples, sizes."""
    one, other = two[0], two[1]
    total = len(more) + table.shape[1] * cube.shape[2] + cube.shape[0]
    for r in range(len(table)):
        row = table[r]
        for c in range(len(row)):
            row[c] += one[c % len(one)] * other[r % len(other)]
        plane = cube[r % len(cube)]
        plane[0, 1] = row[0]
        plane[1][2] += 1
    total += _sum((two[0], two[1]), more, cube[0])
    first, last = _ends(more)
    return total * 100 + first * 10 + last


def _sum(pair: Pair, more: Ints, plane: Ints) -> int:
    total = plane[0, 1] + plane[1, 2]
    one, other = pair
    for k in range(len(one)):
        total += one[k]
    for k in range(len(other)):
        total -= other[k] * more[0]
    return total


def _ends(more: Ints) -> tuple[int, int]:
    return more[0], more[len(more) - 1]


def set_all(more: Row, value: int) -> None:
    """Returns nothing."""
    if value < 0:
        return
    for k in range(len(more)):
        more[k] = value
