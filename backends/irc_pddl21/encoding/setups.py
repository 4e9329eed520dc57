"""Set-ups in PDDL: a fact for each family that a resource is ready for, and set-ups as actions.

The end of a use makes its resource ready for the families that need no set-up after it. For each
other family there is an action of the planner alone: it begins after the use, takes the unit until
it is done, and makes the resource ready for that one family. A use takes the readiness away, as
does a set-up, so that there is one set-up between two uses at most: the one from the first to the
second. No open times bind it, and it may begin at any time after the use. Where set-ups count, a
set-up that takes no time is an instant. A limit on their time or cost is a counter, too, which no
set-up may push beyond it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from irc.problem import Problem, Setup, Setups
from irc.problem.setups import setups_from_now
from irc.targets import Refusal
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.objectives import ObjectiveCounter
from irc_pddl21.encoding.pddl import (
    Additions,
    NumericCondition,
    NumericEffect,
    Operator,
    TimedLiteral,
)
from irc_pddl21.encoding.resources import ResourceUnits
from irc_pddl21.encoding.variants import Variant

MOST_SETUPS = 5_000
"""The most set-ups that are written out."""

BEGINNING = "beginning"
"""Stands for the use before the first one."""

Before = int | str
"""The family (index) of a use, or the beginning."""


class SetupCounter(NamedTuple):
    """A counter of set-ups with weights for their time (ticks) and cost; `most`: its limit."""

    name: str
    weights: Setup
    most: int | None = None

    def amount(self, setup: Setup) -> int:
        """The amount that a set-up adds to it."""
        return self.weights.time * setup.time + self.weights.cost * setup.cost


@dataclass
class _Resource:
    """The facts of one resource: what it is ready for, and after which uses a set-up may begin."""

    setups: Setups
    token: str
    counters: Sequence[SetupCounter]
    ready: dict[int, str] = field(default_factory=dict)
    after: dict[Before, str] = field(default_factory=dict)

    def between(self, before: Before, family: int) -> Setup:
        """The set-up between two uses, or from the beginning."""
        if isinstance(before, str):
            return self.setups.first(family)
        return self.setups.between(before, family)

    def counts(self, before: Before, family: int) -> bool:
        """Whether a set-up takes time, or adds to a counter."""
        setup = self.between(before, family)
        return bool(setup.time) or any(c.amount(setup) for c in self.counters)

    def made_by(self, before: Before) -> tuple[str, ...]:
        """The facts that hold when a use has ended, or at the beginning."""
        facts = [fact for f, fact in self.ready.items() if not self.counts(before, f)]
        return (*facts, self.after[before]) if before in self.after else tuple(facts)

    @property
    def facts(self) -> tuple[str, ...]:
        """All facts, which a use or a set-up takes away."""
        return (*self.ready.values(), *self.after.values())


@dataclass
class SetupFacts:
    """The additions of set-ups to the variants that use resources which have them.

    `resources` are those (by the index of their pools).
    """

    problem: Problem
    resources: dict[int, _Resource] = field(default_factory=dict)

    def of(self, i: int, variant: Variant) -> list[Additions]:
        """The additions to a variant of activity i."""
        found = []
        activity = self.problem.activities[i]
        for demand, r in zip(variant.demands, variant.resources, strict=True):
            resource = self.resources.get(r)
            if resource is None or not variant.span[1]:
                continue
            family = activity.uses[demand.use].family
            start, waived = activity.start, resource.setups.waived_before
            needs = () if start is not None and start < waived else (resource.ready[family],)
            found.append(
                Additions(
                    at_start=needs,
                    start_deletes=resource.facts,
                    end_adds=resource.made_by(family),
                )
            )
        return found


def uses_with_setups(problem: Problem) -> int:
    """The number of activities that may need a set-up."""
    pools = {
        p
        for p, pool in enumerate(problem.contention.pools)
        if any(problem.resources[r].setups for r in pool.members)
    }
    return sum(
        any(r in pools for demand in a.open_demands for r in demand.alternatives)
        for a in problem.activities
    )


def counters_of(
    builder: Builder, objective: ObjectiveCounter, limits: Mapping[str, int]
) -> list[SetupCounter]:
    """The counters that set-ups add to: that of the objective, and one for each limit.

    `limits` are the greatest set-up time (ticks) and cost, by the short names of the objectives.
    What has been set up already counts.
    """
    problem = builder.problem
    if not problem.has_setups:
        return []
    found = [SetupCounter(objective.counter, objective.of_setups)] * any(objective.of_setups)
    past = [setups_from_now(problem, r)[1] for r, x in enumerate(problem.resources) if x.setups]
    for name, most in sorted(limits.items()):
        weights = Setup(1, 0) if name == "setup_time" else Setup(0, 1)
        counter = builder.names.new(f"sum_of_{name}_within_a_limit")
        limit = SetupCounter(counter, weights, most)
        builder.encoding.counters[counter] = sum(map(limit.amount, past))
        found.append(limit)
    return found


def add_setups(
    builder: Builder, units: ResourceUnits, counters: Sequence[SetupCounter]
) -> SetupFacts:
    """Declares the facts of resources with set-ups, and adds the set-ups.

    Raises `Refusal` where there are more than `MOST_SETUPS`.
    """
    problem = builder.problem
    found = SetupFacts(problem)
    count = 0
    for r, pool in enumerate(problem.contention.pools):
        if problem.resources[pool.members[0]].setups is None or r not in units.tokens:
            continue
        setups, _ = setups_from_now(problem, pool.members[0])
        resource = _Resource(setups, units.tokens[r][0], counters)
        families = _families(problem, r)
        for f in families:
            resource.ready[f] = builder.fact(builder.names.new(_text(problem, "ready", pool.id, f)))
        befores: tuple[Before, ...] = (BEGINNING, *families)
        for before in befores:
            if any(resource.counts(before, f) for f in families):
                name = builder.names.new(_text(problem, "used", pool.id, before))
                resource.after[before] = builder.fact(name)
        count += sum(resource.counts(b, f) for b in resource.after for f in families)
        if count > MOST_SETUPS:
            raise Refusal(
                f"there are more than {MOST_SETUPS:,} set-ups between families, more than target "
                "'pddl21' writes out",
                (*problem.resources[pool.members[0]].origin, "setups"),
                "use fewer families, or target 'cpsat'",
            )
        found.resources[r] = resource
        _add_resource(builder, pool.id, resource)
    return found


def _families(problem: Problem, r: int) -> list[int]:
    """The families of the uses of a pool, also of those that name none."""
    found = {
        activity.uses[demand.use].family
        for activity in problem.activities
        for demand in activity.open_demands
        if r in demand.alternatives
    }
    return sorted(found)


def _text(problem: Problem, verb: str, pool: str, family: Before) -> str:
    if isinstance(family, str):
        return f"{verb}_{pool}_{family}"
    return f"{verb}_{pool}_{problem.families[family] if family >= 0 else 'plain'}"


def _add_resource(builder: Builder, pool: str, resource: _Resource) -> None:
    """Adds the set-ups of a resource, and what it is ready for at first."""
    builder.encoding.initial += resource.made_by(BEGINNING)
    begins = _beginning(builder, pool, resource.setups.since)
    for f, fact in resource.ready.items():
        builder.grounded.tokens[fact] = f"{pool!r} needs no set-up for {_shown(builder, f)}"
    for before, used in resource.after.items():
        builder.grounded.tokens[used] = f"the last use of {pool!r} was {_shown(builder, before)}"
        for f in resource.ready:
            if resource.counts(before, f):
                needs = [used, *(begins if before == BEGINNING else ())]
                operator = _setup(builder, resource, before, f, needs)
                shown = f"from {_shown(builder, before)} to {_shown(builder, f)}"
                if operator is not None:
                    builder.add_helper(operator, f"the set-up of {pool!r} {shown}")


def _setup(
    builder: Builder, resource: _Resource, before: Before, family: int, needs: list[str]
) -> Operator | None:
    """The set-up for a family; None where it is beyond a limit by itself."""
    setup, ready = resource.between(before, family), resource.ready[family]
    amounts = [(counter, counter.amount(setup)) for counter in resource.counters]
    if any(counter.most is not None and n > counter.most for counter, n in amounts):
        return None
    used = resource.after[before]
    name = builder.names.new(f"setup_{used.removeprefix('used_')}_{ready.removeprefix('ready_')}")
    length = setup.time * builder.scale.units_per_tick
    facts = [fact for fact in resource.facts if setup.time or fact != ready]
    return Operator(
        name,
        (length, length) if length else None,
        at_start=[*needs[:1], resource.token, *needs[1:]],
        start_deletes=[*facts, resource.token] if length else facts,
        end_adds=[ready, resource.token] if length else [ready],
        needs=[
            NumericCondition("start", "<=", counter.name, counter.most - amount)
            for counter, amount in amounts
            if counter.most is not None and amount
        ],
        changes=[NumericEffect(False, c.name, amount) for c, amount in amounts if amount],
    )


def _beginning(builder: Builder, pool: str, since: int) -> tuple[str, ...]:
    """The fact from which on a set-up for the first use may begin, if it may not at once."""
    if not since:
        return ()
    name = builder.names.new(f"setups_from_{since}_of_{pool}")
    builder.grounded.tokens[name] = f"{pool!r} may be set up for its first use"
    time = since * builder.scale.units_per_tick
    builder.encoding.timed.append(TimedLiteral(time, builder.fact(name), True))
    return (name,)


def _shown(builder: Builder, family: Before) -> str:
    if isinstance(family, str):
        return "its state at the beginning"
    return repr(builder.problem.families[family]) if family >= 0 else "no family"
