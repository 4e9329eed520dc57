"""The ways to carry out an activity: its mode, the resource of each claim, the units it takes.

Capacity is one token fact for each unit; where tokens would multiply beyond the budget a counter
takes their place. A unit that a calendar takes away at times has a fact that says it is there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations, product
from math import comb

from irc.backend import Refusal
from irc.problem import Activity, Claim, Problem

MAX_VARIANTS = 256
"""An activity with more ground variants gets counters in place of tokens, or is refused."""


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


@dataclass
class Units:
    """What stands for the units of shared resources: token facts, or a counter.

    `here` maps a token to the fact that its unit is there, where it is not always.
    """

    tokens: dict[int, list[str]] = field(default_factory=dict)
    counters: dict[int, str] = field(default_factory=dict)
    here: dict[str, str] = field(default_factory=dict)


def modes_of(activity: Activity) -> range | tuple[None]:
    """The indexes of an activity's modes; None alone where it has none."""
    return range(len(activity.details.modes)) if activity.details.modes else (None,)


def span_of(activity: Activity, mode: int | None) -> tuple[int, int]:
    """Least and greatest duration in a mode, in ticks."""
    if mode is None:
        return activity.duration_min, activity.duration_max
    chosen = activity.details.modes[mode]
    return chosen.duration_min, chosen.duration_max


def claims_in(activity: Activity, mode: int | None) -> tuple[Claim, ...]:
    """The claims of an activity in a mode; what takes no time claims nothing."""
    if mode is None:
        return activity.claims
    if not span_of(activity, mode)[1]:
        return ()
    use_mode = activity.details.use_mode
    return tuple(c for c in activity.claims if use_mode(c.use) in (None, mode))


def variants_of(problem: Problem, activity: Activity, units: Units) -> Iterator[Variant]:
    """Every mode, in it every choice of resources, and of each the tokens.

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


def resources_by_counter(problem: Problem) -> list[int]:
    """The shared resources whose tokens would multiply beyond the budget.

    Raises `Refusal` where even counters leave an activity too many variants, or where a counter
    would be needed for a resource that has a calendar.
    """
    by_counter: set[int] = set()
    for activity in problem.activities:
        while _variant_count(problem, activity, by_counter) > MAX_VARIANTS:
            candidates = {
                r
                for claim in activity.claims
                for r in claim.alternatives
                if r not in by_counter
                and problem.shared[r].capacity > 1
                and not problem.shared[r].windows
            }
            if not candidates:
                raise Refusal(
                    f"action {activity.id!r} has more than {MAX_VARIANTS} ways to choose its "
                    "resources, more than target 'pddl21' writes out",
                    (*activity.origin, "modes" if activity.details.modes else "uses"),
                    "use fewer alternatives, or target 'cpsat'",
                )
            by_counter.add(max(candidates, key=lambda r: (problem.shared[r].capacity, r)))
    return sorted(by_counter)


def _variant_count(problem: Problem, activity: Activity, by_counter: set[int]) -> int:
    """An upper bound on the ground variants of an activity."""
    total = 0
    for mode in modes_of(activity):
        count = 1
        for claim in claims_in(activity, mode):
            count *= sum(
                1 if r in by_counter else _token_sets(problem.shared[r].capacity, claim.amount)
                for r in claim.alternatives
            )
        total += count
    return total


def _token_sets(capacity: int, amount: int) -> int:
    """How many sets of `amount` tokens there are; just "too many" where that would be huge."""
    if amount >= capacity:
        return 1
    return MAX_VARIANTS + 1 if capacity > MAX_VARIANTS else comb(capacity, amount)
