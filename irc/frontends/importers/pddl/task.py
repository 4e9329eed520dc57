"""Builds the IR task of ground actions.

A fact that some action changes is a boolean state variable; the value of every other fact is known
already. A fact that nothing reads and no action both adds and deletes is left out, because it
changes no schedule.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from irc.frontends.importers.instances import without_empty
from irc.frontends.importers.pddl.formula import Atom, Limit, Test
from irc.frontends.importers.pddl.ground import Grounded, formula_text, unreachable_goal
from irc.frontends.importers.pddl.ground_action import Ground, NumericEffect, atom_text
from irc.frontends.importers.pddl.lifted import Fact, Lifted, Literal, conjuncts
from irc.frontends.importers.pddl.metric import Objective
from irc.frontends.importers.pddl.numbers import NumberVariable
from irc.frontends.importers.pddl.symmetry import Interchangeable
from irc.model import Task
from irc.model.quantities import exact

Raw = dict[str, Any]


def pddl_task(
    lifted: Lifted,
    grounded: Grounded,
    objective: Objective,
    equal: Sequence[Interchangeable] = (),
) -> Task:
    """The IR task. Raises `UnreachableError`."""
    builder = _Builder(lifted, grounded, objective, tuple(equal))
    goals = list(builder.goals())
    return Task.model_validate(
        without_empty(
            {
                "name": lifted.problem,
                "metadata": builder.metadata(),
                "resources": [{"id": name} for name in builder.with_variants],
                "state": builder.state(),
                "actions": list(map(builder.action, builder.useful)),
                "goals": goals,
                **({} if objective.weights is None else {"objective": list(objective.names)}),
            }
        )
    )


@dataclass(frozen=True)
class _Builder:
    lifted: Lifted
    grounded: Grounded
    objective: Objective
    equal: tuple[Interchangeable, ...] = ()

    @cached_property
    def written(self) -> dict[Fact, set[bool]]:
        """The values that effects give to each fact."""
        values: dict[Fact, set[bool]] = {}
        for fact, value in self._all_effects():
            values.setdefault(fact, set()).add(value)
        return values

    def _all_effects(self) -> Iterator[Atom]:
        for action in self.useful:
            yield from (atom for _, atom in action.atoms)
        yield from (Atom(fact, value) for _, fact, value in self.lifted.timed)

    @cached_property
    def kept(self) -> dict[Fact, None]:
        """The facts that are state variables, in the order of their first use."""
        read = {test.fact for action in self.useful for _, test in action.conditions}
        read |= {test.fact for test in self.grounded.goal}
        both = self._written_both_ways
        return {
            fact: None
            for fact, _ in self._all_effects()
            if fact in read or (fact in both and fact not in self.grounded.derived)
        }

    @cached_property
    def _written_both_ways(self) -> set[Fact]:
        """The facts that useful actions both add and delete, which must not happen at once."""
        values: dict[Fact, set[bool]] = {}
        for action in self.useful:
            for _, (fact, value) in action.atoms:
                values.setdefault(fact, set()).add(value)
        return {fact for fact, given in values.items() if len(given) > 1}

    @cached_property
    def useful(self) -> list[Ground]:
        """The actions that bring about what a goal or another useful action needs.

        What the others do is needed nowhere, so a plan without them is as good.
        """
        actions = self.grounded.actions
        givers: dict[Test, list[int]] = {}
        for number, action in enumerate(actions):
            for atom in (*(atom for _, atom in action.atoms), *self._brings_about(action)):
                givers.setdefault(atom, []).append(number)
        found: set[int] = set()
        waiting = list(self.grounded.goal)
        needed = set(waiting)
        while waiting:
            for number in givers.pop(waiting.pop(), ()):
                if number not in found:
                    found.add(number)
                    new = {test for _, test in actions[number].conditions} - needed
                    needed |= new
                    waiting += new
        gains = (n for n, action in enumerate(actions) if self.objective.cost(action) < 0)
        found.update(gains)
        return [action for number, action in enumerate(actions) if number in found]

    def _brings_about(self, action: Ground) -> Iterator[Atom]:
        """The tests of numbers that an action's changes may help to meet."""
        for _, effect in action.effects:
            if isinstance(effect, NumericEffect):
                if effect not in self._helped:
                    self._helped[effect] = tuple(self._helped_by(effect))
                yield from self._helped[effect]

    @cached_property
    def _helped(self) -> dict[NumericEffect, tuple[Atom, ...]]:
        """The tests that each change may help to meet, as far as they were asked for."""
        return {}

    def _helped_by(self, effect: NumericEffect) -> Iterator[Atom]:
        for fact, limit in self._limits.get(effect.fact, {}).items():
            up = effect.amount > 0 if effect.add else limit.holds(effect.amount)
            if effect.amount or not effect.add:
                yield Atom(fact, up)

    @cached_property
    def _limits(self) -> dict[Fact, Mapping[Fact, Limit]]:
        """The limits of each number variable, by the fact that stands for each."""
        return {variable.fact: variable.limits for variable in self.grounded.numbers.values()}

    @cached_property
    def numbers(self) -> dict[Fact, NumberVariable]:
        """The number variables that useful actions or goals ask about, by their functions."""
        tests = [test for action in self.useful for _, test in action.conditions]
        asked = {test.fact for test in (*tests, *self.grounded.goal)}
        return {
            variable.fact: variable
            for fact, variable in self.grounded.numbers.items()
            if fact in asked
        }

    @cached_property
    def with_variants(self) -> dict[str, None]:
        """The names in plans of actions with several variants, which must not overlap either."""
        count = Counter(action.plan_name for action in self.useful if action.durative)
        return {name: None for name, variants in count.items() if variants > 1}

    def state(self) -> list[Raw]:
        initial = self.grounded.initial
        changes: dict[Fact, dict[Fraction, bool]] = {}
        for time, fact, value in self.lifted.timed:
            at = changes.setdefault(fact, {})
            at[time] = at.get(time, False) or value
        return [
            without_empty(
                {
                    "id": atom_text(fact),
                    **({"initial": True} if fact in initial else {}),
                    "changes": [
                        {"at": exact(time), "value": value}
                        for time, value in sorted(changes.get(fact, {}).items())
                    ],
                }
            )
            for fact in self.kept
        ] + [
            {"id": self._number_id(fact), "kind": "number", "initial": exact(number.initial)}
            for fact, number in self.numbers.items()
        ]

    def _number_id(self, fact: Fact) -> str:
        """The id of a number variable, which no fact has."""
        return atom_text(fact) if fact not in self.kept else f"number {atom_text(fact)}"

    def action(self, action: Ground) -> Raw:
        tests = ((when, test) for when, test in action.conditions if isinstance(test, Atom))
        cost = self.objective.cost(action)
        made: Raw = {
            "id": action.text,
            "duration": self._duration(action),
            "occurs": "optional" if self._happens_once(action) else {"min": 0},
            "uses": [{"resource": action.plan_name}] * (action.plan_name in self.with_variants),
            "conditions": [
                *self._atoms(tests),
                *(
                    {"at": when, **asked}
                    for when in ("start", "all", "end")
                    for asked in self._asked(t for w, t in action.conditions if w == when)
                ),
            ],
            "effects": [*self._atoms(action.atoms), *self._changes(action)],
            **({"cost": cost} if cost else {}),
        }
        return without_empty(made)

    def _duration(self, action: Ground) -> Any:
        if action.shortest == action.longest:
            return exact(action.shortest)
        most = self.longest if action.longest is None else action.longest
        if action.longest is None:
            most += action.shortest
        return {"min": exact(action.shortest), "max": exact(most)}

    @cached_property
    def longest(self) -> Fraction:
        """The time that an action without a greatest duration may last beyond its least one.

        It need not outlast all that the others take, one after another, and the last timed literal.
        """
        lengths = (a.shortest if a.longest is None else a.longest for a in self.useful)
        return sum(lengths, max((time for time, _, _ in self.lifted.timed), default=Fraction(1)))

    def _atoms(self, atoms: Iterable[tuple[str, Atom]]) -> list[Raw]:
        return [
            {"at": when, "var": atom_text(fact), **({} if value else {"value": False})}
            for when, (fact, value) in atoms
            if fact in self.kept
        ]

    def _asked(self, tests: Iterable[Test]) -> Iterator[Raw]:
        """The limits that tests which hold together set to each number."""
        limits: dict[Fact, tuple[list[Fraction], list[Fraction]]] = {}
        for test in tests:
            variable = self.grounded.numbers.get(test.fact)
            if variable is not None:
                own = limits.setdefault(variable.fact, ([], []))
                for level, levels in zip(variable.levels(test), own, strict=True):
                    levels += [] if level is None else [level]
        for fact, (least, most) in limits.items():
            low, high = max(least, default=None), min(most, default=None)
            asked: Raw = {"var": self._number_id(fact)}
            if low is not None and low == high:
                yield {**asked, "equals": exact(low)}
                continue
            asked |= {} if low is None else {"at_least": exact(low)}
            yield asked if high is None else {**asked, "at_most": exact(high)}

    def _changes(self, action: Ground) -> Iterator[Raw]:
        """The changes of numbers by an action."""
        for at, effect in action.effects:
            if isinstance(effect, NumericEffect) and effect.fact in self.numbers:
                changed = {"at": at, "var": self._number_id(effect.fact)}
                yield {**changed, ("add" if effect.add else "set"): exact(effect.amount)}

    def _happens_once(self, action: Ground) -> bool:
        """Whether an action deletes a condition of its own for good, so that it can happen once."""
        undone = {atom.negated() for _, atom in action.atoms}
        return any(
            test in undone and test.value not in self.written.get(test.fact, set())
            for _, test in action.conditions
            if isinstance(test, Atom)
        )

    def goals(self) -> Iterator[Raw]:
        places = {
            Atom(part.fact({}), part.value): part.offset
            for part in conjuncts(self.lifted.goal)
            if isinstance(part, Literal)
        }
        for test in self.grounded.goal:
            if test.fact in self.grounded.numbers:
                continue
            if test.value not in self.written.get(test.fact, set()) and (
                (test.fact in self.grounded.initial) != test.value
            ):
                raise unreachable_goal(f"the goal {formula_text(test)}", places.get(test))
            if test.fact in self.kept:
                yield {"var": atom_text(test.fact), **({} if test.value else {"value": False})}
        yield from self._asked(self.grounded.goal)

    def metadata(self) -> Raw:
        useful = set(map(id, self.useful))
        useless = [a.text for a in self.grounded.actions if id(a) not in useful]
        scale = self.objective.scale
        equal = [
            {"objects": list(one.tokens), "in_the_order_of": list(one.actions)}
            for one in self.equal
        ]
        return {
            "pddl": {
                "domain": self.lifted.domain,
                "problem": self.lifted.problem,
                **({"cost_per_unit_of_the_metric": scale} if scale != 1 else {}),
                **({"interchangeable": equal} if equal else {}),
            },
            **({"actions_that_change_nothing_that_matters": useless} if useless else {}),
        }
