"""Reads a PDDL domain and problem as schemas, and records all that is wrong, with its place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from irc.diagnostics import Findings, did_you_mean
from irc.frontends.importers.pddl.declarations import Declarations, Faults
from irc.frontends.importers.pddl.formulas import NOTHING, NUMBER, Formulas, after
from irc.frontends.importers.pddl.lifted import (
    Bound,
    Change,
    Condition,
    Fact,
    Lifted,
    Metric,
    NumericChange,
    Schema,
    Timed,
)
from irc.frontends.importers.pddl.sexpr import Form, Word

_ACTIONS = (":action", ":durative-action")
_DOMAIN_SECTIONS = (
    ":requirements",
    ":types",
    ":constants",
    ":predicates",
    ":functions",
    *_ACTIONS,
)
_PROBLEM_SECTIONS = (
    ":domain",
    ":requirements",
    ":objects",
    ":init",
    ":goal",
    ":metric",
    ":length",
)
_REQUIREMENTS = (
    ":strips",
    ":typing",
    ":negative-preconditions",
    ":disjunctive-preconditions",
    ":equality",
    ":existential-preconditions",
    ":universal-preconditions",
    ":quantified-preconditions",
    ":conditional-effects",
    ":fluents",
    ":numeric-fluents",
    ":object-fluents",
    ":adl",
    ":durative-actions",
    ":duration-inequalities",
    ":continuous-effects",
    ":derived-predicates",
    ":timed-initial-literals",
    ":timed-initial-fluents",
    ":preferences",
    ":constraints",
    ":action-costs",
    ":goal-utilities",
    ":time",
)
"""Requirements that exist. What a domain uses is judged where it is used."""

_OF_PROBLEM = "object {0!r} is of the problem; PDDL wants it in :constants of the domain"
_AGAIN = "object {0!r} is declared twice, in :constants and in :objects; it is one object"


class Reader:
    """Reads both files. `lenient` takes what models write and PDDL does not allow."""

    def __init__(self, domain: Findings, problem: Findings, *, lenient: bool = False) -> None:
        self.domain = Faults(domain)
        self.problem = Faults(problem)
        self.lenient = lenient
        self.names = Declarations()
        self._later: frozenset[str] = frozenset()

    def read(self, domain: Form | None, problem: Form | None) -> Lifted:
        """The domain and the problem; of no use where a fault was recorded."""
        name = title = None
        schemas: list[Schema] = []
        if domain is not None:
            name = self._define(domain, "domain", _DOMAIN_SECTIONS, self.domain)
            self._declare(domain)
        if problem is not None:
            title = self._define(problem, "problem", _PROBLEM_SECTIONS, self.problem)
            self._add_objects(problem)
        if domain is not None:
            schemas = [self._schema(s) for s in domain.forms[1:] if s.head in _ACTIONS]
            self._once(schemas, domain)
        world = _World()
        goal: Condition = NOTHING
        metric = None
        if problem is not None and domain is not None:
            goal, metric = self._problem(problem, name, world)
        return Lifted(
            name or "",
            title or "",
            tuple(schemas),
            frozenset(world.facts),
            world.numbers,
            tuple(world.timed),
            goal,
            metric,
            frozenset(_changing(schemas)) | {fact[0] for _, fact, _ in world.timed},
        )

    # --- sections --------------------------------------------------------------------------------

    def _define(self, form: Form, kind: str, sections: Sequence[str], faults: Faults) -> str | None:
        first = form.forms[0] if form.forms else form
        if form.head != "define" or first.head != kind or len(first.words) != 2:
            faults.add(form, f"expected (define ({kind} NAME) …)")
            return None
        for item in form.items[1:]:
            if isinstance(item, Word):
                faults.add(item, f"expected a section in parentheses, not {item.text!r}")
        for section in form.forms[1:]:
            if section.head not in sections:
                known = f"this importer supports {', '.join(sections)}"
                hint = did_you_mean(section.head, sections) or known
                faults.add(section, f"the section {section.head!r} is not supported", hint)
            elif section.head == ":requirements":
                self._requirements(section, faults)
        return first.words[1]

    def _requirements(self, section: Form, faults: Faults) -> None:
        for item in section.items[1:]:
            if isinstance(item, Form) or item.text not in _REQUIREMENTS:
                text = "(" if isinstance(item, Form) else item.text
                hint = did_you_mean(text, _REQUIREMENTS)
                faults.add(item, f"there is no requirement {text!r}", hint)

    def _declare(self, domain: Form) -> None:
        """Reads the declarations of a domain, in whatever order they stand."""
        by_head: dict[str, list[Form]] = {}
        for section in domain.forms[1:]:
            by_head.setdefault(section.head, []).append(section)
        for section in by_head.get(":types", ()):
            self.names.add_types(section, self.domain)
        for section in by_head.get(":constants", ()):
            self.names.add_objects(section, self.domain)
        for head in (":predicates", ":functions"):
            for section in by_head.get(head, ()):
                self.names.add_signatures(section, self.domain)

    def _add_objects(self, problem: Form) -> None:
        constants = frozenset(self.names.objects)
        for section in problem.forms[1:]:
            if section.head == ":objects":
                self.names.add_objects(section, self.problem, again=_AGAIN)
        self._later = frozenset(self.names.objects) - constants

    def _once(self, schemas: Sequence[Schema], domain: Form) -> None:
        seen: set[str] = set()
        sections = [s for s in domain.forms[1:] if s.head in _ACTIONS]
        for schema, section in zip(schemas, sections, strict=True):
            if schema.name in seen:
                self.domain.add(section, f"there are two actions {schema.name!r}")
            seen.add(schema.name)

    # --- actions ---------------------------------------------------------------------------------

    def _schema(self, section: Form) -> Schema:
        durative = section.head == ":durative-action"
        formulas = _InDomain(self, durative=durative)
        name = section.words[1] if len(section.words) > 1 else ""
        if not name or name.startswith(":"):
            self.domain.add(section, f"expected ({section.head} NAME …)")
        keys = (":parameters", ":precondition", ":condition", ":duration", ":effect")
        for item in section.items[2:]:
            if isinstance(item, Word) and item.text not in keys:
                hint = did_you_mean(item.text, keys)
                self.domain.add(item, f"an action has no {item.text!r}", hint)
        parameters = self._parameters(section, formulas)
        formulas.variables = {variable for variable, _ in parameters}
        conditions: list[Timed] = []
        for key in (":precondition", ":condition"):
            condition = self._form(section, key)
            if condition is not None and durative:
                conditions += formulas.timed_conditions(condition)
            elif condition is not None:
                conditions.append(("start", formulas.condition(condition)))
        effect = self._form(section, ":effect")
        effects = formulas.effects(effect, None if durative else "start") if effect else ()
        return Schema(
            name,
            parameters,
            tuple(conditions),
            tuple(effects),
            tuple(self._duration(section, formulas)) if durative else None,
            section.offset,
        )

    def _form(self, section: Form, key: str) -> Form | None:
        found = after(section, key)
        if isinstance(found, Word):
            self.domain.add(found, f"expected a list in parentheses after {key!r}")
            return None
        return found

    def _parameters(
        self, section: Form, formulas: Formulas
    ) -> tuple[tuple[str, tuple[str, ...]], ...]:
        parameters = self._form(section, ":parameters")
        if parameters is not None:
            return formulas.parameters(parameters.items)
        message = "an action needs :parameters (…), which may be empty"
        if self.lenient:
            self.domain.warn(section, f"{message}; read as :parameters ()")
        else:
            self.domain.add(section, message)
        return ()

    def _duration(self, section: Form, formulas: Formulas) -> Iterator[Bound]:
        duration = self._form(section, ":duration")
        if duration is None:
            self.domain.add(section, "a durative action needs a :duration")
            return
        for part in _conjuncts(duration):
            timed = formulas.timed(part, "condition")
            if timed is not None and timed[0] == "start":
                part = timed[1]
            left, right = part.items[1:] if len(part.items) == 3 else (None, None)
            if part.head in ("at", "over"):
                self.domain.add(part, "a duration constraint with a time is not supported")
            elif part.head not in ("=", "<=", ">=") or left is None or right is None:
                self.domain.add(part, "expected (= ?duration …), (<= …) or (>= …)")
            elif isinstance(left, Word) and left.text == "?duration":
                yield Bound(part.head, formulas.expression(right))
            elif isinstance(right, Word) and right.text == "?duration":
                relation = {"<=": ">=", ">=": "<="}.get(part.head, part.head)
                yield Bound(relation, formulas.expression(left))
            else:
                self.domain.add(part, "expected (= ?duration …), (<= …) or (>= …)")

    # --- the problem -----------------------------------------------------------------------------

    def _problem(
        self, form: Form, domain: str | None, world: _World
    ) -> tuple[Condition, Metric | None]:
        sections = {section.head: section for section in form.forms[1:]}
        for head in (":domain", ":init", ":goal"):
            if head not in sections:
                self.problem.add(form, f"the problem has no {head}")
        named = sections.get(":domain")
        if named is not None and domain is not None and named.words[1:] != [domain]:
            found = " ".join(named.words[1:])
            message = f"this is a problem of {found!r}, not of {domain!r}"
            if self.lenient:
                self.problem.warn(named, message)
            else:
                self.problem.add(named, message)
        formulas = Formulas(self.names, self.problem)
        for section in form.forms[1:]:
            if section.head == ":init":
                self._init(section, formulas, world)
        goals = sections.get(":goal")
        goal: Condition = NOTHING
        if goals is not None and goals.forms:
            goal = formulas.condition(goals.forms[0])
        if goals is not None and len(goals.items) != 2:
            self.problem.add(goals, "expected one condition: (:goal CONDITION)")
        metric = sections.get(":metric")
        return goal, None if metric is None else self._metric(metric, formulas)

    def _init(self, section: Form, formulas: Formulas, world: _World) -> None:
        for item in section.items[1:]:
            if isinstance(item, Word):
                self.problem.add(item, f"expected a fact in parentheses, not {item.text!r}")
        for fact in section.forms:
            if fact.head == "and" and "and" not in self.names.predicates:
                self._init(fact, formulas, world)
            elif fact.head == "=":
                self._number(fact, formulas, world)
            elif (
                fact.head == "at"
                and len(fact.items) == 3
                and len(fact.words) == 2
                and NUMBER.match(fact.words[1])
                and fact.forms
            ):
                self._timed(Fraction(fact.words[1]), fact.forms[0], formulas, world)
            elif (found := self._fact(fact, formulas)) is not None and found[1]:
                world.facts.add(found[0])

    def _number(self, fact: Form, formulas: Formulas, world: _World) -> None:
        if len(fact.items) != 3:
            self.problem.add(fact, "expected (= (FUNCTION …) NUMBER)")
            return
        target, number = fact.items[1:]
        if isinstance(target, Word) and target.text in self.names.functions:
            target = Form([target], target.offset)
        if not (
            isinstance(target, Form) and isinstance(number, Word) and NUMBER.match(number.text)
        ):
            self.problem.add(fact, "expected (= (FUNCTION …) NUMBER)")
            return
        world.numbers[formulas.value(target).fact({})] = Fraction(number.text)

    def _timed(self, time: Fraction, form: Form, formulas: Formulas, world: _World) -> None:
        if form.head in ("=", "assign", "increase", "decrease"):
            self.problem.add(form, "timed numeric effects are not supported")
            return
        found = self._fact(form, formulas)
        if time < 0:
            self.problem.add(form, f"a timed initial literal before 0: at {time}")
        elif found is not None:
            world.timed.append((time, *found))

    def _fact(self, form: Form, formulas: Formulas) -> tuple[Fact, bool] | None:
        value = form.head != "not" or len(form.forms) != 1
        literal = formulas.literal(form if value else form.forms[0], value)
        return literal.fact({}), literal.value

    def _metric(self, section: Form, formulas: Formulas) -> Metric | None:
        if len(section.items) != 3 or section.words[1:2] not in (["minimize"], ["maximize"]):
            self.problem.add(section, "expected (:metric minimize EXPRESSION)")
            return None
        item = section.items[2]
        return Metric(
            section.words[1] == "maximize",
            formulas.expression(item),
            section.offset,
        )


class _World:
    """The facts and numbers at first, and the timed literals."""

    def __init__(self) -> None:
        self.facts: set[Fact] = set()
        self.numbers: dict[Fact, Fraction] = {}
        self.timed: list[tuple[Fraction, Fact, bool]] = []


class _InDomain(Formulas):
    """Formulas of the domain, which should only name objects in `:constants`."""

    def __init__(self, reader: Reader, *, durative: bool) -> None:
        super().__init__(reader.names, reader.domain, durative=durative)
        self.reader = reader

    def _terms(self, form: Form) -> None:
        super()._terms(form)
        for item in form.items[1:]:
            if isinstance(item, Word) and item.text in self.reader._later:
                if self.reader.lenient:
                    self.faults.warn(item, _OF_PROBLEM.format(item.text))
                else:
                    self.faults.add(item, _OF_PROBLEM.format(item.text))


def _changing(schemas: Sequence[Schema]) -> Iterator[str]:
    for schema in schemas:
        for change in schema.changes():
            if isinstance(change, NumericChange):
                yield change.target.function
            elif isinstance(change, Change):
                yield change.literal.predicate


def _conjuncts(form: Form) -> list[Form]:
    """The parts of a conjunction, or the form by itself."""
    if not form.items:
        return []
    if form.head != "and":
        return [form]
    return [part for inner in form.forms for part in _conjuncts(inner)]
