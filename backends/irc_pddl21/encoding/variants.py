"""The ways to carry out an activity: its mode, the pool of each open demand, the units it takes."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product
from typing import NamedTuple

from irc.problem import Activity, OpenDemand, Problem
from irc_pddl21.encoding.modes import demands_in, modes_of, span_of
from irc_pddl21.encoding.resources import ResourceUnits


class Variant(NamedTuple):
    """One way to ground an activity.

    `resources` gives the pool of each of the `demands` that this mode has. `span`: the least and
    the greatest duration, in ticks.
    """

    mode: int | None
    span: tuple[int, int]
    demands: tuple[OpenDemand, ...] = ()
    resources: tuple[int, ...] = ()
    tokens: tuple[str, ...] = ()
    takes: tuple[tuple[str, int], ...] = ()


def variants_of(problem: Problem, activity: Activity, units: ResourceUnits) -> Iterator[Variant]:
    """Every mode, with every choice of resources, with every choice of tokens.

    Open demands on one pool add up. Where a range of durations begins at 0, it may also last 0 and
    hold nothing, whether or not there is room (docs/semantics.md, rule 4).
    """
    for mode in modes_of(activity):
        demands, span = demands_in(activity, mode), span_of(activity, mode)
        for resources in product(*(demand.alternatives for demand in demands)):
            amounts: dict[int, int] = {}
            for demand, r in zip(demands, resources, strict=True):
                amounts[r] = amounts.get(r, 0) + demand.amount
            if any(amount > problem.contention.pools[r].capacity for r, amount in amounts.items()):
                continue
            counters = units.counters
            takes = tuple((counters[r], n) for r, n in amounts.items() if r in counters)
            token_sets = (
                combinations(units.tokens[r], n) for r, n in amounts.items() if r not in counters
            )
            for chosen in product(*token_sets):
                tokens = tuple(t for some in chosen for t in some)
                yield Variant(mode, span, demands, resources, tokens, takes)
        if demands and not span[0]:
            yield Variant(mode, (0, 0))
