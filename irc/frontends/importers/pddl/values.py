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
from irc.frontends.importers.pddl.supply import Supply

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
    """The changes at one end of an action, where its tests of numbers at the start hold."""

    changes: tuple[_Change, ...]
    asked: tuple[_Asked, ...]

    def among(self, facts: Mapping[Fact, None]) -> _Event:
        """The part that is about some numbers."""
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


class _Ends(NamedTuple):
    """The least and the greatest value of a number, as far as they are known."""

    least: Fraction | None
    greatest: Fraction | None

    def allow(self, value: Fraction) -> bool:
        """Whether a value lies between them."""
        above = self.least is None or value >= self.least
        return above and (self.greatest is None or value <= self.greatest)


_Ground = tuple[Schema, tuple[str, ...]]
"""An action with its objects."""


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
        self._events: dict[_Event, list[_Ground]] | None = None

    def of(self, fact: Fact, offset: int) -> tuple[Fraction, ...]:
        """The values of a number, in order. Raises `NotSupportedError` where they are too many.

        `offset` is the place of what depends on it.
        """
        if fact not in self._values:
            if self._events is None:
                self._events = {}
                for event, ground in self._all_events():
                    self._events.setdefault(event, []).append(ground)
            self._count(fact, self._events, offset)
        return self._values[fact]

    def _count(self, fact: Fact, events: Mapping[_Event, Sequence[_Ground]], offset: int) -> None:
        """Counts the values of a number and of all on which its changes depend, together."""
        facts = _together(fact, events)
        first = {f: self.lifted.numbers[f] for f in facts if f in self.lifted.numbers}
        if len(first) < len(facts):
            raise NotSupportedError(
                f"this depends on ({' '.join(fact)}), and not all that changes it has a value at"
                " first; that is not supported",
                offset,
            )
        own: dict[_Event, list[_Ground]] = {}
        for event, ground in events.items():
            if (part := event.among(facts)).changes:
                own.setdefault(part, []).extend(ground)
        values = _explored(first, own, {})
        if _too_many(values):
            values = _explored(first, own, self._ends(first, own))
        if _too_many(values):
            raise self._refusal(fact, values, offset)
        self._values.update((one, tuple(sorted(found))) for one, found in values.items())

    def _ends(
        self, first: Known, events: Mapping[_Event, Sequence[_Ground]]
    ) -> Mapping[Fact, _Ends]:
        """Bounds of numbers that are changed by constants, by how often that can happen at all."""
        supply = Supply(self.lifted, self.bound)
        steps: dict[Fact, dict[tuple[bool, Fact | None], Fraction]] = {f: {} for f in first}
        open_ends: set[tuple[Fact, bool]] = set()
        for event, grounds in events.items():
            for change in event.changes:
                if not change.add or change.amount.factors:
                    open_ends |= {(change.fact, True), (change.fact, False)}
                    continue
                amount, own = change.amount.constant, steps[change.fact]
                for ground in grounds:
                    key = amount > 0, supply.used_up(*ground)
                    own[key] = max(own.get(key, Fraction(0)), abs(amount))
        found = {}
        for fact, own in steps.items():
            ends: list[Fraction | None] = []
            for up in (False, True):
                total: Fraction | None = first[fact]
                for (upwards, token), amount in own.items():
                    count = None if token is None else supply.of(token)
                    if upwards is up and total is not None:
                        change_by = None if count is None else count * (amount if up else -amount)
                        total = None if change_by is None else total + change_by
                ends.append(None if (fact, up) in open_ends else total)
            found[fact] = _Ends(*ends)
        return found

    @staticmethod
    def _refusal(
        fact: Fact, values: Mapping[Fact, set[Fraction]], offset: int
    ) -> NotSupportedError:
        most = max(values, key=lambda one: len(values[one]))
        return NotSupportedError(
            f"this depends on ({' '.join(fact)}), and ({' '.join(most)}) may have more than"
            f" {min(len(values[most]), MOST_VALUES)} values; limit it by conditions of the actions"
            " that change it",
            offset,
        )

    def _all_events(self) -> Iterator[tuple[_Event, _Ground]]:
        for schema in self.lifted.schemas:
            if not any(isinstance(change, NumericChange) for change in schema.changes()):
                continue
            for objects in self.bound[schema.name]:
                for event in self._events_of(schema, objects):
                    yield event, (schema, objects)

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


def _explored(
    first: Known, events: Iterable[_Event], ends: Mapping[Fact, _Ends]
) -> dict[Fact, set[Fraction]]:
    """The values of numbers, within their ends; incomplete where they are too many."""
    values = {fact: {value} for fact, value in first.items()}
    seen = {tuple(first.values())}
    waiting = [dict(first)]
    while waiting and len(seen) <= MOST_STATES and not _too_many(values):
        known = waiting.pop()
        for event in events:
            found = event.result(known)
            if found is None or (key := tuple(found.values())) in seen:
                continue
            if all(end.allow(found[fact]) for fact, end in ends.items()):
                seen.add(key)
                waiting.append(found)
                for one, value in found.items():
                    values[one].add(value)
    if len(seen) > MOST_STATES:
        most = max(values, key=lambda one: len(values[one]))
        values[most].update(Fraction(k) for k in range(MOST_VALUES + 1))
    return values


def _too_many(values: Mapping[Fact, set[Fraction]]) -> bool:
    return any(len(found) > MOST_VALUES for found in values.values())


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
