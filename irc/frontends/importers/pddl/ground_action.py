"""Ground actions: their conditions and effects on facts and numbers, each with its time."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from irc.frontends.importers.pddl.formula import Atom, Test
from irc.frontends.importers.pddl.lifted import Fact

TimedTest = tuple[str, Test]
"""A test with its time: "start", "all" or "end"."""


class NumericEffect(NamedTuple):
    """`fact` becomes `amount`, or (`add`) grows by it."""

    fact: Fact
    add: bool
    amount: Fraction


class TimedEffect(NamedTuple):
    """An effect with its time, "start" or "end"."""

    at: str
    effect: Atom | NumericEffect


@dataclass(frozen=True)
class Ground:
    """An action with its objects. `longest` is None where nothing limits its duration."""

    name: str
    objects: tuple[str, ...]
    conditions: tuple[TimedTest, ...]
    effects: tuple[TimedEffect, ...]
    shortest: Fraction
    longest: Fraction | None
    durative: bool
    variant: int = 1

    @cached_property
    def plan_name(self) -> str:
        """Its name in a plan: "(light match1)"."""
        return atom_text((self.name, *self.objects))

    @property
    def text(self) -> str:
        """Its id: the name in a plan, with a number from the second variant on."""
        return self.plan_name + (f" #{self.variant}" if self.variant > 1 else "")

    @cached_property
    def atoms(self) -> tuple[tuple[str, Atom], ...]:
        """The facts that it changes, with their times."""
        return tuple((at, effect) for at, effect in self.effects if isinstance(effect, Atom))


def atom_text(fact: Fact) -> str:
    """The text of a fact: "(at truck1 depot)"."""
    return f"({' '.join(fact)})"
