"""The load bound: how many loads amounts need, and how long they take one after another."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import pytest

import irc
from irc.lowering.lower import lower
from irc.model import Task
from irc.passes import run_passes
from irc.passes.load_bound import least_loads


def fewest(amounts: list[int], capacity: int) -> int:
    """The number of loads, by first fit in every order."""
    best = len(amounts)
    for order in permutations(amounts):
        rooms: list[int] = []
        for amount in order:
            k = next((k for k, room in enumerate(rooms) if room >= amount), None)
            if k is None:
                rooms.append(capacity - amount)
            else:
                rooms[k] -= amount
        best = min(best, len(rooms))
    return best


@pytest.mark.parametrize(
    "amounts", [[6, 6, 6], [5, 5, 5], [4, 4, 4, 4], [1, 9, 5, 6], [7, 3, 7, 3, 2], [10, 1]]
)
def test_it_is_never_more_than_what_is_possible(amounts: list[int]) -> None:
    assert least_loads(amounts, 10) <= fewest(amounts, 10)


def test_large_amounts_are_alone() -> None:
    assert least_loads([6, 6, 6, 4, 3, 3], 10) == 3
    assert least_loads([6, 6, 6, 4, 4, 4, 1], 10) == 4


def bound(*actions: tuple[Any, int, str | None]) -> int:
    uses = [
        {"resource": "oven", "amount": amount, **({"family": family} if family else {})}
        for _, amount, family in actions
    ]
    task = {
        "resources": [{"id": "oven", "kind": "batch", "capacity": 10}],
        "actions": [
            {"id": f"a{k}", "duration": duration, "uses": [use], "release": 2}
            for k, ((duration, _, _), use) in enumerate(zip(actions, uses, strict=True))
        ],
    }
    found = run_passes(lower(Task.model_validate(task)))
    assert irc.solve(task).makespan >= found.to_units(found.bounds.makespan.value)
    return int(found.to_units(found.bounds.makespan.value))


def test_parts_that_share_no_load_come_one_after_another() -> None:
    assert bound((3, 4, "red"), (3, 4, "red"), (3, 4, "blue")) == 8
    assert bound((3, 4, None), (5, 4, None)) == 10
    assert bound((3, 6, None), (3, 6, None), (3, 4, None)) == 8


def test_ranges_fill_loads_together() -> None:
    wide = {"min": 3, "max": 9}
    assert bound((wide, 4, None), (5, 4, None)) == 7
    assert bound((wide, 4, None), (5, 4, None), (5, 4, None), (7, 4, None)) == 14
