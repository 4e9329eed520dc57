"""Set-ups in PDDL: a fact for each family that a resource is ready for, and set-ups as actions.

The end of a use makes its resource ready for the families that need no set-up after it. For each
other family there is an action of the planner alone: it begins after the use, takes the unit until
it is done, and makes the resource ready for that one family. A use takes the readiness away, as
does a set-up, so that there is one set-up between two uses at most: the one from the first to the
second. No open times bind it, and it may begin at any time after the use.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from irc.problem import Problem, Setup, Setups
from irc.targets import Refusal
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.pddl import Additions, Operator, TimedLiteral
from irc_pddl21.encoding.resources import ResourceUnits
from irc_pddl21.encoding.variants import Variant

MOST_SETUPS = 5_000
"""The most set-ups that are written out."""

BEGINNING = "beginning"
"""Stands for the use before the first one."""

Before = int | str
"""The family (index) of a use, or the beginning."""


@dataclass
class _Resource:
    """The facts of one resource: what it is ready for, and after which uses a set-up may begin."""

    setups: Setups
    token: str
    ready: dict[int, str] = field(default_factory=dict)
    after: dict[Before, str] = field(default_factory=dict)

    def between(self, before: Before, family: int) -> Setup:
        """The set-up between two uses, or from the beginning."""
        if isinstance(before, str):
            return self.setups.first(family)
        return self.setups.between(before, family)

    def made_by(self, before: Before) -> tuple[str, ...]:
        """The facts that hold when a use has ended, or at the beginning."""
        facts = [fact for f, fact in self.ready.items() if not self.between(before, f).time]
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


def add_setups(builder: Builder, units: ResourceUnits) -> SetupFacts:
    """Declares the facts of resources with set-ups, and adds the set-ups.

    Raises `Refusal` where there are more than `MOST_SETUPS`.
    """
    problem = builder.problem
    found = SetupFacts(problem)
    count = 0
    for r, pool in enumerate(problem.contention.pools):
        setups = problem.resources[pool.members[0]].setups
        if setups is None or r not in units.tokens:
            continue
        resource = _Resource(setups, units.tokens[r][0])
        families = _families(problem, r)
        for f in families:
            resource.ready[f] = builder.fact(builder.names.new(_text(problem, "ready", pool.id, f)))
        befores: tuple[Before, ...] = (BEGINNING, *families)
        for before in befores:
            if any(resource.between(before, f).time for f in families):
                name = builder.names.new(_text(problem, "used", pool.id, before))
                resource.after[before] = builder.fact(name)
        count += sum(bool(resource.between(b, f).time) for b in resource.after for f in families)
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
        for f, ready in resource.ready.items():
            time = resource.between(before, f).time
            if not time:
                continue
            text = f"setup_{used.removeprefix('used_')}_{ready.removeprefix('ready_')}"
            length = time * builder.scale.units_per_tick
            operator = Operator(
                builder.names.new(text),
                (length, length),
                at_start=[used, resource.token, *(begins if before == BEGINNING else ())],
                start_deletes=[*resource.facts, resource.token],
                end_adds=[ready, resource.token],
            )
            shown = f"from {_shown(builder, before)} to {_shown(builder, f)}"
            builder.add_helper(operator, f"the set-up of {pool!r} {shown}")


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
