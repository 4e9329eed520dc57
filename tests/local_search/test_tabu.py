"""Tabu search keeps heads, tails and the makespan right, whatever moves it makes."""

from __future__ import annotations

import pytest

from builders import after_passes
from irc.local_search.arrays import constant, ints
from irc.local_search.shop import machines_of, room_for
from irc.local_search.tabu import (
    COUNTS,
    HEAD,
    MAKESPAN,
    ORDER,
    READY,
    REST,
    STEP,
    TAIL,
    WAY,
    WAY_AT,
    load,
    search,
)
from irc.local_search.ways import ways_of
from local_search_tasks import larger_shop

ORDERS = 1 << 14


@pytest.mark.parametrize("flexible", [False, True])
@pytest.mark.parametrize("reach", [1, 60])
def test_what_is_found_again_in_part_is_what_is_found_from_nothing(
    reach: int, flexible: bool
) -> None:
    ways = ways_of(after_passes(larger_shop(flexible=flexible)))
    machines = machines_of(ways)
    n, tabu = len(ways.of), constant(0, ORDERS + len(machines.numbers))
    walk, other = (room_for(n, machines.count, ORDERS, 1, reach) for _ in range(2))
    # (Each takes its first way; jobs come one after another.)
    load(machines.shop, walk, tabu, ints(range(n)), ints(machines.shop[WAY_AT, :n]))
    for step in range(1, 41):
        assert search(machines.shop, walk, tabu, 1, 1000, 0) == 1
        assert walk[COUNTS, STEP] == step
        own = ints(walk[ORDER, :n]), ints(walk[WAY, :n])
        load(machines.shop, other, constant(0, len(tabu)), *own)
        for row in (HEAD, READY, TAIL, REST):
            assert walk[row, :n].tolist() == other[row, :n].tolist()
        assert walk[COUNTS, MAKESPAN] == other[COUNTS, MAKESPAN]
