"""Model-written PDDL as its actions, initial facts and goal, read however it is put together.

It is not a PDDL reader: it neither checks nor refuses. Parentheses that are never closed end with
the text, one too many is passed over, a section may stand in parentheses of its own, and of a
section that stands there twice both hold.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

Form = list["Form | str"]
Literal = tuple[str, ...]

_COMMENT = re.compile(r";[^\n]*")
_TOKEN = re.compile(r"[()]|[^\s();]+")
_NUMBER = re.compile(r"\d+(?:\.\d+)?")
_TIMES = ("start", "end", "all")
_NOT_LITERALS = frozenset(
    [
        *("at", "over", "forall", "exists", "when", "or", "imply"),
        *("increase", "decrease", "assign", "=", "<", ">", "<=", ">="),
    ]
)


@dataclass(frozen=True)
class Schema:
    """An action: its positive conditions, the literals that it adds, and its duration."""

    name: str
    conditions: tuple[Literal, ...]
    adds: tuple[Literal, ...]
    duration: float | None


@dataclass(frozen=True)
class PddlTask:
    """The actions of a domain, and the initial facts and positive goals of a problem."""

    schemas: tuple[Schema, ...]
    initial: frozenset[Literal]
    goals: tuple[Literal, ...]


def is_ground(literal: Literal) -> bool:
    """Whether it has no variable."""
    return not any(word.startswith("?") for word in literal)


def read_pddl_task(domain: str, problem: str) -> PddlTask:
    """The actions, facts and goals of a domain and a problem."""
    sections = list(_sections(_forms(domain)))
    schemas = (_schema(form) for form in sections if form[0] in (":durative-action", ":action"))
    return PddlTask(tuple(schemas), *_problem(_forms(problem)))


def _problem(forms: list[Form]) -> tuple[frozenset[Literal], tuple[Literal, ...]]:
    initial: set[Literal] = set()
    goals: list[Literal] = []
    for form in _sections(forms):
        if form[0] == ":init":
            flat = (_flat(item) for item in form[1:])
            initial.update(literal for literal in flat if literal)
        elif form[0] == ":goal":
            goals += [literal for item in form[1:] for literal in _positive(item)]
    return frozenset(initial), tuple(goals)


def _forms(text: str) -> list[Form]:
    """The lists of a text, one inside another."""
    root: Form = []
    stack = [root]
    for token in _TOKEN.findall(_COMMENT.sub("", text)):
        if token == "(":
            form: Form = []
            stack[-1].append(form)
            stack.append(form)
        elif token != ")":
            stack[-1].append(token.lower())
        elif len(stack) > 1:
            stack.pop()
    return [item for item in root if isinstance(item, list)]


def _sections(forms: Iterable[Form]) -> Iterator[Form]:
    """The lists at the top, and those directly in one: `(define …)` may be missing."""
    for form in forms:
        for item in (form, *form):
            if isinstance(item, list) and item:
                yield item


def _schema(form: Form) -> Schema:
    name = form[1] if len(form) > 1 else ""
    conditions = [*_after(form, ":condition"), *_after(form, ":precondition")]
    return Schema(
        name if isinstance(name, str) else "",
        tuple(literal for item in conditions for literal in _positive(item)),
        tuple(literal for item in _after(form, ":effect") for literal in _positive(item)),
        _last_number(_after(form, ":duration")),
    )


def _after(form: Form, key: str) -> Form:
    """The items that follow a keyword, be it in the list itself or in one of its own."""
    plain = [following for item, following in pairwise(form) if item == key]
    wrapped = [
        item[1] for item in form if isinstance(item, list) and len(item) > 1 and item[0] == key
    ]
    return [*plain, *wrapped]


def _positive(form: Form | str, negated: bool = False) -> Iterator[Literal]:
    """The literals of a condition or effect that are not negated."""
    if isinstance(form, str) or not form:
        return
    head = form[0]
    if head == "and":
        for item in form[1:]:
            yield from _positive(item, negated)
    elif head == "not" and len(form) == 2:
        yield from _positive(form[1], not negated)
    elif head in ("at", "over") and len(form) == 3 and form[1] in _TIMES:
        yield from _positive(form[2], negated)
    elif not negated and head not in _NOT_LITERALS and (literal := _flat(form)):
        yield literal


def _flat(form: Form | str) -> Literal | None:
    """The words of a list of words; None for anything else."""
    if isinstance(form, str):
        return None
    words = tuple(word for word in form if isinstance(word, str))
    return words if len(words) == len(form) else None


def _last_number(form: Form | str) -> float | None:
    if isinstance(form, str):
        return float(form) if _NUMBER.fullmatch(form) else None
    found = [value for item in form if (value := _last_number(item)) is not None]
    return found[-1] if found else None
