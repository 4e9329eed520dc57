"""Checks that a PDDL text uses only elements that the importer supports.

unified-planning's reader does not keep places, so this module refuses other elements in the text
itself, with their names and places, before the reader sees them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise

from irc.diagnostics import Code, Findings, did_you_mean
from irc.frontends.importers.pddl.sexpr import Form, Word

REQUIREMENTS = (
    ":strips",
    ":typing",
    ":negative-preconditions",
    ":equality",
    ":durative-actions",
    ":duration-inequalities",
    ":fluents",
    ":numeric-fluents",
    ":timed-initial-literals",
)
_DOMAIN_SECTIONS = (
    ":requirements",
    ":types",
    ":constants",
    ":predicates",
    ":functions",
    ":action",
    ":durative-action",
)
_PROBLEM_SECTIONS = (":domain", ":requirements", ":objects", ":init", ":goal", ":metric")

_REFUSED: Mapping[str, str] = {
    "or": "disjunctive conditions",
    "imply": "disjunctive conditions",
    "forall": "quantified conditions and effects",
    "exists": "quantified conditions",
    "when": "conditional effects",
    "preference": "preferences",
    "increase": "numeric effects",
    "decrease": "numeric effects",
    "assign": "numeric effects",
    "scale-up": "numeric effects",
    "scale-down": "numeric effects",
    "<": "numeric conditions",
    ">": "numeric conditions",
    "<=": "numeric conditions",
    ">=": "numeric conditions",
    "always": "trajectory constraints",
    "sometime": "trajectory constraints",
    "within": "trajectory constraints",
    "either": "types of the kind (either …)",
}
_NUMBER = re.compile(r"\d+(?:\.\d+)?\Z", re.ASCII)
_TIMED = {"at": ("start", "end"), "over": ("all",)}


class Scope:
    """Checks a domain and a problem, and records unsupported elements."""

    def __init__(self, domain: Findings, problem: Findings) -> None:
        self.domain = domain
        self.problem = problem
        self._arity: dict[str, int] = {}
        self._functions: dict[str, int] = {}
        self._types = {"object"}
        self._objects: set[str] = set()
        self._variables: set[str] = set()

    def check_domain(self, form: Form) -> str | None:
        """Records unsupported elements of a domain; returns its name, if it has one."""
        name = self._define(form, "domain", _DOMAIN_SECTIONS, self.domain)
        for section in form.forms[1:]:
            if section.head in (":predicates", ":functions"):
                declared = self._arity if section.head == ":predicates" else self._functions
                for signature in section.forms:
                    declared[signature.head] = sum(w.startswith("?") for w in signature.words)
            elif section.head == ":types":
                self._types |= set(section.words[1:]) - {"-"}
            elif section.head == ":constants":
                self._objects |= set(_declared(section.items[1:]))
        for section in form.forms[1:]:
            if section.head == ":requirements":
                self._requirements(section, self.domain)
            elif section.head == ":action":
                self._action(section)
            elif section.head == ":durative-action":
                self._durative_action(section)
            elif section.head == ":constants":
                self._known_types(section, self.domain)
            elif section.head in (":predicates", ":functions"):
                for signature in section.forms:
                    self._known_types(signature, self.domain)
            elif section.head == ":types":
                self._no_either(section, self.domain)
        return name

    def check_problem(self, form: Form, domain: str | None) -> None:
        """Records unsupported elements of a problem of the domain with this name."""
        self._define(form, "problem", _PROBLEM_SECTIONS, self.problem)
        sections = {section.head: section for section in form.forms[1:]}
        for head in (":domain", ":init", ":goal"):
            if head not in sections:
                self._fault(self.problem, form, f"the problem has no {head}")
        named = sections.get(":domain")
        if named is not None and domain is not None and named.words[1:] != [domain]:
            found = " ".join(named.words[1:])
            self._fault(self.problem, named, f"this is a problem of {found!r}, not of {domain!r}")
        self._variables = set()
        if ":objects" in sections:
            self._objects |= set(_declared(sections[":objects"].items[1:]))
        for section in form.forms[1:]:
            if section.head == ":requirements":
                self._requirements(section, self.problem)
            elif section.head == ":init":
                self._init(section)
            elif section.head == ":goal":
                for goal in section.forms:
                    self._condition(goal, self.problem)
            elif section.head == ":metric":
                self._metric(section)
            elif section.head == ":objects":
                self._known_types(section, self.problem)

    # --- sections --------------------------------------------------------------------------------

    def _define(
        self, form: Form, kind: str, sections: Sequence[str], findings: Findings
    ) -> str | None:
        first = form.forms[0] if form.forms else form
        if form.head != "define" or first.head != kind or len(first.words) != 2:
            self._fault(findings, form, f"expected (define ({kind} NAME) …)")
            return None
        for section in form.forms[1:]:
            if section.head not in sections:
                known = f"this importer supports {', '.join(sections)}"
                hint = did_you_mean(section.head, sections) or known
                self._fault(
                    findings, section, f"the section {section.head!r} is not supported", hint
                )
        return first.words[1]

    def _requirements(self, section: Form, findings: Findings) -> None:
        for item in section.items[1:]:
            if isinstance(item, Word) and item.text not in REQUIREMENTS:
                known = f"this importer supports {', '.join(REQUIREMENTS)}"
                hint = did_you_mean(item.text, REQUIREMENTS) or known
                message = f"the requirement {item.text!r} is not supported"
                findings.add(Code.NOT_AN_IMPORT, message, offset=item.offset, hint=hint)

    def _no_either(self, section: Form, findings: Findings) -> None:
        for form in section.all_forms():
            if form.head == "either":
                self._fault(findings, form, "types of the kind (either …) are not supported")

    def _action(self, section: Form) -> None:
        self._parameters(section)
        for condition in _given(section.after(":precondition")):
            self._condition(condition, self.domain)
        for effect in _given(section.after(":effect")):
            self._effect(effect)

    def _durative_action(self, section: Form) -> None:
        self._parameters(section)
        duration = section.after(":duration")
        if duration is None:
            self._fault(self.domain, section, "a durative action needs a :duration")
        else:
            self._duration(duration)
        for part in _conjuncts(section.after(":condition")):
            inner = self._timed(part, "condition")
            if inner is not None:
                self._condition(inner, self.domain)
        for part in _conjuncts(section.after(":effect")):
            inner = self._timed(part, "effect")
            if inner is not None:
                self._effect(inner)

    def _parameters(self, section: Form) -> None:
        parameters = section.after(":parameters")
        if parameters is None:
            self._fault(self.domain, section, "an action needs :parameters (…), which may be empty")
        else:
            self._variables = set(_declared(parameters.items))
            self._known_types(parameters, self.domain)

    def _known_types(self, declarations: Form, findings: Findings) -> None:
        """Records undeclared types in a typed list."""
        self._no_either(declarations, findings)
        for item, following in pairwise(declarations.items):
            if isinstance(item, Word) and item.text == "-" and isinstance(following, Word):
                self._known(following, self._types, "type", findings)

    def _known(self, word: Word, known: set[str], what: str, findings: Findings) -> None:
        if word.text not in known:
            hint = did_you_mean(word.text, sorted(known))
            message = f"there is no {what} {word.text!r}"
            findings.add(Code.NOT_AN_IMPORT, message, offset=word.offset, hint=hint)

    def _timed(self, part: Form, what: str) -> Form | None:
        """The form inside (at start …), (at end …) or (over all …)."""
        when = part.words[1] if len(part.words) == 2 and len(part.items) == 3 else None
        if when in _TIMED.get(part.head, ()) and len(part.forms) == 1:
            if part.head == "over" and what == "effect":
                self._fault(self.domain, part, "an effect happens at start or at end")
                return None
            return part.forms[0]
        if part.head in _REFUSED:
            self._refuse(part, self.domain)
        else:
            times = "at start, at end or over all" if what == "condition" else "at start or at end"
            self._fault(self.domain, part, f"expected a {what} with its time: {times}")
        return None

    def _duration(self, duration: Form) -> None:
        for part in _conjuncts(duration):
            if part.head in ("at", "over"):
                self._fault(self.domain, part, "a duration constraint with a time is not supported")
            elif part.head not in ("=", "<=", ">=") or "?duration" not in part.words:
                self._fault(self.domain, part, "expected (= ?duration …), (<= …) or (>= …)")
        bounds = {part.head for part in _conjuncts(duration)}
        if not bounds <= {"="} and not bounds >= {"<=", ">="}:
            self._fault(self.domain, duration, "a range of durations needs both of its ends")

    def _condition(self, condition: Form, findings: Findings) -> None:
        if condition.head in ("and", "not"):
            for part in condition.forms:
                self._condition(part, findings)
        elif condition.head == "=":
            if condition.forms:
                self._fault(findings, condition, "numeric conditions ('=') are not supported")
            else:
                self._terms(condition, findings)
        else:
            self._literal(condition, findings)

    def _effect(self, effect: Form) -> None:
        if effect.head in ("and", "not"):
            for part in effect.forms:
                self._effect(part)
        else:
            self._literal(effect, self.domain)

    def _literal(self, form: Form, findings: Findings) -> None:
        if form.head in _REFUSED and form.head not in self._arity:
            self._refuse(form, findings)
            return
        if not form.items:
            return
        if form.head not in self._arity:
            hint = did_you_mean(form.head, self._arity)
            self._fault(findings, form, f"there is no predicate {form.head!r}", hint)
            return
        expected = self._arity[form.head]
        if form.forms or len(form.items) - 1 != expected:
            found = len(form.items) - 1
            message = f"the predicate {form.head!r} takes {expected} objects, not {found}"
            self._fault(findings, form, message)
            return
        self._terms(form, findings)

    def _terms(self, form: Form, findings: Findings) -> None:
        """Records undeclared parameters and objects of a literal or an equality."""
        for item in form.items[1:]:
            if isinstance(item, Word) and item.text.startswith("?"):
                self._known(item, self._variables, "parameter", findings)
            elif isinstance(item, Word):
                self._known(item, self._objects, "object", findings)

    def _init(self, section: Form) -> None:
        for fact in section.forms:
            words = fact.words
            if fact.head == "=":
                if len(fact.forms) != 1 or not _NUMBER.match(words[-1]):
                    self._fault(self.problem, fact, "expected (= (FUNCTION …) NUMBER)")
                else:
                    self._function(fact.forms[0])
            elif fact.head == "at" and len(words) == 2 and _NUMBER.match(words[1]) and fact.forms:
                self._initial_literal(fact.forms[0])
            else:
                self._initial_literal(fact)

    def _function(self, form: Form) -> None:
        found = len(form.items) - 1
        if form.head not in self._functions:
            hint = did_you_mean(form.head, self._functions)
            self._fault(self.problem, form, f"there is no function {form.head!r}", hint)
        elif form.forms or found != self._functions[form.head]:
            message = f"the function {form.head!r} takes {self._functions[form.head]} objects"
            self._fault(self.problem, form, f"{message}, not {found}")
        else:
            self._terms(form, self.problem)

    def _initial_literal(self, literal: Form) -> None:
        if literal.head == "=":
            self._fault(self.problem, literal, "timed numeric effects are not supported")
        elif literal.head == "not" and len(literal.forms) == 1:
            self._literal(literal.forms[0], self.problem)
        else:
            self._literal(literal, self.problem)

    def _metric(self, section: Form) -> None:
        wanted = section.forms[0].words if section.forms else section.words[2:]
        if section.words[1:2] != ["minimize"] or wanted != ["total-time"]:
            message = "only the metric 'minimize (total-time)' is supported"
            self._fault(self.problem, section, message)

    # --- words -----------------------------------------------------------------------------------

    def _refuse(self, form: Form, findings: Findings) -> None:
        self._fault(findings, form, f"{_REFUSED[form.head]} ({form.head!r}) are not supported")

    def _fault(self, findings: Findings, form: Form, message: str, hint: str | None = None) -> None:
        findings.add(Code.NOT_AN_IMPORT, message, offset=form.offset, hint=hint)


def _declared(items: Sequence[Word | Form]) -> list[str]:
    """The names in a typed list such as `?a ?b - place ?c`, without the types."""
    words = [item.text for item in items if isinstance(item, Word)]
    return [
        word
        for before, word in zip(["", *words], words, strict=False)
        if word != "-" and before != "-"
    ]


def _given(form: Form | None) -> list[Form]:
    return [] if form is None or not form.items else [form]


def _conjuncts(form: Form | None) -> list[Form]:
    """The parts of a conjunction, or the form by itself."""
    if form is None or not form.items:
        return []
    if form.head != "and":
        return [form]
    return [part for inner in form.forms for part in _conjuncts(inner)]
