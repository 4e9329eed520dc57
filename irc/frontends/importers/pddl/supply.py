"""How often a fact may become true, for facts whose supply is limited.

An action that uses up a fact happens at most as often as the fact becomes true. If all actions that
make it true are limited so themselves, that is a number: an order that waits is started once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from irc.frontends.importers.pddl.formula import bindings
from irc.frontends.importers.pddl.lifted import (
    Binding,
    Change,
    Conditional,
    Effect,
    Fact,
    Lifted,
    Literal,
    Schema,
    conjuncts,
)


class Supply:
    """The supplies of facts, computed when they are asked for."""

    def __init__(self, lifted: Lifted, bound: Mapping[str, Sequence[tuple[str, ...]]]) -> None:
        self.initial = lifted.initial | {fact for _, fact, value in lifted.timed if value}
        self._givers: dict[Fact, list[tuple[Schema, tuple[str, ...]]]] = {}
        for schema in lifted.schemas:
            for objects in bound[schema.name]:
                for fact in _given(schema.effects, _binding(schema, objects)):
                    self._givers.setdefault(fact, []).append((schema, objects))
        self._timed = {fact for _, fact, _ in lifted.timed}
        self._known: dict[Fact, int | None] = {}

    def of(self, fact: Fact) -> int | None:
        """How often a fact may become true, the beginning included; None where nothing limits it.

        What an action makes true and uses up itself counts as not limited.
        """
        if fact not in self._known:
            self._known[fact] = None  # (So that a circle ends.)
            self._known[fact] = self._count(fact)
        return self._known[fact]

    def _count(self, fact: Fact) -> int | None:
        if fact in self._timed:
            return None
        total = int(fact in self.initial)
        tokens = [self.used_up(*giver) for giver in self._givers.get(fact, ())]
        for token in dict.fromkeys(tokens):
            supply = None if token is None else self.of(token)
            if supply is None:
                return None
            total += supply
        return total

    def used_up(self, schema: Schema, objects: tuple[str, ...]) -> Fact | None:
        """The fact of least supply that an action uses up; None where there is none."""
        binding = _binding(schema, objects)
        found = [(n, f) for f in _taken(schema, binding) if (n := self.of(f)) is not None]
        return min(found)[1] if found else None


def _binding(schema: Schema, objects: tuple[str, ...]) -> Binding:
    return dict(zip((name for name, _ in schema.parameters), objects, strict=True))


def _given(effects: Iterable[Effect], binding: Binding) -> Iterator[Fact]:
    """The facts that effects make true, whatever their conditions are."""
    for effect in effects:
        if isinstance(effect, Conditional):
            for more in bindings(effect.variables, binding):
                yield from _given(effect.effects, more)
        elif isinstance(effect, Change) and effect.literal.value:
            yield effect.literal.fact(binding)


def _taken(schema: Schema, binding: Binding) -> Iterator[Fact]:
    """The facts that an action needs at its start, and takes away for certain."""
    gone = {
        effect.literal.fact(binding)
        for effect in schema.effects
        if isinstance(effect, Change) and effect.at == "start" and not effect.literal.value
    }
    for when, whole in schema.conditions:
        for part in conjuncts(whole):
            if when == "start" and isinstance(part, Literal) and part.value:
                fact = part.fact(binding)
                if fact in gone:
                    yield fact
