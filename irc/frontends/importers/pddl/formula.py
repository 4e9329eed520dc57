"""Ground conditions: what is left of a condition once its constant parts are decided.

A formula is True, False, an `Atom`, or a conjunction or disjunction of formulas. `Decider` decides
what no action changes, and what the delete relaxation never reaches.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from irc.errors import IrcError
from irc.frontends.importers.pddl.lifted import (
    Arithmetic,
    Comparison,
    Condition,
    Equality,
    Every,
    Expression,
    Fact,
    Lifted,
    Literal,
    Number,
    NumericChange,
    Special,
    Value,
    Variables,
)

MOST_WAYS = 256
"""A condition of one action with more alternatives is refused."""


class NotSupportedError(IrcError, ValueError):
    """An element that is read but cannot be expressed; `offset` is its place in the domain."""

    def __init__(self, message: str, offset: int) -> None:
        super().__init__(message)
        self.offset = offset


class Atom(NamedTuple):
    """A fact that must be true or false."""

    fact: Fact
    value: bool

    def negated(self) -> Atom:
        """The opposite."""
        return Atom(self.fact, not self.value)


class Limit(NamedTuple):
    """The least value that a condition asks of a number, or one that it must exceed."""

    least: Fraction
    strict: bool
    offset: int

    def holds(self, value: Fraction) -> bool:
        """Whether a value suits."""
        return value > self.least if self.strict else value >= self.least


Test = Atom


@dataclass(frozen=True, slots=True)
class All:
    """A conjunction of formulas that are not constant."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Any:
    """A disjunction of formulas that are not constant."""

    parts: tuple[Formula, ...]


Formula = bool | Test | All | Any

Way = tuple[Test, ...]
"""Tests that hold together."""


def conjunction(parts: Iterator[Formula]) -> Formula:
    """A conjunction, simplified."""
    found: dict[Formula, None] = {}
    for part in parts:
        if part is False:
            return False
        for inner in part.parts if isinstance(part, All) else (part,):
            if inner is not True:
                found[inner] = None
    if any(isinstance(p, Atom) and p.negated() in found for p in found):
        return False
    return next(iter(found)) if len(found) == 1 else All(tuple(found)) if found else True


def disjunction(parts: Iterator[Formula]) -> Formula:
    """A disjunction, simplified."""
    found: dict[Formula, None] = {}
    for part in parts:
        if part is True:
            return True
        for inner in part.parts if isinstance(part, Any) else (part,):
            if inner is not False:
                found[inner] = None
    if any(isinstance(p, Atom) and p.negated() in found for p in found):
        return True
    return next(iter(found)) if len(found) == 1 else Any(tuple(found)) if found else False


def negation(formula: Formula) -> Formula:
    """The opposite of a formula."""
    if isinstance(formula, bool):
        return not formula
    if isinstance(formula, Atom):
        return formula.negated()
    parts = (negation(part) for part in formula.parts)
    return disjunction(parts) if isinstance(formula, All) else conjunction(parts)


def tests_of(formula: Formula) -> Iterator[Test]:
    """All tests in a formula."""
    if isinstance(formula, Atom):
        yield formula
    elif not isinstance(formula, bool):
        for part in formula.parts:
            yield from tests_of(part)


def ways(formula: Formula, offset: int = 0) -> list[Way]:
    """The disjunctive normal form: alternatives of tests that hold together.

    Raises `NotSupportedError` where there are more than `MOST_WAYS`.
    """
    if isinstance(formula, bool):
        return [()] if formula else []
    if isinstance(formula, Atom):
        return [(formula,)]
    if isinstance(formula, All) and all(isinstance(part, Atom) for part in formula.parts):
        return [tuple(part for part in formula.parts if isinstance(part, Atom))]
    if isinstance(formula, Any):
        found = [way for part in formula.parts for way in ways(part, offset)]
    else:
        found = [()]
        for part in formula.parts:
            more = ways(part, offset)
            if len(found) * len(more) > 8 * MOST_WAYS:
                raise _too_many(offset)
            found = [
                joined for one in found for two in more if (joined := join(one, two)) is not None
            ]
    found = list(dict.fromkeys(found))
    if len(found) > MOST_WAYS:
        raise _too_many(offset)
    return found


def join(one: Way, two: Way) -> Way | None:
    """Both together; None where they contradict each other."""
    known = set(one)
    added = [test for test in two if test not in known]
    if any(test.negated() in known for test in added):
        return None
    return (*one, *added)


def _too_many(offset: int) -> NotSupportedError:
    return NotSupportedError(f"this has more than {MOST_WAYS} alternatives", offset)


RELATIONS: Mapping[str, Callable[[Fraction, Fraction], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    "=": operator.eq,
    "!=": operator.ne,
    ">=": operator.ge,
    ">": operator.gt,
}
"""Comparisons by their signs."""

ValuesOf = Callable[[Fact, int], Sequence[Fraction]]
"""The values that a number may ever have; the second argument is the place of what depends on it.

Raises `NotSupportedError` where they are too many.
"""


def no_values(fact: Fact, offset: int) -> Sequence[Fraction]:
    """Refuses what depends on the value of a number that changes."""
    raise NotSupportedError(
        f"this depends on ({' '.join(fact)}), which actions change; a constant is wanted here",
        offset,
    )


class Decider:
    """Evaluates conditions and expressions. `reached` are the facts that may ever be true."""

    def __init__(self, lifted: Lifted, reached: set[Fact]) -> None:
        self.lifted = lifted
        self.reached = reached
        self.values_of: ValuesOf = no_values
        self.limits: dict[Fact, dict[Fact, Limit]] = {}
        self.sums: dict[Fact, Mapping[Fact, Fraction]] = {}
        """Numbers that are sums of others, with the factor of each."""
        self.assigned = {
            change.target.function
            for schema in lifted.schemas
            for change in schema.changes()
            if isinstance(change, NumericChange) and change.verb == "assign"
        }

    def formula(self, condition: Condition, binding: Mapping[str, str]) -> Formula:
        """The part of a condition that is not constant. Raises `NotSupportedError`."""
        if isinstance(condition, Literal):
            return self._literal(condition, binding)
        if isinstance(condition, Equality):
            left, right = (binding.get(t, t) for t in (condition.left, condition.right))
            return (left == right) == condition.same
        if isinstance(condition, Comparison):
            return self._comparison(condition, binding)
        parts = (
            self.formula(part, bound)
            for bound in bindings(condition.variables, binding)
            for part in condition.parts
        )
        return conjunction(parts) if isinstance(condition, Every) else disjunction(parts)

    def _literal(self, literal: Literal, binding: Mapping[str, str]) -> Formula:
        fact = literal.fact(binding)
        if literal.predicate not in self.lifted.changing:
            return (fact in self.lifted.initial) == literal.value
        if fact not in self.reached:
            return not literal.value
        return Atom(fact, literal.value)

    # --- numbers ---------------------------------------------------------------------------------

    def linear(self, expression: Expression, binding: Mapping[str, str]) -> Linear | None:
        """An expression as a sum of functions that change and a constant."""
        if isinstance(expression, Number):
            return Linear({}, expression.value)
        if isinstance(expression, Special):
            return Linear({(expression.name,): Fraction(1)}, Fraction(0))
        if isinstance(expression, Value):
            fact = expression.fact(binding)
            if expression.function in self.lifted.changing:
                return Linear({fact: Fraction(1)}, Fraction(0))
            value = self.lifted.numbers.get(fact)
            return None if value is None else Linear({}, value)
        parts = [self.linear(part, binding) for part in expression.parts]
        known = [part for part in parts if part is not None]
        return _applied(expression, known) if len(known) == len(parts) else None

    def difference(self, comparison: Comparison, binding: Mapping[str, str]) -> Linear | None:
        """The left side minus the right one; None where a function has no value."""
        left = self.linear(comparison.left, binding)
        right = self.linear(comparison.right, binding)
        if left is None or right is None:
            return None
        return left.plus(right.times(Fraction(-1)))

    def _comparison(self, comparison: Comparison, binding: Mapping[str, str]) -> Formula:
        difference = self.difference(comparison, binding)
        if difference is None:
            return False  # A function without a value makes it false, as in PDDL2.1.
        if ("?duration",) in difference.factors or ("total-time",) in difference.factors:
            raise NotSupportedError(
                "a condition on ?duration or total-time is not supported", comparison.offset
            )
        return self._compared(comparison.relation, difference, comparison.offset)

    def _compared(self, relation: str, difference: Linear, offset: int) -> Formula:
        """Whether a sum compares so with 0.

        A sum of numbers that are only added to is a number of its own; of any other one all numbers
        but one are replaced by their values.
        """
        factors = difference.factors
        if not factors:
            return RELATIONS[relation](difference.constant, Fraction(0))
        fact = min(factors)
        if len(factors) > 1 and any(one[0] in self.assigned for one in factors):
            return disjunction(
                conjunction(
                    iter((self.equals(fact, value, offset), self._compared(relation, rest, offset)))
                )
                for value in self.values_of(fact, offset)
                for rest in (difference.given({fact: value}),)
            )
        fact, factor = self._sum(factors)
        if factor < 0:
            relation = {"<": ">", ">": "<", "<=": ">=", ">=": "<="}.get(relation, relation)
        limit = -difference.constant / factor
        at_least = self._limit(fact, limit, offset, strict=False)
        more = self._limit(fact, limit, offset, strict=True)
        return _COMPARED[relation](at_least, more)

    def equals(self, fact: Fact, value: Fraction, offset: int) -> Formula:
        """That a number has a value."""
        return self._compared("=", Linear({fact: Fraction(1)}, -value), offset)

    def _sum(self, factors: Mapping[Fact, Fraction]) -> tuple[Fact, Fraction]:
        """The number that a sum is a multiple of, and the factor: itself if it is only one."""
        first, factor = next(iter(sorted(factors.items())))
        if len(factors) == 1:
            return first, factor
        parts = {fact: amount / factor for fact, amount in sorted(factors.items())}
        terms = (
            f"({' '.join(fact)})" if amount == 1 else f"(* {amount} ({' '.join(fact)}))"
            for fact, amount in parts.items()
        )
        name = ("+", *terms)
        self.sums[name] = parts
        return name, factor

    def _limit(self, fact: Fact, least: Fraction, offset: int, *, strict: bool) -> Atom:
        """The fact that says whether a number is at least something, or more than that."""
        text = str(least.numerator if least.denominator == 1 else float(least))
        name = (">" if strict else ">=", f"({' '.join(fact)})", text)
        self.limits.setdefault(fact, {}).setdefault(name, Limit(least, strict, offset))
        return Atom(name, True)


_COMPARED: Mapping[str, Callable[[Atom, Atom], Formula]] = {
    ">=": lambda least, more: least,
    ">": lambda least, more: more,
    "<": lambda least, more: least.negated(),
    "<=": lambda least, more: more.negated(),
    "=": lambda least, more: All((least, more.negated())),
    "!=": lambda least, more: Any((least.negated(), more)),
}
"""A comparison in terms of the facts "at least" and "more"."""


@dataclass(frozen=True, slots=True)
class Linear:
    """A sum of functions with factors, and a constant."""

    factors: Mapping[Fact, Fraction]
    constant: Fraction

    def __hash__(self) -> int:
        return hash((frozenset(self.factors.items()), self.constant))

    def value(self, known: Mapping[Fact, Fraction]) -> Fraction:
        """The value where those of all its functions are known."""
        return sum((known[f] * x for f, x in self.factors.items()), self.constant)

    def given(self, known: Mapping[Fact, Fraction]) -> Linear:
        """The formula that is left once the values of some functions are known."""
        rest = {f: x for f, x in self.factors.items() if f not in known}
        own = {f: x for f, x in self.factors.items() if f in known}
        return Linear(rest, Linear(own, self.constant).value(known))

    def plus(self, other: Linear) -> Linear:
        """The sum."""
        factors = dict(self.factors)
        for fact, factor in other.factors.items():
            factors[fact] = factors.get(fact, Fraction(0)) + factor
        return Linear({f: x for f, x in factors.items() if x}, self.constant + other.constant)

    def times(self, number: Fraction) -> Linear:
        """The product with a number."""
        factors = {f: x * number for f, x in self.factors.items() if number}
        return Linear(factors, self.constant * number)


def _applied(expression: Arithmetic, parts: list[Linear]) -> Linear | None:
    total = parts[0]
    if len(parts) == 1:
        return total.times(Fraction(-1))
    for part in parts[1:]:
        if expression.operator == "+":
            total = total.plus(part)
        elif expression.operator == "-":
            total = total.plus(part.times(Fraction(-1)))
        elif expression.operator == "/":
            if not part.factors and not part.constant:
                return None
            total = _product(total, part, expression, divide=True)
        else:
            total = _product(total, part, expression)
    return total


def _product(one: Linear, two: Linear, expression: Arithmetic, *, divide: bool = False) -> Linear:
    if not two.factors:
        return one.times(1 / two.constant if divide else two.constant)
    if not one.factors and not divide:
        return two.times(one.constant)
    raise NotSupportedError(
        "a product of numbers that change is not supported", _offset(expression)
    )


def bindings(variables: Variables, binding: Mapping[str, str]) -> Iterator[Mapping[str, str]]:
    """The binding with each choice of objects for the variables of a quantifier."""
    if not variables:
        yield binding
        return
    (name, objects), *rest = variables
    for item in objects:
        yield from bindings(tuple(rest), {**binding, name: item})


def _offset(expression: Expression) -> int:
    if isinstance(expression, (Value, Special)):
        return expression.offset
    if isinstance(expression, Arithmetic):
        return next((found for part in expression.parts if (found := _offset(part))), 0)
    return 0
