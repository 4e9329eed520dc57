"""Couplings in PDDL: facts that say which choices are still possible, which no action gives back.

All couplings of actions are about each two of their members, so that it is enough that no two ways
that do not go together both happen. Each member needs a fact that the ways against it take away.
Ways that go together take nothing from each other: they may start at one time.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass, field

from irc.problem import Activity, CoupledChoice, Coupling, Problem
from irc_pddl21.encoding.builder import Builder
from irc_pddl21.encoding.pddl import NOTHING, Additions
from irc_pddl21.encoding.resources import ResourceUnits
from irc_pddl21.encoding.variants import Variant, variants_of

Held = Mapping[int, int]
"""The resource (index) that each use takes."""


@dataclass
class CouplingFacts:
    """The additions of couplings to the variants of their `members` (activities, by index)."""

    problem: Problem
    members: set[int] = field(default_factory=set)
    rules: list[_Rule] = field(default_factory=list)

    def of(self, i: int, variant: Variant) -> list[Additions] | None:
        """The additions of couplings to a variant; None where it contradicts one by itself."""
        found = [rule.additions(i, variant) for rule in self.rules if i in self.members]
        return None if None in found else [each for each in found if each is not None]


def add_couplings(builder: Builder, units: ResourceUnits) -> CouplingFacts:
    """Declares the facts of all couplings."""
    problem = builder.problem
    found = CouplingFacts(problem)
    for coupling in problem.couplings:
        number = len(found.rules) + 1
        made: _Rule
        if coupling.kind == "if":
            made = _Implication(builder, coupling, number)
        elif coupling.kind == "same":
            made = _Same(builder, coupling, number, units)
        else:
            made = _Different(builder, coupling, number, units)
        found.rules.append(made)
        found.members |= {member.activity for member in coupling.members}
    return found


class _Rule(ABC):
    """A coupling; subclasses say what the variants of its members need and take away."""

    def __init__(self, builder: Builder, coupling: Coupling, number: int) -> None:
        self.builder, self.problem = builder, builder.problem
        self.coupling, self.number = coupling, number

    @abstractmethod
    def additions(self, i: int, variant: Variant) -> Additions | None:
        """The additions to a variant of activity i; None where that alone breaks the coupling."""

    def new_fact(self, text: str) -> str:
        """A fact that holds until a way takes it away."""
        name = self.builder.names.new(text)
        self.builder.grounded.tokens[name] = f"coupling {self.coupling.origin + 1} still allows it"
        return self.builder.fact(name, initially=True)

    def members_of(self, i: int) -> Iterable[CoupledChoice]:
        """The members that are choices of activity i."""
        return (member for member in self.coupling.members if member.activity == i)

    def chosen(self, member: CoupledChoice, variant: Variant) -> frozenset[Hashable]:
        """The choice of a variant of a member: a mode (its name), or the resources it holds."""
        activity = self.problem.activities[member.activity]
        if self.coupling.what == "mode":
            return frozenset([mode_name(activity, variant)])
        return frozenset(resources_held(self.problem, member, variant))

    def variants(self, i: int, units: ResourceUnits) -> Iterable[Variant]:
        """The variants of activity i."""
        return variants_of(self.problem, i, units)


class _Same(_Rule):
    """All members choose the same: who chooses takes all other choices away."""

    def __init__(
        self, builder: Builder, coupling: Coupling, number: int, units: ResourceUnits
    ) -> None:
        super().__init__(builder, coupling, number)
        self.facts: dict[frozenset[Hashable], str] = {}
        for i in dict.fromkeys(member.activity for member in coupling.members):
            for variant in self.variants(i, units):
                key = self._key(i, variant)
                if key is not None and key not in self.facts:
                    text = f"same_{number}_{len(self.facts) + 1}"
                    self.facts[key] = self.new_fact(text)

    def _key(self, i: int, variant: Variant) -> frozenset[Hashable] | None:
        keys = {self.chosen(member, variant) for member in self.members_of(i)}
        return keys.pop() if len(keys) == 1 else None

    def additions(self, i: int, variant: Variant) -> Additions | None:
        if not any(self.members_of(i)):
            return NOTHING
        key = self._key(i, variant)
        if key is None:
            return None
        others = tuple(fact for other, fact in self.facts.items() if other != key)
        return Additions(at_start=(self.facts[key],), start_deletes=others)


class _Different(_Rule):
    """No two members choose the same: who chooses something takes it away from the others."""

    def __init__(
        self, builder: Builder, coupling: Coupling, number: int, units: ResourceUnits
    ) -> None:
        super().__init__(builder, coupling, number)
        self.facts: dict[Hashable, str] = {}
        seen: set[Hashable] = set()
        for i in dict.fromkeys(member.activity for member in coupling.members):
            own: set[Hashable] = set()
            for variant in self.variants(i, units):
                own |= {each for m in self.members_of(i) for each in self.chosen(m, variant)}
            for each in sorted(own & seen - self.facts.keys(), key=repr):
                self.facts[each] = self.new_fact(f"different_{number}_{len(self.facts) + 1}")
            seen |= own

    def additions(self, i: int, variant: Variant) -> Additions | None:
        taken = [each for m in self.members_of(i) for each in self.chosen(m, variant)]
        if len(set(taken)) < len(taken):
            return None
        facts = tuple(sorted(self.facts[each] for each in taken if each in self.facts))
        return Additions(at_start=facts, start_deletes=facts)


class _Implication(_Rule):
    """The ways that bring the "if" about and those that fail the "then" exclude each other."""

    def __init__(self, builder: Builder, coupling: Coupling, number: int) -> None:
        super().__init__(builder, coupling, number)
        self.may_hold = self.new_fact(f"if_{number}")
        self.may_fail = self.new_fact(f"unless_{number}")

    def additions(self, i: int, variant: Variant) -> Additions | None:
        one, other = self.coupling.members
        holds = one.activity == i and self._made(one, variant)
        fails = other.activity == i and not self._made(other, variant)
        if holds and fails:
            return None
        if not (holds or fails):
            return NOTHING
        own, other_way = (self.may_hold, self.may_fail)[:: 1 if holds else -1]
        return Additions(at_start=(own,), start_deletes=(other_way,))

    def _made(self, member: CoupledChoice, variant: Variant) -> bool:
        """Whether a variant is carried out as the member says."""
        if member.modes:
            return mode_name(self.problem.activities[member.activity], variant) in member.modes
        return member.resource in resources_held(self.problem, member, variant)


def mode_name(activity: Activity, variant: Variant) -> str | None:
    """The mode of a variant by its name; None where the activity has none."""
    return None if variant.mode is None else activity.details.modes[variant.mode].id


def resources_held(problem: Problem, member: CoupledChoice, variant: Variant) -> set[int]:
    """The resources (by index) that a variant takes, by the use that is meant or by any."""
    activity = problem.activities[member.activity]
    held = held_by(problem, member.activity, variant)
    if member.use is None:
        return set(held.values())
    for u, use in enumerate(activity.uses):
        if activity.details.use_mode(u) is None and use.origin == member.use:
            return {held[u]} if u in held else set()
    return set()


def held_by(problem: Problem, i: int, variant: Variant) -> Held:
    """The resource (index) of each use of activity i, as far as variant and problem name it."""
    activity, contention = problem.activities[i], problem.contention
    open_pools = dict(
        zip((demand.use for demand in variant.demands), variant.resources, strict=True)
    )
    held: dict[int, int] = {}
    for u in activity.uses_in(variant.mode):
        alternatives = activity.uses[u].alternatives
        if len(alternatives) == 1:
            held[u] = alternatives[0]
        elif u in open_pools:
            held[u] = contention.pools[open_pools[u]].members[0]
        elif (i, u) in contention.fixed_choices:
            held[u] = contention.fixed_choices[i, u]
    return held
