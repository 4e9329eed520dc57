"""The values that a number which actions change may ever have, where they are few.

What depends on such a number (a duration, a change by another number, a comparison of two numbers)
is constant once the value is known. So it becomes one ground action, or one alternative, for each
value. Values are counted by what actions ask of numbers alone: an action may happen whenever the
numbers suit it, and numbers that depend on each other are counted together.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from irc.frontends.importers.pddl.formula import (
    RELATIONS,
    Decider,
    Linear,
    NotSupportedError,
    bindings,
)
from irc.frontends.importers.pddl.lifted import (
    Comparison,
    Conditional,
    Effect,
    Fact,
    Lifted,
    NumericChange,
    Schema,
    conjuncts,
)

MOST_VALUES = 200
"""A number with more values is refused where something depends on its value."""

DURATION = ("?duration",)
TIME = ("total-time",)

Known = Mapping[Fact, Fraction]
"""Numbers whose values are known."""


MOST_STATES = 20_000
"""Numbers that depend on each other are refused where they have more values together."""


class _Asked(NamedTuple):
    """A comparison of a sum with 0."""

    relation: str
    sum: Linear

    def holds(self, known: Known) -> bool:
        """Whether it holds for values of all its numbers."""
        return RELATIONS[self.relation](self.sum.value(known), Fraction(0))


class _Change(NamedTuple):
    """`amount` is added to a number, or (not `add`) is its new value."""

    fact: Fact
    add: bool
    amount: Linear


class _Event(NamedTuple):
    """What one end of an action changes, where what it asks of numbers at its start holds."""

    changes: tuple[_Change, ...]
    asked: tuple[_Asked, ...]

    def among(self, facts: Mapping[Fact, None]) -> _Event:
        """What of it is about some numbers."""
        return _Event(
            tuple(change for change in self.changes if change.fact in facts),
            tuple(one for one in self.asked if all(f in facts for f in one.sum.factors)),
        )

    def result(self, known: Known) -> dict[Fact, Fraction] | None:
        """The numbers behind it; None where it cannot happen."""
        if not all(one.holds(known) for one in self.asked):
            return None
        found = dict(known)
        for change in self.changes:
            amount = change.amount.value(known)
            found[change.fact] = found[change.fact] + amount if change.add else amount
        return found


class ReachedValues:
    """The values of numbers, counted when they are first asked for."""

    def __init__(
        self,
        lifted: Lifted,
        bound: Mapping[str, Sequence[tuple[str, ...]]],
        decider: Decider,
    ) -> None:
        self.lifted, self.bound, self.decider = lifted, bound, decider
        self._values: dict[Fact, tuple[Fraction, ...]] = {}
        self._events: list[_Event] | None = None

    def of(self, fact: Fact, offset: int) -> tuple[Fraction, ...]:
        """The values of a number, in order. Raises `NotSupportedError` where they are too many.

        `offset` is the place of what depends on it.
        """
        if fact not in self._values:
            if self._events is None:
                self._events = list(dict.fromkeys(self._all_events()))
            self._count(fact, self._events, offset)
        return self._values[fact]

    def _count(self, fact: Fact, events: Iterable[_Event], offset: int) -> None:
        """Counts the values of a number and of all on which its changes depend, together."""
        facts = _together(fact, events)
        own = dict.fromkeys(e for event in events if (e := event.among(facts)).changes)
        first = {f: self.lifted.numbers[f] for f in facts if f in self.lifted.numbers}
        if len(first) < len(facts):
            raise NotSupportedError(
                f"this depends on ({' '.join(fact)}), and not all that changes it has a value at"
                " first; that is not supported",
                offset,
            )
        seen = {tuple(first.values()): None}
        waiting = [first]
        values: dict[Fact, set[Fraction]] = {f: {value} for f, value in first.items()}
        while waiting:
            known = waiting.pop()
            for event in own:
                found = event.result(known)
                if found is None or (key := tuple(found.values())) in seen:
                    continue
                seen[key] = None
                waiting.append(found)
                for one, value in found.items():
                    values[one].add(value)
                if len(seen) > MOST_STATES or max(map(len, values.values())) > MOST_VALUES:
                    raise self._too_many(fact, values, offset)
        self._values.update((one, tuple(sorted(own))) for one, own in values.items())

    @staticmethod
    def _too_many(
        fact: Fact, values: Mapping[Fact, set[Fraction]], offset: int
    ) -> NotSupportedError:
        most = max(values, key=lambda one: len(values[one]))
        return NotSupportedError(
            f"this depends on ({' '.join(fact)}), and ({' '.join(most)}) may have more than"
            f" {min(len(values[most]), MOST_VALUES)} values; limit it by conditions of the actions"
            " that change it",
            offset,
        )

    def _all_events(self) -> Iterator[_Event]:
        for schema in self.lifted.schemas:
            if not any(isinstance(change, NumericChange) for change in schema.changes()):
                continue
            for objects in self.bound[schema.name]:
                yield from self._events_of(schema, objects)

    def _events_of(self, schema: Schema, objects: tuple[str, ...]) -> Iterator[_Event]:
        names = [name for name, _ in schema.parameters]
        binding = dict(zip(names, objects, strict=True))
        asked = tuple(self._asked(schema, binding))
        changes: dict[str, list[_Change]] = {}
        for change, bound in _numeric(schema.effects, binding):
            amount = self._amount(schema, binding, self.decider.linear(change.amount, bound))
            if amount is not None:
                signed = amount.times(Fraction(-1)) if change.verb == "decrease" else amount
                made = _Change(change.target.fact(bound), change.verb != "assign", signed)
                changes.setdefault(change.at, []).append(made)
        for own in changes.values():
            yield _Event(tuple(own), asked)

    def _amount(
        self, schema: Schema, binding: Mapping[str, str], amount: Linear | None
    ) -> Linear | None:
        """The amount with the duration in terms of numbers; None where there is none."""
        if amount is None or DURATION not in amount.factors:
            return amount
        for bound in schema.duration or ():
            lasts = self.decider.linear(bound.amount, binding)
            if bound.relation == "=" and lasts is not None:
                rest = {f: x for f, x in amount.factors.items() if f != DURATION}
                return Linear(rest, amount.constant).plus(lasts.times(amount.factors[DURATION]))
        return None

    def _asked(self, schema: Schema, binding: Mapping[str, str]) -> Iterator[_Asked]:
        for when, whole in schema.conditions:
            for part in conjuncts(whole):
                if when != "start" or not isinstance(part, Comparison):
                    continue
                difference = self.decider.difference(part, binding)
                if difference is not None and difference.factors:
                    yield _Asked(part.relation, difference)


def _together(fact: Fact, events: Iterable[_Event]) -> dict[Fact, None]:
    """The number, those on which its changes depend, and those with which these are compared."""
    facts = {fact: None}
    waiting = [fact]
    while waiting:
        one = waiting.pop()
        for event in events:
            for change in event.changes:
                if change.fact != one:
                    continue
                compared = [a.sum.factors for a in event.asked if one in a.sum.factors]
                for other in (f for factors in (change.amount.factors, *compared) for f in factors):
                    if other not in facts:
                        facts[other] = None
                        waiting.append(other)
    return facts


def _numeric(
    effects: Iterable[Effect], binding: Mapping[str, str]
) -> Iterator[tuple[NumericChange, Mapping[str, str]]]:
    """All changes of numbers, whatever the conditions of their effects are."""
    for effect in effects:
        if isinstance(effect, Conditional):
            for bound in bindings(effect.variables, binding):
                yield from _numeric(effect.effects, bound)
        elif isinstance(effect, NumericChange):
            yield effect, binding
