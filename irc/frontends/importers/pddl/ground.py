"""Grounds schemas: makes all actions that could ever happen, without constant conditions.

unified-planning's own grounder tries every combination of objects and leaves out actions that add
what they delete. Here constant conditions restrict the objects while they are bound, and an effect
that adds what it deletes adds it, as in PDDL2.1. Actions that the delete relaxation cannot reach
can never happen, and are left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from irc.errors import IrcError
from irc.frontends.importers.pddl.lifted import (
    Equality,
    Fact,
    Lifted,
    Literal,
    Schema,
    Term,
    evaluate,
)

MOST_ACTIONS = 20_000
"""Problems with more ground actions are refused."""

_MOST_BINDINGS = 5_000_000

Atom = tuple[Fact, bool]
"""A fact and whether it is true."""


class TooLargeError(IrcError, ValueError):
    """Grounding needs more than `MOST_ACTIONS` actions."""


class DurationError(IrcError, ValueError):
    """An action whose duration is 0 or negative."""


@dataclass(frozen=True)
class Ground:
    """An action with its objects. Times are "start", "all" or "end" as in the IR."""

    name: str
    objects: tuple[str, ...]
    conditions: tuple[tuple[str, Atom], ...]
    effects: tuple[tuple[str, Atom], ...]
    shortest: Fraction
    longest: Fraction

    @property
    def text(self) -> str:
        """Its name in a plan: "(light match1)"."""
        return atom_text((self.name, *self.objects))


def atom_text(fact: Fact) -> str:
    """The text of a fact: "(at truck1 depot)"."""
    return f"({' '.join(fact)})"


def ground(lifted: Lifted) -> list[Ground]:
    """All ground actions that the delete relaxation reaches, in the order of the domain.

    Raises `TooLargeError`, or `DurationError` for a reachable action of no or negative length.
    """
    changing = {literal.predicate for s in lifted.schemas for _, literal in s.effects}
    changing |= {fact[0] for _, fact, _ in lifted.timed}
    bindings = _Bindings(lifted, changing)
    found: list[Ground] = []
    for schema in lifted.schemas:
        for objects in bindings.of(schema):
            action = _instance(schema, objects, lifted)
            if action is not None:
                found.append(action)
            if len(found) > MOST_ACTIONS:
                raise TooLargeError(f"there are more than {MOST_ACTIONS:,} ground actions")
    reachable = _reachable(found, lifted)
    durative = {schema.name for schema in lifted.schemas if schema.duration is not None}
    for action in reachable:
        if action.name in durative and not 0 < action.longest >= action.shortest >= 0:
            raise DurationError(
                f"the durative action {action.text} lasts from {action.shortest} to"
                f" {action.longest}; a length must be more than 0"
            )
    return reachable


@dataclass
class _Bindings:
    """Finds the objects for which the constant conditions of an action hold."""

    lifted: Lifted
    changing: set[str]
    tried: int = field(default=0)

    def of(self, schema: Schema) -> Iterator[tuple[str, ...]]:
        tests: list[list[Literal | Equality]] = [[] for _ in range(len(schema.parameters) + 1)]
        for _, literal in schema.conditions:
            if literal.predicate not in self.changing:
                tests[_ready(literal.terms)].append(literal)
        for equality in schema.equalities:
            tests[_ready((equality.left, equality.right))].append(equality)
        if self._hold(tests[0], ()):
            yield from self._extend(schema, tests, ())

    def _extend(
        self, schema: Schema, tests: Sequence[Sequence[Literal | Equality]], bound: tuple[str, ...]
    ) -> Iterator[tuple[str, ...]]:
        at = len(bound)
        if at == len(schema.parameters):
            yield bound
            return
        for item in schema.parameters[at]:
            self.tried += 1
            if self.tried > _MOST_BINDINGS:
                raise TooLargeError(f"grounding takes more than {_MOST_BINDINGS:,} steps")
            longer = (*bound, item)
            if self._hold(tests[at + 1], longer):
                yield from self._extend(schema, tests, longer)

    def _hold(self, tests: Iterable[Literal | Equality], bound: tuple[str, ...]) -> bool:
        for test in tests:
            if isinstance(test, Equality):
                if (_object(test.left, bound) == _object(test.right, bound)) != test.same:
                    return False
            elif (test.fact(bound) in self.lifted.initial) != test.value:
                return False
        return True


def _ready(terms: Iterable[Term]) -> int:
    """The number of parameters after which all terms are known."""
    return max((term + 1 for term in terms if isinstance(term, int)), default=0)


def _object(term: Term, bound: tuple[str, ...]) -> str:
    return bound[term] if isinstance(term, int) else term


def _instance(schema: Schema, objects: tuple[str, ...], lifted: Lifted) -> Ground | None:
    """The ground action; None if its duration has no value, so that it can never happen."""
    shortest = longest = Fraction(0)
    if schema.duration is not None:
        least, most = (evaluate(e, schema, objects, lifted.numbers) for e in schema.duration)
        if least is None or most is None:
            return None
        shortest, longest = least, most
    conditions = {(when, (lit.fact(objects), lit.value)): None for when, lit in schema.conditions}
    if any((when, (fact, not value)) in conditions for when, (fact, value) in conditions):
        return None  # It needs a fact to be true and false at once.
    effects: dict[tuple[str, Fact], bool] = {}
    for when, literal in schema.effects:
        key = (when, literal.fact(objects))
        effects[key] = (
            effects.get(key, False) or literal.value
        )  # What is deleted and added is added.
    return Ground(
        schema.name,
        objects,
        tuple(conditions),
        tuple((when, (fact, value)) for (when, fact), value in effects.items()),
        shortest,
        longest,
    )


# --- reachability ---------------------------------------------------------------------------------


@dataclass
class _Phase:
    """A start or an end that becomes possible when all of its conditions are reached."""

    waiting: int
    gives: list[Atom]
    action: int | None
    """The action that is possible with this; None for a start, whose end must be possible too."""


def _reachable(actions: Sequence[Ground], lifted: Lifted) -> list[Ground]:
    """The actions that could happen if nothing were ever deleted, in time linear in their size.

    The effects of a start need only its start conditions, so that two actions may each need an
    effect of the other's start.
    """
    phases: list[_Phase] = []
    waiting: dict[Atom, list[int]] = {}
    ready: list[int] = []

    def add(needs: set[Atom], gives: list[Atom], action: int | None) -> None:
        for atom in needs:
            waiting.setdefault(atom, []).append(len(phases))
        if not needs:
            ready.append(len(phases))
        phases.append(_Phase(len(needs), gives, action))

    for number, action in enumerate(actions):
        at_start = {atom for when, atom in action.conditions if when == "start"}
        add(at_start, [atom for when, atom in action.effects if when == "start"], None)
        every = {atom for _, atom in action.conditions}
        add(every, [atom for when, atom in action.effects if when == "end"], number)
    reached: set[Atom] = set()
    possible: set[int] = set()

    def reach(atom: Atom) -> None:
        if atom in reached:
            return
        reached.add(atom)
        for index in waiting.get(atom, ()):
            phases[index].waiting -= 1
            if phases[index].waiting == 0:
                ready.append(index)

    for fact in lifted.initial:
        reach((fact, True))
    for fact, value in [atom for atom in waiting if not atom[1]]:
        if fact not in lifted.initial:
            reach((fact, value))
    for _, fact, value in lifted.timed:
        reach((fact, value))
    while ready:
        phase = phases[ready.pop()]
        if phase.action is not None:
            possible.add(phase.action)
        for atom in phase.gives:
            reach(atom)
    return [action for number, action in enumerate(actions) if number in possible]
