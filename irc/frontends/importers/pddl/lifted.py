"""A PDDL domain and problem before objects take the place of parameters.

Conditions are in negation normal form: negation stands at literals, equalities and comparisons
only. Times are "start", "all" or "end" as in the IR; an instantaneous action has only "start".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

Fact = tuple[str, ...]
"""A predicate (or function) with its objects: ("at", "truck1", "depot")."""

Binding = Mapping[str, str]
"""The object of each parameter."""

Variables = tuple[tuple[str, tuple[str, ...]], ...]
"""Parameters with the objects that each may stand for."""


@dataclass(frozen=True, slots=True)
class Literal:
    """A predicate with terms (parameters begin with "?"), and whether it must be true."""

    predicate: str
    terms: tuple[str, ...]
    value: bool
    offset: int = 0

    def fact(self, binding: Binding) -> Fact:
        """The fact for given objects."""
        return (self.predicate, *(binding.get(term, term) for term in self.terms))


@dataclass(frozen=True, slots=True)
class Equality:
    """Whether two terms must be the same object or different ones."""

    left: str
    right: str
    same: bool


@dataclass(frozen=True, slots=True)
class Number:
    """A constant."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class Value:
    """The value of a function."""

    function: str
    terms: tuple[str, ...]
    offset: int = 0

    def fact(self, binding: Binding) -> Fact:
        """The function with its objects."""
        return (self.function, *(binding.get(term, term) for term in self.terms))


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """`operator` (+, -, *, /) applied to expressions; "-" with one of them negates it."""

    operator: str
    parts: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Special:
    """`?duration` or `total-time`."""

    name: str
    offset: int = 0


Expression = Number | Value | Arithmetic | Special


@dataclass(frozen=True, slots=True)
class Comparison:
    """`left relation right`; the relations are <, <=, =, >=, > and != (a negated =)."""

    relation: str
    left: Expression
    right: Expression
    offset: int = 0


@dataclass(frozen=True, slots=True)
class Every:
    """All of its parts; a quantifier's parts are those of each choice of `variables`."""

    parts: tuple[Condition, ...]
    variables: Variables = ()


@dataclass(frozen=True, slots=True)
class Some:
    """At least one of its parts; a quantifier's parts are those of each choice of `variables`."""

    parts: tuple[Condition, ...]
    variables: Variables = ()


Condition = Literal | Equality | Comparison | Every | Some

Timed = tuple[str, Condition]
"""A condition with its time."""


@dataclass(frozen=True, slots=True)
class Change:
    """A fact that becomes true or false."""

    at: str
    literal: Literal


@dataclass(frozen=True, slots=True)
class NumericChange:
    """`verb` is "increase", "decrease" or "assign"."""

    at: str
    verb: str
    target: Value
    amount: Expression
    offset: int = 0


@dataclass(frozen=True, slots=True)
class Conditional:
    """Effects for each choice of `variables` for which the conditions hold."""

    conditions: tuple[Timed, ...]
    effects: tuple[Effect, ...]
    variables: Variables = ()
    offset: int = 0


Effect = Change | NumericChange | Conditional


@dataclass(frozen=True, slots=True)
class Bound:
    """A bound of a duration: `?duration relation amount`, with =, <= or >=."""

    relation: str
    amount: Expression


@dataclass(frozen=True)
class Schema:
    """An action before its parameters are given. `duration` is None if it takes no time."""

    name: str
    parameters: Variables
    conditions: tuple[Timed, ...]
    effects: tuple[Effect, ...]
    duration: tuple[Bound, ...] | None
    offset: int = 0

    def changes(self) -> Iterator[Change | NumericChange]:
        """All changes in its effects, the conditional ones included."""
        waiting = list(reversed(self.effects))
        while waiting:
            effect = waiting.pop()
            if isinstance(effect, Conditional):
                waiting.extend(reversed(effect.effects))
            else:
                yield effect


@dataclass(frozen=True, slots=True)
class Metric:
    """The value by which a plan is judged."""

    maximize: bool
    expression: Expression
    offset: int = 0


@dataclass(frozen=True)
class Lifted:
    """A domain and a problem. `timed` are the timed initial literals."""

    domain: str
    problem: str
    schemas: tuple[Schema, ...]
    initial: frozenset[Fact]
    numbers: Mapping[Fact, Fraction]
    timed: tuple[tuple[Fraction, Fact, bool], ...]
    goal: Condition
    metric: Metric | None = None
    changing: frozenset[str] = field(default=frozenset())
    """The predicates and functions that some action or timed literal changes."""


def conjuncts(condition: Condition) -> Iterator[Condition]:
    """The parts of a conjunction that has no variables of its own, or the condition itself."""
    waiting = [condition]
    while waiting:
        part = waiting.pop()
        if isinstance(part, Every) and not part.variables:
            waiting.extend(reversed(part.parts))
        else:
            yield part
