"""Grounds schemas: makes all actions that could ever happen, without constant conditions.

Disjunctions and conditional effects are compiled away by case (Gazen and Knoblock, "Combining the
expressivity of UCPOP with the efficiency of Graphplan", 1997): an action with alternatives becomes
several *variants* of one name. Where a disjunction must hold throughout an action or in the goal,
the alternative may change meanwhile; a *derived fact* then says whether it holds, and every action
that affects it keeps it up to date. An effect that adds what it deletes adds it, as in PDDL2.1.
Actions that the delete relaxation cannot reach can never happen, and are left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from typing import NamedTuple

from irc.errors import IrcError
from irc.frontends.importers.pddl.formula import (
    MOST_WAYS,
    All,
    Any,
    Atom,
    Decider,
    Formula,
    NotSupportedError,
    Test,
    bindings,
    conjunction,
    disjunction,
    negation,
    tests_of,
    ways,
)
from irc.frontends.importers.pddl.ground_action import (
    Ground,
    NumericEffect,
    TimedEffect,
    TimedTest,
    atom_text,
)
from irc.frontends.importers.pddl.join import Join, TooLargeError
from irc.frontends.importers.pddl.lifted import (
    Change,
    Conditional,
    Effect,
    Fact,
    Lifted,
    Literal,
    NumericChange,
    Schema,
    conjuncts,
)
from irc.frontends.importers.pddl.numbers import (
    Numbers,
    NumberVariable,
    with_initial,
    with_sums,
)
from irc.frontends.importers.pddl.reached import reachable
from irc.frontends.importers.pddl.values import DURATION, TIME, Known, ReachedValues

MOST_ACTIONS = 200_000
"""Problems with more ground actions are refused."""

TimedWay = tuple[TimedTest, ...]

_Flat = tuple[tuple[tuple[str, Formula], ...], tuple[Change | NumericChange, Mapping[str, str]]]
"""An effect with the objects of its names, behind the conditions that are not constant."""


class DurationError(IrcError, ValueError):
    """An action whose duration is 0 or negative."""


class UnreachableError(IrcError, ValueError):
    """A goal that no plan can reach; `offset` is its place in the problem."""

    def __init__(self, message: str, offset: int | None) -> None:
        super().__init__(message)
        self.offset = offset


@dataclass(frozen=True)
class Grounded:
    """The ground actions, the goal, and the initial facts, derived ones included."""

    actions: list[Ground]
    goal: tuple[Test, ...]
    initial: frozenset[Fact]
    derived: frozenset[Fact] = frozenset()
    cut: tuple[tuple[str, int], ...] = ()
    """Warnings about numbers of which only some values count, with places in the domain."""
    numbers: Mapping[Fact, NumberVariable] = field(default_factory=dict)
    """The number variable that each fact about a limit speaks of."""


def ground(lifted: Lifted) -> Grounded:
    """All ground actions that the delete relaxation reaches, in the order of the domain.

    Raises `TooLargeError`, `NotSupportedError` with a place in the domain, `UnreachableError`, or
    `DurationError` for a reachable action of no or negative length.
    """
    join = Join(lifted)
    bound = join.run()
    decider = Decider(lifted, join.reached)
    decider.values_of = ReachedValues(lifted, bound, decider).of
    grounder = _Grounder(lifted, decider)
    goal = grounder.lasting(grounder.goal())
    variants = [
        variant
        for schema in lifted.schemas
        for objects in bound[schema.name]
        for variant in grounder.variants(schema, objects)
    ]
    variants = list(with_sums(variants, decider.sums))
    lifted = with_initial(lifted, decider.sums)
    derived = {test.fact for formula in grounder.derived.values() for test in tests_of(formula)}
    numbers = Numbers(lifted, decider.limits, variants, derived)
    variants = [variant for one in variants for variant in numbers.variants(one)]
    lifted = replace(lifted, initial=lifted.initial | set(numbers.initial))
    actions = grounder.numbered(v for one in variants for v in grounder.keep_derived(one))
    initial = lifted.initial | {
        fact for fact, formula in grounder.derived.items() if _holds(formula, lifted)
    }
    about = {limit: v for v in numbers.variables.values() for limit in v.limits}
    actions = reachable(actions, initial, lifted.timed, about)
    actions = _with_length(actions)
    return Grounded(
        actions, goal, frozenset(initial), frozenset(grounder.derived), tuple(numbers.cut), about
    )


def _with_length(actions: list[Ground]) -> list[Ground]:
    """The actions that can last; flying from a place to itself, say, takes no time and is none.

    An action of no length may be an instant, if its start touches nothing of its end. Raises
    `DurationError` where no action of a name can last.
    """
    kept = []
    without: dict[str, Ground] = {}
    for action in actions:
        most = action.longest
        lasts = most is None or (most > 0 and most >= action.shortest)
        at_once = action.shortest == most == 0 and _may_be_an_instant(action)
        if not action.durative or (action.shortest >= 0 and lasts) or at_once:
            kept.append(action)
        else:
            without.setdefault(action.name, action)
    names = {action.name for action in kept}
    for name, action in without.items():
        if name not in names:
            raise DurationError(
                f"the durative action {action.text} lasts from {action.shortest} to"
                f" {action.longest}; a length must be more than 0"
            )
    return kept


def _may_be_an_instant(action: Ground) -> bool:
    """Whether the start and the end of an action may be at one time, as in PDDL2.1."""
    asked = [{test.fact for w, test in action.conditions if w == at} for at in ("start", "end")]
    given = [{effect.effect.fact for effect in action.effects if effect.at == at} for at in _ENDS]
    later = {test.fact for when, test in action.conditions if when == "all"}
    touched = [asked[0] | given[0], asked[1] | given[1]]
    return not (given[0] & (touched[1] | later) or given[1] & touched[0])


_ENDS = ("start", "end")


class _Grounder:
    """Makes ground actions; `derived` are the disjunctions that need a fact of their own."""

    def __init__(self, lifted: Lifted, decider: Decider) -> None:
        self.lifted = lifted
        self.decider = decider
        self.derived: dict[Fact, Formula] = {}
        self._count: dict[str, int] = {}

    def goal(self) -> Formula:
        """The part of the goal that is not constant.

        Raises `UnreachableError` where a part can never hold.
        """
        parts = []
        for part in conjuncts(self.lifted.goal):
            formula = self.decider.formula(part, {})
            if formula is False:
                literal = part if isinstance(part, Literal) else None
                text = "this goal"
                if literal is not None:
                    text = f"the goal {formula_text(Atom(literal.fact({}), literal.value))}"
                raise unreachable_goal(text, None if literal is None else literal.offset)
            parts.append(formula)
        return conjunction(iter(parts))

    # --- alternatives ----------------------------------------------------------------------------

    def lasting(self, formula: Formula) -> tuple[Test, ...]:
        """Tests that together say a formula, with derived facts for its disjunctions."""
        if isinstance(formula, bool):
            return ()
        parts = formula.parts if isinstance(formula, All) else (formula,)
        return tuple(p if isinstance(p, Atom) else self._derived(p) for p in parts)

    def _derived(self, formula: Formula) -> Atom:
        timed = {fact for _, fact, _ in self.lifted.timed}
        for test in tests_of(formula):
            if test.fact in timed:
                raise NotSupportedError(
                    f"the disjunction {formula_text(formula)} must hold for some time, and depends"
                    " on a timed initial literal; that is not supported",
                    0,
                )
        name = formula_text(formula)[1:-1]
        self.derived[name,] = formula
        return Atom((name,), True)

    def variants(self, schema: Schema, objects: tuple[str, ...]) -> Iterator[Ground]:
        """The variants of an action, without the upkeep of derived facts."""
        names = [name for name, _ in schema.parameters]
        binding = dict(zip(names, objects, strict=True))
        conditions = [
            (when, self._condition(schema, when, binding)) for when in ("start", "all", "end")
        ]
        if any(formula is False for _, formula in conditions):
            return
        flat = list(self._flat(schema.effects, binding, ()))
        for known in self._all_known(schema, binding, flat):
            span = self._duration(schema, binding, known["start"])
            if span is None:
                continue
            base, cases = self._effects(flat, span, known)
            asked = [(when, self._equal(known, schema, when)) for when in ("start", "end")]
            asked = [(when, formula) for when, formula in asked if formula is not True]
            for way, effects in self._variants(schema, [*conditions, *asked], base, cases):
                yield Ground(
                    schema.name, objects, way, _merged(effects), *span, schema.duration is not None
                )

    def _condition(self, schema: Schema, when: str, binding: Mapping[str, str]) -> Formula:
        parts = (self.decider.formula(p, binding) for w, p in schema.conditions if w == when)
        formula = conjunction(parts)
        if when == "all" and not isinstance(formula, bool):
            formula = conjunction(iter(self.lasting(formula)))
        return formula

    # --- numbers that an action reads ------------------------------------------------------------

    def _all_known(
        self, schema: Schema, binding: Mapping[str, str], flat: Sequence[_Flat]
    ) -> Iterator[Mapping[str, Known]]:
        """The values of the numbers on which the duration and the changes of an action depend."""
        reads: dict[tuple[str, Fact], int] = {}
        for bound in schema.duration or ():
            linear = self.decider.linear(bound.amount, binding)
            for fact in () if linear is None else linear.factors:
                reads.setdefault(("start", fact), schema.offset)
        for _, (effect, bound_names) in flat:
            if isinstance(effect, NumericChange):
                linear = self.decider.linear(effect.amount, bound_names)
                for fact in () if linear is None else linear.factors:
                    if fact not in (DURATION, TIME):
                        reads.setdefault((effect.at, fact), effect.offset)
        values = [self.decider.values_of(fact, offset) for (_, fact), offset in reads.items()]
        for chosen in product(*values):
            found: dict[str, dict[Fact, Fraction]] = {"start": {}, "end": {}}
            for (when, fact), value in zip(reads, chosen, strict=True):
                found[when][fact] = value
            yield found

    def _equal(self, known: Mapping[str, Known], schema: Schema, when: str) -> Formula:
        """That the numbers have the values that are taken as known."""
        return conjunction(
            self.decider.equals(fact, value, schema.offset) for fact, value in known[when].items()
        )

    # --- alternatives ----------------------------------------------------------------------------

    def _variants(
        self,
        schema: Schema,
        conditions: Sequence[tuple[str, Formula]],
        base: Sequence[TimedEffect],
        cases: Sequence[_Case],
    ) -> Iterator[tuple[TimedWay, list[TimedEffect]]]:
        found: list[tuple[TimedWay, list[TimedEffect]]] = [
            (way, list(base)) for way in _timed_ways(conditions, schema.offset)
        ]
        for case in cases:
            met = _timed_ways(case.conditions, schema.offset)
            unmet = [
                way
                for when, formula in case.conditions
                for way in _timed_ways([(when, negation(formula))], schema.offset)
            ]
            longer = []
            for way, effects in found:
                for extra, more in ((met, case.effects), (unmet, [])):
                    for one in extra:
                        joined = _joined(way, one)
                        if joined is not None:
                            longer.append((joined, [*effects, *more]))
            found = longer
            if len(found) > MOST_WAYS:
                raise NotSupportedError(
                    f"the action {schema.name!r} has more than {MOST_WAYS} combinations of"
                    " alternatives and conditional effects",
                    schema.offset,
                )
        yield from found

    def _duration(
        self, schema: Schema, binding: Mapping[str, str], known: Known
    ) -> tuple[Fraction, Fraction | None] | None:
        """The least and the greatest duration; None if a bound has no value."""
        if schema.duration is None:
            return Fraction(0), Fraction(0)
        least, most = Fraction(0), None
        for bound in schema.duration:
            linear = self.decider.linear(bound.amount, binding)
            if linear is None:
                return None
            amount = linear.value(known)
            if bound.relation in ("=", ">="):
                least = max(least, amount) if amount >= 0 or bound.relation == ">=" else amount
            if bound.relation in ("=", "<="):
                most = amount if most is None else min(most, amount)
        return least, most

    # --- effects ---------------------------------------------------------------------------------

    def _effects(
        self,
        flat: Sequence[_Flat],
        span: tuple[Fraction, Fraction | None],
        known: Mapping[str, Known],
    ) -> tuple[list[TimedEffect], list[_Case]]:
        """The effects without conditions, and those with, by their conditions."""
        base: list[TimedEffect] = []
        cases: dict[tuple[tuple[str, Formula], ...], list[TimedEffect]] = {}
        for conditions, effect in flat:
            made = self._effect(effect[0], effect[1], span, known)
            if made is None:
                continue
            if _is_plain_anyway(conditions, made):
                base.append(made)
            elif conditions:
                cases.setdefault(conditions, []).append(made)
            else:
                base.append(made)
        return base, [_Case(*case) for case in cases.items()]

    def _flat(
        self,
        effects: Iterable[Effect],
        binding: Mapping[str, str],
        outer: tuple[tuple[str, Formula], ...],
    ) -> Iterator[_Flat]:
        for effect in effects:
            if not isinstance(effect, Conditional):
                yield outer, (effect, binding)
                continue
            for bound in bindings(effect.variables, binding):
                inner = self._case(effect, bound, outer)
                if inner is not None:
                    yield from self._flat(effect.effects, bound, inner)

    def _case(
        self,
        effect: Conditional,
        binding: Mapping[str, str],
        outer: tuple[tuple[str, Formula], ...],
    ) -> tuple[tuple[str, Formula], ...] | None:
        """The conditions of an effect that are not constant; None if they never hold."""
        found = list(outer)
        for when, condition in effect.conditions:
            formula = self.decider.formula(condition, binding)
            if formula is False:
                return None
            if formula is True:
                continue
            if when == "all":
                raise NotSupportedError(
                    "an effect whose condition must hold over all of the action is not supported",
                    effect.offset,
                )
            found.append((when, formula))
        return tuple(found)

    def _effect(
        self,
        effect: Change | NumericChange,
        binding: Mapping[str, str],
        span: tuple[Fraction, Fraction | None],
        known: Mapping[str, Known],
    ) -> TimedEffect | None:
        if isinstance(effect, Change):
            fact = effect.literal.fact(binding)
            if not effect.literal.value and fact not in self.decider.reached:
                return None
            return TimedEffect(effect.at, Atom(fact, effect.literal.value))
        linear = self.decider.linear(effect.amount, binding)
        if linear is None:
            return None
        left = linear.given(known[effect.at])
        amount = left.constant
        for name, factor in left.factors.items():
            if name != DURATION or span[0] != span[1]:
                raise NotSupportedError(
                    f"this changes a number by what depends on {atom_text(name)}, which is not"
                    " certain when the action begins; that is not supported",
                    effect.offset,
                )
            amount += factor * span[0]
        sign = -1 if effect.verb == "decrease" else 1
        changed = NumericEffect(effect.target.fact(binding), effect.verb != "assign", sign * amount)
        return TimedEffect(effect.at, changed)

    # --- derived facts ---------------------------------------------------------------------------

    def keep_derived(self, action: Ground) -> Iterator[Ground]:
        """The action, or its variants that keep all derived facts up to date."""
        found = [action]
        for fact, formula in self.derived.items():
            facts = {test.fact for test in tests_of(formula)}
            for at in ("start", "end"):
                found = [v for a in found for v in self._upkeep(a, fact, formula, facts, at)]
        yield from found

    def _upkeep(
        self, action: Ground, fact: Fact, formula: Formula, facts: set[Fact], at: str
    ) -> Iterator[Ground]:
        given = {e.fact: e.value for when, e in action.atoms if when == at and e.fact in facts}
        if not given:
            yield action
            return
        known = {
            t.fact: t.value for when, t in action.conditions if when == at and isinstance(t, Atom)
        }
        left = _with_values(formula, {**known, **given})
        for value, rest in ((True, left), (False, negation(left))):
            for way in ways(rest):
                joined = _joined(action.conditions, tuple((at, test) for test in way))
                if joined is not None:
                    effect = TimedEffect(at, Atom(fact, value))
                    yield replace(action, conditions=joined, effects=(*action.effects, effect))

    def numbered(self, actions: Iterable[Ground]) -> list[Ground]:
        """The actions, with the variants of one name numbered."""
        found: list[Ground] = []
        for action in actions:
            number = self._count.get(action.plan_name, 0) + 1
            self._count[action.plan_name] = number
            found.append(replace(action, variant=number) if number > 1 else action)
            if len(found) > MOST_ACTIONS:
                raise TooLargeError(f"there are more than {MOST_ACTIONS:,} ground actions")
        return found


def unreachable_goal(text: str, offset: int | None) -> UnreachableError:
    """The error of a goal that can never hold."""
    return UnreachableError(
        f"{text} can never hold: it does not hold at first, and no action that can happen brings"
        " it about",
        offset,
    )


class _Case(NamedTuple):
    """Effects that happen if all conditions hold."""

    conditions: tuple[tuple[str, Formula], ...]
    effects: list[TimedEffect]


def _timed_ways(conditions: Iterable[tuple[str, Formula]], offset: int) -> list[TimedWay]:
    found: list[TimedWay] = [()]
    for when, formula in conditions:
        more = [tuple((when, test) for test in way) for way in ways(formula, offset)]
        found = [j for one in found for two in more if (j := _joined(one, two)) is not None]
        if len(found) > MOST_WAYS:
            raise NotSupportedError(f"this has more than {MOST_WAYS} alternatives", offset)
    return found


def _joined(one: TimedWay, two: TimedWay) -> TimedWay | None:
    known = set(one)
    added = [item for item in dict.fromkeys(two) if item not in known]
    if any((when, test.negated()) in known for when, test in added):
        return None
    return (*one, *added)


def _is_plain_anyway(conditions: tuple[tuple[str, Formula], ...], made: TimedEffect) -> bool:
    """Whether an effect only takes away what its condition asks for, at the same time."""
    if len(conditions) != 1 or not isinstance(made.effect, Atom):
        return False
    return conditions[0] == (made.at, made.effect.negated())


def _merged(effects: Iterable[TimedEffect]) -> tuple[TimedEffect, ...]:
    """The effects; what is deleted and added at once is added."""
    atoms: dict[tuple[str, Fact], bool] = {}
    others: list[TimedEffect] = []
    for effect in effects:
        if isinstance(effect.effect, Atom):
            key = (effect.at, effect.effect.fact)
            atoms[key] = atoms.get(key, False) or effect.effect.value
        else:
            others.append(effect)
    made = [TimedEffect(at, Atom(fact, value)) for (at, fact), value in atoms.items()]
    return (*made, *others)


def _with_values(formula: Formula, values: Mapping[Fact, bool]) -> Formula:
    if isinstance(formula, bool):
        return formula
    if isinstance(formula, Atom):
        known = values.get(formula.fact)
        return formula if known is None else known == formula.value
    if isinstance(formula, (All, Any)):
        parts = (_with_values(part, values) for part in formula.parts)
        return conjunction(parts) if isinstance(formula, All) else disjunction(parts)
    return formula


def _holds(formula: Formula, lifted: Lifted) -> bool:
    values = {test.fact: test.fact in lifted.initial for test in tests_of(formula)}
    return _with_values(formula, values) is True


def formula_text(formula: Formula) -> str:
    """The text of a formula, as in PDDL."""
    if isinstance(formula, bool):
        return "(and)" if formula else "(or)"
    if isinstance(formula, Atom):
        text = atom_text(formula.fact)
        return text if formula.value else f"(not {text})"
    word = "and" if isinstance(formula, All) else "or"
    return f"({word} {' '.join(formula_text(part) for part in formula.parts)})"
