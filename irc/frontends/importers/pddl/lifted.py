"""Converts unified-planning's model to plain schemas with numbered parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from irc.errors import IrcError

Fact = tuple[str, ...]
"""A predicate (or function) with its objects: ("at", "truck1", "depot")."""

Term = int | str
"""A parameter by its place, or an object by its name."""


class UnexpectedError(IrcError, ValueError):
    """The reader returned an unsupported element that the check of the text did not find."""


@dataclass(frozen=True, slots=True)
class Literal:
    """A predicate with terms, and whether it must be true."""

    predicate: str
    terms: tuple[Term, ...]
    value: bool

    def fact(self, objects: tuple[str, ...]) -> Fact:
        """The fact for given objects."""
        return (
            self.predicate,
            *(objects[term] if isinstance(term, int) else term for term in self.terms),
        )


@dataclass(frozen=True, slots=True)
class Equality:
    """Whether two terms must be the same object or different ones."""

    left: Term
    right: Term
    same: bool


@dataclass(frozen=True)
class Schema:
    """An action before its parameters are given. `when` is "start", "all" or "end"."""

    name: str
    parameters: tuple[tuple[str, ...], ...]
    """The possible objects of each parameter."""
    conditions: tuple[tuple[str, Literal], ...]
    equalities: tuple[Equality, ...]
    effects: tuple[tuple[str, Literal], ...]
    duration: tuple[Any, Any] | None
    """Its least and greatest length as expressions; None for an action that takes no time."""
    names: Mapping[str, int]


@dataclass(frozen=True)
class Lifted:
    """A domain and a problem."""

    domain: str
    problem: str
    schemas: tuple[Schema, ...]
    initial: frozenset[Fact]
    numbers: Mapping[Fact, Fraction]
    timed: tuple[tuple[Fraction, Fact, bool], ...]
    goal: tuple[tuple[Fact, bool], ...]


def lift(problem: Any, domain: str, name: str) -> Lifted:
    """The schemas of unified-planning's model. Raises `UnexpectedError`."""
    initial, numbers = set(), {}
    for expression, value in problem.explicit_initial_values.items():
        fact = (expression.fluent().name, *(arg.object().name for arg in expression.args))
        if value.is_bool_constant():
            if value.is_true():
                initial.add(fact)
        else:
            numbers[fact] = Fraction(value.constant_value())
    timed = [
        (Fraction(timing.delay), literal.fact(()), literal.value)
        for timing, effects in problem.timed_effects.items()
        for effect in effects
        for literal in [_effect(effect, {})]
    ]
    goal = []
    for condition in problem.goals:
        for part in _literals(condition, {}, True):
            if isinstance(part, Equality):
                if (part.left == part.right) != part.same:
                    raise UnexpectedError("the goal asks two objects to be one, or one to be two")
            else:
                goal.append((part.fact(()), part.value))
    return Lifted(
        domain,
        name,
        tuple(_schema(problem, action) for action in problem.actions),
        frozenset(initial),
        numbers,
        tuple(timed),
        tuple(goal),
    )


def _schema(problem: Any, action: Any) -> Schema:
    names = {parameter.name: place for place, parameter in enumerate(action.parameters)}
    durative = hasattr(action, "duration")
    found: list[tuple[str, Literal | Equality]] = []
    if durative:
        for interval, conditions in action.conditions.items():
            when = _when(interval)
            for condition in conditions:
                found += [(when, part) for part in _literals(condition, names, True)]
        effects = [
            (_moment(timing), _effect(effect, names))
            for timing, inner in action.effects.items()
            for effect in inner
        ]
    else:
        for condition in action.preconditions:
            found += [("start", part) for part in _literals(condition, names, True)]
        effects = [("start", _effect(effect, names)) for effect in action.effects]
    return Schema(
        action.name,
        tuple(
            tuple(item.name for item in problem.objects(parameter.type))
            for parameter in action.parameters
        ),
        tuple((when, part) for when, part in found if isinstance(part, Literal)),
        tuple(part for _, part in found if isinstance(part, Equality)),
        tuple(effects),
        (action.duration.lower, action.duration.upper) if durative else None,
        names,
    )


def _when(interval: Any) -> str:
    if interval.lower == interval.upper:
        return _moment(interval.lower)
    if interval.lower.is_from_start() and interval.upper.is_from_end():
        return "all"
    raise UnexpectedError(f"a condition over {interval} is not supported")


def _moment(timing: Any) -> str:
    if timing.delay != 0:
        raise UnexpectedError(f"an effect or condition at {timing} is not supported")
    return "start" if timing.is_from_start() else "end"


def _literals(
    expression: Any, names: Mapping[str, int], value: bool
) -> Iterator[Literal | Equality]:
    if expression.is_and() and value:
        for part in expression.args:
            yield from _literals(part, names, value)
    elif expression.is_not():
        yield from _literals(expression.arg(0), names, not value)
    elif expression.is_fluent_exp():
        terms = tuple(_term(arg, names) for arg in expression.args)
        yield Literal(expression.fluent().name, terms, value)
    elif expression.is_equals():
        left, right = (_term(arg, names) for arg in expression.args)
        yield Equality(left, right, value)
    elif not (expression.is_bool_constant() and expression.is_true() == value):
        raise UnexpectedError(f"the condition {expression} is not supported")


def _effect(effect: Any, names: Mapping[str, int]) -> Literal:
    plain = effect.is_assignment() and not effect.is_conditional() and not effect.forall
    if not plain or not effect.value.is_bool_constant():
        raise UnexpectedError(f"the effect {effect} is not supported")
    terms = tuple(_term(arg, names) for arg in effect.fluent.args)
    return Literal(effect.fluent.fluent().name, terms, effect.value.is_true())


def _term(expression: Any, names: Mapping[str, int]) -> Term:
    if expression.is_parameter_exp():
        return names[expression.parameter().name]
    if expression.is_object_exp():
        return str(expression.object().name)
    raise UnexpectedError(f"the term {expression} is not supported")


def evaluate(
    expression: Any,
    schema: Schema,
    objects: tuple[str, ...],
    numbers: Mapping[Fact, Fraction],
) -> Fraction | None:
    """An expression's exact value; None if a function has none for these objects."""
    if expression.is_fluent_exp():
        terms = (_term(arg, schema.names) for arg in expression.args)
        found = (objects[term] if isinstance(term, int) else term for term in terms)
        return numbers.get((expression.fluent().name, *found))
    if expression.is_int_constant() or expression.is_real_constant():
        return Fraction(expression.constant_value())
    values = [evaluate(arg, schema, objects, numbers) for arg in expression.args]
    known = [value for value in values if value is not None]
    if len(known) < len(values):
        return None
    if expression.is_plus():
        return sum(known, Fraction(0))
    if expression.is_times():
        product = Fraction(1)
        for value in known:
            product *= value
        return product
    if expression.is_minus():
        return known[0] - known[1]
    if expression.is_div():
        return None if known[1] == 0 else known[0] / known[1]
    raise UnexpectedError(f"the duration {expression} is not supported")
