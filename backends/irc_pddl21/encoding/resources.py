"""Renewable resources in PDDL: the units of pools.

Capacity is one token fact for each unit; where tokens would multiply beyond the budget a counter
takes their place. A unit that a calendar takes away at times has a fact that says it is there.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import comb

from irc.problem import Activity, Problem
from irc.targets import Refusal
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.calendars import add_calendar
from irc_pddl21.encoding.modes import demands_in, modes_of

MAX_VARIANTS = 256
"""An activity with more ground variants gets counters instead of tokens, or is refused."""


@dataclass
class ResourceUnits:
    """The units of pools: token facts, or a counter.

    `here` maps a token to the fact that its unit is there, where it is not always; `kept` to the
    fact that what pauses may keep it: the unit is there, or none is.
    """

    tokens: dict[int, list[str]] = field(default_factory=dict)
    counters: dict[int, str] = field(default_factory=dict)
    here: dict[str, str] = field(default_factory=dict)
    kept: dict[str, str] = field(default_factory=dict)

    def presence_of(self, activity: Activity, tokens: Iterable[str]) -> tuple[str, ...]:
        """The facts that an activity needs throughout on account of the calendars of its units."""
        facts = self.kept if activity.details.keeps_units else self.here
        return tuple(dict.fromkeys(facts[t] for t in tokens if t in facts))


def add_resources(builder: Builder) -> ResourceUnits:
    """Declares a token fact for each unit of a contended resource, or a counter.

    Raises `Refusal` where an activity has too many ways to be carried out even so.
    """
    problem, grounded = builder.problem, builder.grounded
    units = ResourceUnits()
    keeping = {
        r
        for activity in problem.activities
        if activity.details.keeps_units
        for demand in activity.open_demands
        for r in demand.alternatives
    }
    for r in _resources_by_counter(problem):
        name = builder.names.new(f"left_of_{problem.contention.pools[r].id}")
        units.counters[r] = name
        builder.encoding.counters[name] = problem.contention.pools[r].capacity
        grounded.tokens[name] = f"units of {problem.contention.pools[r].id!r} left"
    for r in sorted(
        {r for a in problem.activities for c in a.open_demands for r in c.alternatives}
    ):
        if r in units.counters:
            continue
        pool = problem.contention.pools[r]
        tokens = [builder.names.new(f"free_{pool.id}_{k + 1}") for k in range(pool.capacity)]
        units.tokens[r] = tokens
        builder.encoding.facts += tokens
        builder.encoding.initial += tokens
        grounded.tokens.update(dict.fromkeys(tokens, f"a unit of {pool.id!r}"))
        units.here |= add_calendar(builder, pool, tokens)
        if r in keeping:
            units.kept |= add_calendar(builder, pool.never_away, tokens, "kept_")
    return units


def _resources_by_counter(problem: Problem) -> list[int]:
    """The pools whose tokens would multiply beyond the budget.

    Raises `Refusal` where even counters leave an activity too many variants, or where a counter
    would be needed for a resource that has a calendar.
    """
    by_counter: set[int] = set()
    for activity in problem.activities:
        while _variant_count(problem, activity, by_counter) > MAX_VARIANTS:
            candidates = {
                r
                for demand in activity.open_demands
                for r in demand.alternatives
                if r not in by_counter
                and problem.contention.pools[r].capacity > 1
                and not problem.contention.pools[r].windows
            }
            if not candidates:
                raise Refusal(
                    f"action {activity.id!r} has more than {MAX_VARIANTS} ways to choose its "
                    "resources, more than target 'pddl21' writes out",
                    (*activity.origin, "modes" if activity.details.modes else "uses"),
                    "use fewer alternatives, or target 'cpsat'",
                )
            by_counter.add(max(candidates, key=lambda r: (problem.contention.pools[r].capacity, r)))
    return sorted(by_counter)


def _variant_count(problem: Problem, activity: Activity, by_counter: set[int]) -> int:
    """An upper bound on the ground variants of an activity."""
    total = 0
    for mode in modes_of(activity):
        count = 1
        for demand in demands_in(activity, mode):
            count *= sum(
                1
                if r in by_counter
                else _token_sets(problem.contention.pools[r].capacity, demand.amount)
                for r in demand.alternatives
            )
        total += count
    return total


def _token_sets(capacity: int, amount: int) -> int:
    """The number of sets of `amount` tokens, or one that is too great where it would be huge."""
    if amount >= capacity:
        return 1 if capacity <= MAX_VARIANTS else MAX_VARIANTS + 1
    return MAX_VARIANTS + 1 if capacity > MAX_VARIANTS else comb(capacity, amount)
