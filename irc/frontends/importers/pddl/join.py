"""Finds the bindings of parameters under which an action may ever happen.

Conditions are joined with the facts that the delete relaxation reaches (semi-naive evaluation of a
Datalog program; Helmert, "Concise finite-domain representations for PDDL planning tasks", 2009,
section 6): a new fact is matched with each condition that it may satisfy, and the other conditions
are looked up. So only what can happen is ever looked at.

An action has two rules. Its start effects need its start conditions alone, so that two actions
may each need an effect of the other's start; its end effects need all of its conditions.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from irc.errors import IrcError
from irc.frontends.importers.pddl.lifted import (
    Change,
    Conditional,
    Equality,
    Fact,
    Lifted,
    Literal,
    Schema,
    conjuncts,
)

MOST_STEPS = 20_000_000
"""Joins with more steps are refused: they take minutes."""

MOST_BINDINGS = 200_000
"""More bindings of one domain are refused."""


class TooLargeError(IrcError, ValueError):
    """A task with more ground actions than can be handled."""


@dataclass
class _Rule:
    """`literals` → `adds`, for all bindings of `parameters` that satisfy them."""

    schema: Schema
    literals: list[Literal]
    equalities: list[Equality]
    adds: list[tuple[Literal, tuple[tuple[str, tuple[str, ...]], ...]]]
    parameters: list[str]
    whole: bool
    """Whether a binding is one of the action, not of its start alone."""
    allowed: dict[str, frozenset[str]]
    fired: dict[tuple[str, ...], None] = field(default_factory=dict)

    def has_fired(self, binding: dict[str, str]) -> bool:
        """Whether all that matters of a binding is known, and was found before."""
        if len(binding) < len(self.parameters):
            return False
        key = tuple(map(binding.get, self.parameters))
        return key in self.fired


class Relations:
    """Facts by predicate, and by predicate, place and object."""

    def __init__(self) -> None:
        self.all: dict[str, list[Fact]] = {}
        self.by_object: dict[tuple[str, int, str], list[Fact]] = {}

    def add(self, fact: Fact) -> None:
        """Adds a fact that is not there yet."""
        self.all.setdefault(fact[0], []).append(fact)
        for place, item in enumerate(fact[1:]):
            self.by_object.setdefault((fact[0], place, item), []).append(fact)

    def candidates(self, literal: Literal, binding: dict[str, str]) -> Sequence[Fact]:
        """The facts that may match a literal: those of its rarest known object."""
        best: Sequence[Fact] = self.all.get(literal.predicate, ())
        for place, term in enumerate(literal.terms):
            item = term if term[0] != "?" else binding.get(term)
            if item is not None:
                found = self.by_object.get((literal.predicate, place, item), ())
                if len(found) < len(best):
                    best = found
        return best


class Join:
    """All bindings of all schemas; `reached` are the facts that may ever be true."""

    def __init__(self, lifted: Lifted) -> None:
        self.lifted = lifted
        self.relations = Relations()
        self.reached: set[Fact] = set()
        self.waiting: deque[Fact] = deque()
        self.steps = 0
        self.rules = [rule for schema in lifted.schemas for rule in _rules(schema)]
        self.triggers: dict[str, list[tuple[_Rule, int]]] = {}
        for rule in self.rules:
            for k, literal in enumerate(rule.literals):
                self.triggers.setdefault(literal.predicate, []).append((rule, k))

    def run(self) -> dict[str, list[tuple[str, ...]]]:
        """The bindings of each schema, in the order of its parameters' objects."""
        self._begin()
        while self.waiting:
            fact = self.waiting.popleft()
            self.relations.add(fact)
            for rule, k in self.triggers.get(fact[0], ()):
                binding = _matched(rule, rule.literals[k], fact, {})
                if binding is not None:
                    rest = [item for j, item in enumerate(rule.literals) if j != k]
                    self._join(rule, rest, binding)
        return {rule.schema.name: _in_order(rule) for rule in self.rules if rule.whole}

    def _begin(self) -> None:
        """Static facts are there from the beginning and trigger nothing, where others do."""
        changing = self.lifted.changing
        for fact in sorted(self.lifted.initial):
            if fact[0] in changing:
                self._reach(fact)
            else:
                self.reached.add(fact)
                self.relations.add(fact)
        for _, fact, value in self.lifted.timed:
            if value:
                self._reach(fact)
        for rule in self.rules:
            for k, literal in enumerate(rule.literals):
                if literal.predicate not in changing:
                    self.triggers[literal.predicate].remove((rule, k))
            if all(literal.predicate not in changing for literal in rule.literals):
                self._join(rule, rule.literals, {})

    def _reach(self, fact: Fact) -> None:
        if fact not in self.reached:
            self.reached.add(fact)
            self.waiting.append(fact)

    def _join(self, rule: _Rule, literals: Sequence[Literal], binding: dict[str, str]) -> None:
        self.steps += 1
        if self.steps > MOST_STEPS:
            raise TooLargeError(
                f"grounding takes more than {MOST_STEPS:,} steps; {rule.schema.name!r} has too"
                " many combinations of objects"
            )
        if not all(_may_hold(equality, binding) for equality in rule.equalities):
            return
        if rule.has_fired(binding):
            return
        if not literals:
            for whole in self._completed(rule, binding):
                self._fire(rule, whole)
            return
        sizes = [
            (len(self.relations.candidates(item, binding)), k) for k, item in enumerate(literals)
        ]
        _, best = min(sizes)
        rest = [item for k, item in enumerate(literals) if k != best]
        for fact in list(self.relations.candidates(literals[best], binding)):
            longer = _matched(rule, literals[best], fact, binding)
            if longer is not None:
                self._join(rule, rest, longer)

    def _completed(self, rule: _Rule, binding: dict[str, str]) -> Iterator[dict[str, str]]:
        """The bindings with an object for each parameter that no literal has bound."""
        free = [name for name in rule.parameters if name not in binding]
        if not free:
            yield binding
            return
        objects = dict(rule.schema.parameters)[free[0]]
        for item in objects:
            self.steps += 1
            longer = {**binding, free[0]: item}
            if all(_may_hold(equality, longer) for equality in rule.equalities):
                yield from self._completed(rule, longer)
        if self.steps > MOST_STEPS:
            raise TooLargeError(f"grounding takes more than {MOST_STEPS:,} steps")

    def _fire(self, rule: _Rule, binding: dict[str, str]) -> None:
        key = tuple(binding[name] for name in rule.parameters)
        if key in rule.fired:
            return
        rule.fired[key] = None
        if len(rule.fired) > MOST_BINDINGS:
            raise TooLargeError(
                f"the action {rule.schema.name!r} has more than {MOST_BINDINGS:,} ground actions"
            )
        for literal, variables in rule.adds:
            for bound in _each(variables, binding):
                self._reach(literal.fact(bound))


def _in_order(rule: _Rule) -> list[tuple[str, ...]]:
    """The bindings of a rule in the order in which the objects are declared."""
    places = [{o: n for n, o in enumerate(objects)} for _, objects in rule.schema.parameters]

    def key(bound: tuple[str, ...]) -> list[int]:
        return [at[item] for at, item in zip(places, bound, strict=True)]

    return sorted(rule.fired, key=key)


def _each(
    variables: Sequence[tuple[str, tuple[str, ...]]], binding: dict[str, str]
) -> Iterator[dict[str, str]]:
    """The binding with each choice of objects for the variables of a quantifier."""
    if not variables:
        yield binding
        return
    (name, objects), *rest = variables
    for item in objects:
        yield from _each(rest, {**binding, name: item})


def _rules(schema: Schema) -> Iterator[_Rule]:
    parts = [(when, part) for when, whole in schema.conditions for part in conjuncts(whole)]
    equalities = [part for _, part in parts if isinstance(part, Equality)]
    needed = [(w, p) for w, p in parts if isinstance(p, Literal) and p.value]
    allowed = {name: frozenset(objects) for name, objects in schema.parameters}
    names = [name for name, _ in schema.parameters]
    at_start, at_end = _adds(schema.effects, "start"), _adds(schema.effects, "end")
    early = [literal for when, literal in needed if when == "start"]
    if at_start and len(early) < len(needed):
        used = {term for literal, _ in at_start for term in literal.terms}
        kept = [name for name in names if name in used]
        yield _Rule(schema, early, equalities, at_start, kept, False, allowed)
    both = [literal for _, literal in needed]
    yield _Rule(schema, both, equalities, [*at_start, *at_end], names, True, allowed)


def _adds(
    effects: Iterable[object], at: str, variables: tuple[tuple[str, tuple[str, ...]], ...] = ()
) -> list[tuple[Literal, tuple[tuple[str, tuple[str, ...]], ...]]]:
    """The literals that effects add at a time, whatever their own conditions are."""
    found = []
    for effect in effects:
        if isinstance(effect, Conditional):
            found += _adds(effect.effects, at, (*variables, *effect.variables))
        elif isinstance(effect, Change) and effect.at == at and effect.literal.value:
            found.append((effect.literal, variables))
    return found


def _matched(
    rule: _Rule, literal: Literal, fact: Fact, binding: dict[str, str]
) -> dict[str, str] | None:
    """The binding extended so that the literal is the fact; None where it cannot be."""
    longer = binding
    for term, item in zip(literal.terms, fact[1:], strict=True):
        if term[0] != "?":
            if term != item:
                return None
            continue
        known = longer.get(term)
        if known is None:
            if item not in rule.allowed[term]:
                return None
            if longer is binding:
                longer = dict(binding)
            longer[term] = item
        elif known != item:
            return None
    return longer


def _may_hold(equality: Equality, binding: dict[str, str]) -> bool:
    left, right = (
        binding.get(term) if term[0] == "?" else term for term in (equality.left, equality.right)
    )
    return left is None or right is None or (left == right) == equality.same
