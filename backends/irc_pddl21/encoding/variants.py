"""The ways to carry out an activity: its mode, the pool of each open demand, the units it takes."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product
from typing import NamedTuple

from irc.problem import OpenDemand, Problem
from irc_pddl21.encoding.modes import demands_in, modes_of, span_of
from irc_pddl21.encoding.resources import ResourceUnits


class Variant(NamedTuple):
    """One way to ground an activity.

    `resources` gives the pool of each of the `demands` that this mode has. `span`: the least and
    the greatest duration, in ticks; of what pauses, its working time.
    """

    mode: int | None
    span: tuple[int, int]
    demands: tuple[OpenDemand, ...] = ()
    resources: tuple[int, ...] = ()
    tokens: tuple[str, ...] = ()
    takes: tuple[tuple[str, int], ...] = ()


def variants_of(problem: Problem, i: int, units: ResourceUnits) -> Iterator[Variant]:
    """Every mode of activity i, with every choice of resources, with every choice of tokens.

    Open demands on one pool add up. What lasts 0 holds nothing, whether or not there is room
    (docs/semantics.md, rule 4); only where couplings are about its resources does it choose any.
    """
    activity = problem.activities[i]
    for mode in modes_of(activity):
        demands, span = demands_in(activity, mode), span_of(activity, mode)
        if span[1]:
            yield from _holding(problem, mode, span, demands, units)
        if not span[1] or (demands and not span[0]):
            yield from _at_once(mode, demands if i in problem.coupled else ())


def _holding(
    problem: Problem,
    mode: int | None,
    span: tuple[int, int],
    demands: tuple[OpenDemand, ...],
    units: ResourceUnits,
) -> Iterator[Variant]:
    """The variants that take units."""
    pools = problem.contention.pools
    for resources in product(*(demand.alternatives for demand in demands)):
        amounts: dict[int, int] = {}
        for demand, r in zip(demands, resources, strict=True):
            amounts[r] = amounts.get(r, 0) + demand.amount
        if any(amount > pools[r].capacity for r, amount in amounts.items()):
            continue
        with_setups = any(problem.resources[k].setups for r in amounts for k in pools[r].members)
        counters = units.counters
        takes = tuple((counters[r], n) for r, n in amounts.items() if r in counters)
        token_sets = (
            combinations(units.tokens[r], n) for r, n in amounts.items() if r not in counters
        )
        for chosen in product(*token_sets):
            tokens = tuple(t for some in chosen for t in some)
            # (What lasts 0 needs no set-up, and changes none.)
            least = max(span[0], 1) if with_setups else span[0]
            yield Variant(mode, (least, span[1]), demands, resources, tokens, takes)


def _at_once(mode: int | None, demands: tuple[OpenDemand, ...]) -> Iterator[Variant]:
    """The variants of no duration, which hold nothing."""
    for resources in product(*(demand.alternatives for demand in demands)):
        yield Variant(mode, (0, 0), demands, resources)
