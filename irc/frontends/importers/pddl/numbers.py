"""Numbers that conditions read: number variables, or counted, one fact for each value.

A function that actions change by constants is a number variable of the IR. A sum of several such
functions that a condition compares with something is a number variable of its own, which each of
their changes changes, too. Only two kinds are counted, with at most `MOST_VALUES` values each: a
function without a value at first, and one that a derived fact depends on. Facts then say which
value it has, `(= (fuel plane) 40)`, and what conditions ask, `(>= (fuel plane) 5)`. An action that
adds to it becomes a variant for each value; one that only asks has one condition on one fact.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from math import ceil, floor, lcm

from irc.frontends.importers.pddl.formula import Atom, Limit, NotSupportedError
from irc.frontends.importers.pddl.ground_action import Ground, NumericEffect, TimedEffect
from irc.frontends.importers.pddl.lifted import Fact, Lifted
from irc.model.times import json_number

MOST_VALUES = 200
"""A function with more values is refused."""

Limits = Mapping[Fact, Mapping[Fact, Limit]]
"""The limits that conditions ask of each function, by the fact that stands for each."""


@dataclass(frozen=True)
class NumberVariable:
    """A function as a number variable: all of its values are multiples of 1 / `parts`.

    `limits` are those that conditions ask, by the fact that stands for each.
    """

    fact: Fact
    initial: Fraction
    parts: int
    limits: Mapping[Fact, Limit]

    def levels(self, test: Atom) -> tuple[Fraction | None, Fraction | None]:
        """The least and the greatest value that a test allows; None: no limit."""
        limit = self.limits[test.fact]
        scaled = limit.least * self.parts
        if test.value:
            first = floor(scaled) + 1 if limit.strict else ceil(scaled)
            return Fraction(first, self.parts), None
        last = floor(scaled) if limit.strict else ceil(scaled) - 1
        return None, Fraction(last, self.parts)


def with_sums(
    actions: Iterable[Ground], sums: Mapping[Fact, Mapping[Fact, Fraction]]
) -> Iterator[Ground]:
    """The actions, which change the sums of the numbers that they change, too.

    (No action assigns a number that is in a sum.)
    """
    if not sums:
        yield from actions
        return
    for action in actions:
        effects = list(action.effects)
        for name, factors in sums.items():
            added: dict[str, Fraction] = {}
            for at, fact, _, amount in _changes(action):
                if fact in factors:
                    added[at] = added.get(at, Fraction(0)) + factors[fact] * amount
            effects += [
                TimedEffect(at, NumericEffect(name, True, amount)) for at, amount in added.items()
            ]
        yield replace(action, effects=tuple(effects))


class Numbers:
    """The functions that conditions read: `variables` as such, and `values` of the others.

    `derived` are the facts that derived facts depend on.
    """

    def __init__(
        self,
        lifted: Lifted,
        asked: Limits,
        actions: Sequence[Ground],
        derived: Container[Fact],
    ) -> None:
        self.lifted = lifted
        amounts: dict[Fact, set[Fraction]] = {}
        for action in actions:
            for _, fact, _, amount in _changes(action):
                if fact in asked:
                    amounts.setdefault(fact, set()).add(amount)
        self.variables = {
            fact: variable
            for fact, limits in asked.items()
            if not any(limit in derived for limit in limits)
            and (variable := _variable(lifted, fact, limits, amounts.get(fact, ()))) is not None
        }
        limits = self.limits = {f: own for f, own in asked.items() if f not in self.variables}
        self.values: dict[Fact, list[Fraction]] = {}
        self.cut: list[tuple[str, int]] = []
        """Numbers of which only some values count: a message, and the place of a limit."""
        changers: dict[Fact, list[Ground]] = {}
        for action in actions:
            for _, fact, _, _ in _changes(action):
                if fact in limits and action not in changers.setdefault(fact, [])[-1:]:
                    changers[fact].append(action)
        for fact in limits:
            self.values[fact] = self._reached(fact, changers.get(fact, ()))

    @property
    def initial(self) -> Iterator[Fact]:
        """The facts about numbers that are true at first."""
        for fact in self.limits:
            value = self.lifted.numbers.get(fact)
            if value is not None:
                yield _equal(fact, value)
                yield from (f for f, limit in self.limits[fact].items() if limit.holds(value))

    def variants(self, action: Ground) -> Iterator[Ground]:
        """The action for each value of each number that it adds to."""
        changes: dict[tuple[str, Fact], list[tuple[bool, Fraction]]] = {}
        for at, fact, add, amount in _changes(action):
            if fact in self.limits:
                changes.setdefault((at, fact), []).append((add, amount))
        if not changes:
            yield action
            return
        choices = [self._ways(action, at, fact, own) for (at, fact), own in changes.items()]
        for chosen in product(*choices):
            conditions = [c for needs, _ in chosen for c in needs]
            known = set(action.conditions)
            if any((when, test.negated()) in known for when, test in conditions):
                continue
            effects = [TimedEffect(*e) for _, gives in chosen for e in gives]
            yield replace(
                action,
                conditions=(*action.conditions, *(c for c in conditions if c not in known)),
                effects=(*action.effects, *effects),
            )

    def _ways(
        self, action: Ground, at: str, fact: Fact, changes: list[tuple[bool, Fraction]]
    ) -> list[tuple[list[tuple[str, Atom]], list[tuple[str, Atom]]]]:
        """The conditions and effects of each value at a time."""
        given = [amount for add, amount in changes if not add]
        added = sum((amount for add, amount in changes if add), Fraction(0))
        if given:
            new = given[-1]
            gives = [(at, Atom(_equal(fact, v), v == new)) for v in self.values[fact]]
            gives += [(at, Atom(f, li.holds(new))) for f, li in self.limits[fact].items()]
            return [([], gives)]
        found = []
        known = set(self.values[fact])
        for value in self.values[fact]:
            new = value + added
            if new not in known or not self._allowed(action, (at,), fact, value):
                continue
            gives = [(at, Atom(_equal(fact, value), False)), (at, Atom(_equal(fact, new), True))]
            gives += [
                (at, Atom(f, limit.holds(new)))
                for f, limit in self.limits[fact].items()
                if limit.holds(new) != limit.holds(value)
            ]
            if new == value:
                gives = []
            found.append(([(at, Atom(_equal(fact, value), True))], gives))
        return found

    def _allowed(self, action: Ground, times: Iterable[str], fact: Fact, value: Fraction) -> bool:
        """Whether what an action asks of a number at some times suits a value."""
        for when, test in action.conditions:
            limit = self.limits[fact].get(test.fact)
            if limit is not None and when in times and limit.holds(value) != test.value:
                return False
        return True

    def _reached(self, fact: Fact, changers: Iterable[Ground]) -> list[Fraction]:
        """The values that changes reach, as far as what their actions ask allows.

        What an action asks at its start counts for a change at its end, too.
        """
        first = self.lifted.numbers.get(fact)
        changes = {
            (add, amount, tuple(c for c in action.conditions if c[1].fact in self.limits[fact]))
            for action in changers
            for _, other, add, amount in _changes(action)
            if other == fact
        }
        found = [] if first is None else [first]
        found += sorted({amount for add, amount, _ in changes if not add} - set(found))
        steps = [(amount, asked) for add, amount, asked in changes if add]
        limits = self.limits[fact]
        values = _closure(found, steps, limits, None)
        if values is None:
            ends = [Fraction(0), *found, *(limit.least for limit in limits.values())]
            # (One step beyond a limit is a way to reach it.)
            ends.append(max(ends) + max((amount for amount, _ in steps), default=Fraction(0)))
            values = _closure(found, steps, limits, (min(ends), max(ends)))
            name, offset = " ".join(fact), next(iter(limits.values())).offset
            if values is None:
                raise NotSupportedError(
                    f"the number ({name}) may have more than {MOST_VALUES} values; limit it by"
                    " conditions of the actions that change it",
                    offset,
                )
            message = (
                f"the number ({name}) has no limits; only its values from {_number_text(min(ends))}"
                f" to {_number_text(max(ends))} are considered"
            )
            self.cut.append((message, offset))
        return values


def with_initial(lifted: Lifted, sums: Mapping[Fact, Mapping[Fact, Fraction]]) -> Lifted:
    """The problem with the values that the sums have at first."""
    found = dict(lifted.numbers)
    for name, factors in sums.items():
        if all(fact in found for fact in factors):
            found[name] = sum((x * found[fact] for fact, x in factors.items()), Fraction(0))
    return replace(lifted, numbers=found)


def _variable(
    lifted: Lifted, fact: Fact, limits: Mapping[Fact, Limit], amounts: Iterable[Fraction]
) -> NumberVariable | None:
    """A function as a number variable; None where it has no value at first.

    `amounts` are those by which actions change it.
    """
    first = lifted.numbers.get(fact)
    if first is None:
        return None
    return NumberVariable(fact, first, lcm(*(n.denominator for n in (first, *amounts))), limits)


_Step = tuple[Fraction, tuple[tuple[str, Atom], ...]]
"""An amount that is added, and what its action asks of the number."""


def _closure(
    first: Sequence[Fraction],
    steps: Sequence[_Step],
    limits: Mapping[Fact, Limit],
    ends: tuple[Fraction, Fraction] | None,
) -> list[Fraction] | None:
    """The values that steps reach from the first ones, within the ends; None if too many."""
    known = set(first)
    waiting = list(first)
    while waiting:
        value = waiting.pop()
        for amount, asked in steps:
            new = value + amount
            suits = all(limits[test.fact].holds(value) == test.value for _, test in asked)
            if not suits or new in known or (ends and not ends[0] <= new <= ends[1]):
                continue
            known.add(new)
            waiting.append(new)
            if len(known) > MOST_VALUES:
                return None
    return sorted(known)


def _equal(fact: Fact, value: Fraction) -> Fact:
    return "=", f"({' '.join(fact)})", _number_text(value)


def _number_text(value: Fraction) -> str:
    return str(json_number(value.numerator if value.denominator == 1 else value))


def _changes(action: Ground) -> Iterator[tuple[str, Fact, bool, Fraction]]:
    for at, effect in action.effects:
        if not isinstance(effect, Atom):
            yield at, effect.fact, effect.add, effect.amount
