"""What stands for the units of shared resources.

Capacity is one token fact for each unit; where tokens would multiply beyond the budget a counter
takes their place. A unit that a calendar takes away at times has a fact that says it is there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import comb

from irc.problem import Activity, Claim, Problem
from irc.targets import Refusal
from irc_pddl21.domain import TimedLiteral
from irc_pddl21.grounded import Grounded
from irc_pddl21.names import NameTable

MAX_VARIANTS = 256
"""An activity with more ground variants gets counters in place of tokens, or is refused."""


@dataclass
class Units:
    """What stands for the units of shared resources: token facts, or a counter.

    `here` maps a token to the fact that its unit is there, where it is not always.
    """

    tokens: dict[int, list[str]] = field(default_factory=dict)
    counters: dict[int, str] = field(default_factory=dict)
    here: dict[str, str] = field(default_factory=dict)


def units_of(problem: Problem, names: NameTable, out: Grounded) -> Units:
    """Declares a token fact for each unit of a contended resource, or a counter.

    Raises `Refusal` where an activity has too many ways to be carried out even so.
    """
    units = Units()
    for r in resources_by_counter(problem):
        name = names.new(f"left_of_{problem.shared[r].id}")
        units.counters[r] = name
        out.encoding.counters[name] = problem.shared[r].capacity
        out.tokens[name] = f"units of {problem.shared[r].id!r} left"
    for r in sorted({r for a in problem.activities for c in a.claims for r in c.alternatives}):
        if r in units.counters:
            continue
        shared = problem.shared[r]
        units.tokens[r] = [names.new(f"free_{shared.id}_{k + 1}") for k in range(shared.capacity)]
        out.encoding.facts += units.tokens[r]
        out.encoding.initial += units.tokens[r]
        for token in units.tokens[r]:
            out.tokens[token] = f"a unit of {shared.id!r}"
        _calendar(problem, r, units, names, out)
    return units


def _calendar(problem: Problem, r: int, units: Units, names: NameTable, out: Grounded) -> None:
    """The k-th unit is there while the capacity is at least k; units gone together share a fact.

    What it takes away is a slack late: an action may end when its unit goes.
    """
    steps = _capacities(problem, r)
    facts: dict[tuple[bool, ...], str] = {}
    for k, token in enumerate(units.tokens[r], start=1):
        there = tuple(capacity >= k for _, capacity in steps)
        if all(there):
            continue
        if there not in facts:
            fact = names.new(f"here_{token.removeprefix('free_')}")
            facts[there] = fact
            out.encoding.facts.append(fact)
            out.encoding.initial += [fact] if there[0] else []
            for n in range(1, len(steps)):
                if there[n] != there[n - 1]:
                    time = steps[n][0] * out.scale + (0 if there[n] else out.slack)
                    out.encoding.timed.append(TimedLiteral(time, fact, there[n]))
        units.here[token] = facts[there]


def _capacities(problem: Problem, r: int) -> list[tuple[int, int]]:
    """(From when on, capacity), in order of time."""
    shared = problem.shared[r]
    base = shared.capacity if shared.base is None else shared.base
    steps = [(0, base)]
    for window in shared.windows:
        if window.start <= steps[-1][0]:
            steps[-1] = (window.start, window.capacity)
        else:
            steps.append((window.start, window.capacity))
        steps.append((window.end, base))
    return steps


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
