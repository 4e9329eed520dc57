"""Reads conditions, expressions and effects, and records everything that is wrong with them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise

from irc.frontends.importers.pddl.declarations import Declarations, Faults, typed_names
from irc.frontends.importers.pddl.lifted import (
    Arithmetic,
    Change,
    Comparison,
    Condition,
    Conditional,
    Effect,
    Equality,
    Every,
    Expression,
    Literal,
    Number,
    NumericChange,
    Some,
    Special,
    Timed,
    Value,
    Variables,
)
from irc.frontends.importers.pddl.sexpr import Form, Word

NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d{1,3})?\Z", re.ASCII)

_TIMES = {"at": ("start", "end"), "over": ("all",)}
_NEGATED = {"<": ">=", ">": "<=", "<=": ">", ">=": "<", "=": "!=", "!=": "="}
_OPERATORS = ("+", "-", "*", "/")
_VERBS = {
    "increase": "increase",
    "decrease": "decrease",
    "assign": "assign",
    "scale-up": "",
    "scale-down": "",
}
_REFUSED: Mapping[str, str] = {
    "preference": "preferences",
    "always": "trajectory constraints",
    "sometime": "trajectory constraints",
    "within": "trajectory constraints",
    "at-most-once": "trajectory constraints",
    "sometime-after": "trajectory constraints",
    "sometime-before": "trajectory constraints",
    "always-within": "trajectory constraints",
    "hold-during": "trajectory constraints",
    "hold-after": "trajectory constraints",
    "scale-up": "numeric effects other than increase, decrease and assign",
    "scale-down": "numeric effects other than increase, decrease and assign",
}
NOTHING = Every(())
"""A condition that always holds."""


class Formulas:
    """Reads the formulas of one file. `variables` are the parameters in scope."""

    def __init__(self, names: Declarations, faults: Faults, *, durative: bool = False) -> None:
        self.names = names
        self.faults = faults
        self.durative = durative
        self.variables: set[str] = set()

    # --- conditions ------------------------------------------------------------------------------

    def condition(self, form: Form, wanted: bool = True) -> Condition:
        """A condition, or its negation, in negation normal form."""
        head = form.head
        if not form.items:
            return NOTHING if wanted else Some(())
        if head in self.names.predicates:
            return self.literal(form, wanted)
        if head in ("and", "or"):
            parts = self._parts(form, lambda part: self.condition(part, wanted))
            return Every(parts) if (head == "and") == wanted else Some(parts)
        if head == "not":
            return self._negation(form, lambda part: self.condition(part, not wanted))
        if head == "imply":
            if len(form.forms) != 2 or len(form.items) != 3:
                self.faults.add(form, "expected (imply CONDITION CONDITION)")
                return NOTHING
            parts = (
                self.condition(form.forms[0], not wanted),
                self.condition(form.forms[1], wanted),
            )
            return Some(parts) if wanted else Every(parts)
        if head in ("forall", "exists"):
            return self._quantified(form, wanted)
        if head in _NEGATED:
            return self._comparison(form, wanted)
        self._unknown(form, "predicate")
        return NOTHING

    def _parts(self, form: Form, read: Callable[[Form], Condition]) -> tuple[Condition, ...]:
        for item in form.items[1:]:
            if isinstance(item, Word):
                self.faults.add(item, f"expected a list in parentheses, not {item.text!r}")
        return tuple(read(part) for part in form.forms)

    def _negation(self, form: Form, read: Callable[[Form], Condition]) -> Condition:
        if len(form.forms) != 1 or len(form.items) != 2:
            self.faults.add(form, "expected (not CONDITION)")
            return NOTHING
        return read(form.forms[0])

    def _quantified(self, form: Form, wanted: bool) -> Condition:
        found = self._scope(form)
        if found is None:
            return NOTHING
        variables, body = found
        with_variables = self.variables
        self.variables = with_variables | {name for name, _ in variables}
        part = (self.condition(body, wanted),)
        self.variables = with_variables
        both = (form.head == "forall") == wanted
        return Every(part, variables) if both else Some(part, variables)

    def _scope(self, form: Form) -> tuple[Variables, Form] | None:
        """The variables and the body of a quantifier."""
        if len(form.items) != 3 or len(form.forms) != 2:
            self.faults.add(form, f"expected ({form.head} (?VARIABLE - TYPE …) BODY)")
            return None
        return self.parameters(form.forms[0].items), form.forms[1]

    def parameters(self, items: Sequence[Word | Form]) -> Variables:
        """Parameters with the objects that each may stand for."""
        named = typed_names(items, self.faults)
        self.names.check_types(named, self.faults)
        for name, _ in named:
            if not name.text.startswith("?"):
                self.faults.add(name, f"expected a parameter such as '?x', not {name.text!r}")
        return tuple(
            (name.text, self.names.members([word.text for word in types])) for name, types in named
        )

    def literal(self, form: Form, wanted: bool) -> Literal:
        """A predicate with its terms."""
        expected = self.names.predicates.get(form.head)
        if expected is None:
            self._unknown(form, "predicate")
        elif form.forms or len(form.items) - 1 != expected:
            message = f"the predicate {form.head!r} takes {expected} objects"
            self.faults.add(form, f"{message}, not {len(form.items) - 1}")
        else:
            self._terms(form)
        return Literal(form.head, tuple(form.words[1:]), wanted, form.offset)

    def _terms(self, form: Form) -> None:
        """Records undeclared parameters and objects."""
        for item in form.items[1:]:
            if not isinstance(item, Word):
                continue
            if item.text.startswith("?"):
                if item.text not in self.variables:
                    self.faults.unknown(item, "parameter", self.variables)
            elif item.text not in self.names.objects:
                self.faults.unknown(item, "object", self.names.objects)

    def _comparison(self, form: Form, wanted: bool) -> Condition:
        if len(form.items) != 3:
            self.faults.add(form, f"expected ({form.head} LEFT RIGHT)")
            return NOTHING
        if form.head == "=" and not form.forms and not self._is_number(form.items[1:]):
            self._terms(form)
            return Equality(form.words[1], form.words[2], wanted)
        relation = form.head if wanted else _NEGATED[form.head]
        left, right = (self.expression(item) for item in form.items[1:])
        return Comparison(relation, left, right, form.offset)

    def _is_number(self, items: Sequence[Word | Form]) -> bool:
        return any(
            isinstance(item, Word)
            and (NUMBER.match(item.text) is not None or item.text in self.names.functions)
            for item in items
        )

    # --- expressions -----------------------------------------------------------------------------

    def expression(self, item: Word | Form) -> Expression:
        """A number, a function's value, or arithmetic on them."""
        if isinstance(item, Word):
            return self._word(item)
        head = item.head
        if head in self.names.functions:
            return self.value(item)
        if head in ("total-time", "?duration") and len(item.items) == 1:
            return Special(head, item.offset)
        if head in _OPERATORS:
            count = len(item.items) - 1
            if count < 1 or (count == 1 and head != "-") or (count != 2 and head == "/"):
                self.faults.add(item, f"expected ({head} LEFT RIGHT)")
                return Number(Fraction(0))
            return Arithmetic(head, tuple(self.expression(part) for part in item.items[1:]))
        if head == "#t" or "#t" in item.words:
            self.faults.add(item, "continuous effects ('#t') are not supported")
        else:
            self._unknown(item, "function")
        return Number(Fraction(0))

    def _word(self, word: Word) -> Expression:
        if NUMBER.match(word.text):
            return Number(Fraction(word.text))
        if word.text == "?duration" and self.durative:
            return Special("?duration", word.offset)
        if word.text == "total-time":
            return Special("total-time", word.offset)
        if word.text == "#t":
            self.faults.add(word, "continuous effects ('#t') are not supported")
        elif self.names.functions.get(word.text) == 0:
            return Value(word.text, (), word.offset)
        else:
            self.faults.add(word, f"expected a number or (FUNCTION …), not {word.text!r}")
        return Number(Fraction(0))

    def value(self, form: Form) -> Value:
        """A function with its terms."""
        expected = self.names.functions.get(form.head)
        found = len(form.items) - 1
        if expected is None:
            self._unknown(form, "function")
        elif form.forms or found != expected:
            message = f"the function {form.head!r} takes {expected} objects, not {found}"
            self.faults.add(form, message)
        else:
            self._terms(form)
        return Value(form.head, tuple(form.words[1:]), form.offset)

    # --- effects ---------------------------------------------------------------------------------

    def effects(self, form: Form, at: str | None) -> Iterator[Effect]:
        """The effects of a form; `at` is None where each part says its own time."""
        head = form.head
        if not form.items:
            return
        timed = self.timed(form, "effect") if at is None else None
        if timed is not None:
            when, inner = timed
            if when == "all":
                self.faults.add(form, "an effect happens at start or at end")
            else:
                yield from self.effects(inner, when)
        elif head == "and":
            for item in form.items[1:]:
                if isinstance(item, Word):
                    self.faults.add(item, f"expected a list in parentheses, not {item.text!r}")
            for part in form.forms:
                yield from self.effects(part, at)
        elif head == "forall":
            yield from self._for_each(form, at)
        elif head == "when" and head not in self.names.predicates:
            yield from self._when(form, at)
        elif at is None:
            self._without_time(form, "an effect", "at start or at end")
        elif head == "not":
            if len(form.forms) != 1 or len(form.items) != 2:
                self.faults.add(form, "expected (not (PREDICATE …))")
            else:
                yield Change(at, self.literal(form.forms[0], False))
        elif head in _VERBS and head not in self.names.predicates:
            yield from self._numeric(form, at)
        else:
            yield Change(at, self.literal(form, True))

    def _for_each(self, form: Form, at: str | None) -> Iterator[Effect]:
        found = self._scope(form)
        if found is None:
            return
        variables, body = found
        outer = self.variables
        self.variables = outer | {name for name, _ in variables}
        inner = tuple(self.effects(body, at))
        self.variables = outer
        yield Conditional((), inner, variables, form.offset)

    def _when(self, form: Form, at: str | None) -> Iterator[Effect]:
        if len(form.forms) != 2 or len(form.items) != 3:
            self.faults.add(form, "expected (when CONDITION EFFECT)")
            return
        condition, effect = form.forms
        conditions: tuple[Timed, ...]
        if at is None:
            conditions = tuple(self.timed_conditions(condition))
        else:
            conditions = ((at, self.condition(condition)),)
        yield Conditional(conditions, tuple(self.effects(effect, at)), (), form.offset)

    def _numeric(self, form: Form, at: str) -> Iterator[Effect]:
        if not _VERBS[form.head]:
            self._refuse(form)
        elif len(form.items) != 3 or not isinstance(form.items[1], (Form, Word)):
            self.faults.add(form, f"expected ({form.head} (FUNCTION …) AMOUNT)")
        else:
            target = form.items[1]
            if isinstance(target, Word):
                target = Form([target], target.offset)
            amount = self.expression(form.items[2])
            yield NumericChange(at, form.head, self.value(target), amount, form.offset)

    # --- times -----------------------------------------------------------------------------------

    def timed_conditions(self, form: Form) -> Iterator[Timed]:
        """The parts of a condition of a durative action, each with its time."""
        if not form.items:
            return
        timed = self.timed(form, "condition")
        if timed is not None:
            yield timed[0], self.condition(timed[1])
        elif form.head == "and":
            for item in form.items[1:]:
                if isinstance(item, Word):
                    self.faults.add(item, f"expected a list in parentheses, not {item.text!r}")
                else:
                    yield from self.timed_conditions(item)
        elif form.head == "forall":
            found = self._scope(form)
            if found is not None:
                outer = self.variables
                self.variables = outer | {name for name, _ in found[0]}
                for when, part in self.timed_conditions(found[1]):
                    yield when, Every((part,), found[0])
                self.variables = outer
        else:
            self._without_time(form, "a condition", "at start, at end or over all")

    def timed(self, form: Form, what: str) -> tuple[str, Form] | None:
        """The time and the form inside (at start …), (at end …) or (over all …)."""
        when = form.words[1] if len(form.words) == 2 and len(form.items) == 3 else None
        if when in _TIMES.get(form.head, ()) and len(form.forms) == 1:
            return when, form.forms[0]
        return None

    def _without_time(self, form: Form, what: str, times: str) -> None:
        if form.head in _REFUSED and form.head not in self.names.predicates:
            self._refuse(form)
        else:
            self.faults.add(form, f"expected {what} with its time: {times}")

    # --- faults ----------------------------------------------------------------------------------

    def _unknown(self, form: Form, kind: str) -> None:
        if form.head in _REFUSED:
            self._refuse(form)
        elif not form.head:
            self.faults.add(form, f"expected the name of a {kind} here")
        else:
            known = self.names.predicates if kind == "predicate" else self.names.functions
            word = next(item for item in form.items if isinstance(item, Word))
            self.faults.unknown(Word(word.text, form.offset), kind, known)

    def _refuse(self, form: Form) -> None:
        self.faults.add(form, f"{_REFUSED[form.head]} ({form.head!r}) are not supported")


def after(section: Form, key: str) -> Word | Form | None:
    """The item after a keyword such as `:effect`; None if there is nothing."""
    for item, following in pairwise(section.items):
        if isinstance(item, Word) and item.text == key:
            return following
    return None
