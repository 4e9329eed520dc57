"""The ways to carry out an activity: its mode, the resource of each claim, the units it takes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, product

from irc.problem import Activity, Claim, Problem
from irc_pddl21.encoding.modes import claims_in, modes_of
from irc_pddl21.encoding.resources import ResourceUnits


@dataclass(frozen=True, slots=True)
class Variant:
    """One way to ground an activity.

    `resources` gives the shared resource of each of the `claims` that this mode has.
    """

    mode: int | None
    claims: tuple[Claim, ...] = ()
    resources: tuple[int, ...] = ()
    tokens: tuple[str, ...] = ()
    takes: tuple[tuple[str, int], ...] = ()


def variants_of(problem: Problem, activity: Activity, units: ResourceUnits) -> Iterator[Variant]:
    """Every mode, with every choice of resources, with every choice of tokens.

    Claims on one resource add up.
    """
    for mode in modes_of(activity):
        claims = claims_in(activity, mode)
        for resources in product(*(claim.alternatives for claim in claims)):
            amounts: dict[int, int] = {}
            for claim, r in zip(claims, resources, strict=True):
                amounts[r] = amounts.get(r, 0) + claim.amount
            if any(amount > problem.shared[r].capacity for r, amount in amounts.items()):
                continue
            counters = units.counters
            takes = tuple((counters[r], n) for r, n in amounts.items() if r in counters)
            token_sets = (
                combinations(units.tokens[r], n) for r, n in amounts.items() if r not in counters
            )
            for chosen in product(*token_sets):
                tokens = tuple(t for some in chosen for t in some)
                yield Variant(mode, claims, resources, tokens, takes)
