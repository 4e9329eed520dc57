"""Reads the most common statements without the grammar, exactly as the grammar does.

These are `boil eggs 4 min on stove by robots after heat water` and `a, b -> c -> d`, in plain
words. The grammar reads all other statements; a test compares the two.
"""

from __future__ import annotations

import re
from itertools import pairwise

from irc.frontends.dsl.build import Builder, PoolUse
from irc.frontends.dsl.document_parts import Element, Sink
from irc.frontends.dsl.lexer import CLAUSE_WORDS, PHRASES, STATEMENT_WORDS
from irc.frontends.dsl.lines import Statement
from irc.model.quantities import MONTH_NAMES, UNIT_SECONDS

_LONGEST = 2000
_WORD = r"(?!P[0-9T]|(?:on|by|after)(?![A-Za-z0-9_]))[A-Za-z_][A-Za-z0-9_]*"
_NAME = rf"{_WORD}(?: {_WORD})*(?: [0-9]+)?"
_NAMES = rf"{_NAME}(?:, {_NAME})*"
_UNIT = "|".join(sorted(u for u in {*UNIT_SECONDS, *MONTH_NAMES} if u.isascii()))
_ACTION = re.compile(
    rf"({_NAME}) +([0-9]{{1,18}}(?: ?(?:{_UNIT}))?)"
    rf"(?: +on ({_NAMES}))?(?: +by ({_NAMES}))?(?: +after ({_NAMES}))?\Z"
)
_ORDER = re.compile(rf"{_NAMES}(?: -> {_NAMES})+\Z")
_SPECIAL = CLAUSE_WORDS | {word for phrase in PHRASES for word in phrase}


def plain_statement(statement: Statement, text: str, sink: Sink, builder: Builder) -> bool:
    """Reads a statement if it is of the plainest kind; returns whether it is."""
    if statement.body is not None or statement.tokens is not None or len(statement.spans) > 1:
        return False
    begin, end = statement.spans[0]
    if end - begin > _LONGEST:
        return False
    # A text in quotes is never plain, so a # always begins a comment.
    line = text[begin:end].partition("#")[0].rstrip(" \t\r")
    if line.split(" ", 1)[0] in STATEMENT_WORDS:
        return False
    if _ORDER.match(line):
        return _order(line, statement, sink, builder)
    found = _ACTION.match(line)
    return found is not None and _action(found, sink, builder)


def _split(listed: str) -> list[str] | None:
    """The names of a list; None if a word of a name may have a meaning of its own."""
    if not _SPECIAL.isdisjoint(listed.replace(",", "").split(" ")):
        return None
    return listed.split(", ")


def _action(found: re.Match[str], sink: Sink, builder: Builder) -> bool:
    name, length, on, by, after = found.groups()
    names = [_split(name), *([] if part is None else _split(part) for part in (on, by, after))]
    if None in names:
        return False
    at = sink.next("actions")
    arcs = [{"before": before, "after": name} for before in names[3] or ()]
    if builder.places is not None and not _unwanted(builder, sink, at, arcs):
        return False
    action: Element = {"id": name, "duration": int(length) if length.isdigit() else length}
    uses = [{"resource": r} for listed in names[1:3] for r in listed or ()]
    if uses:
        action["uses"] = uses
        builder.uses += [PoolUse(use, (*at, "uses", i)) for i, use in enumerate(uses)]
    sink.arrays["actions"].append(action)
    sink.arrays["precedence"] += arcs
    return True


def _order(line: str, statement: Statement, sink: Sink, builder: Builder) -> bool:
    steps = [_split(step) for step in line.split(" -> ")]
    sides = [step for step in steps if step is not None]
    if len(sides) < len(steps):
        return False
    arcs: list[Element] = [
        {"before": before, "after": after}
        for sources, targets in pairwise(sides)
        for before in sources
        for after in targets
    ]
    if builder.places is not None and not _unwanted(builder, sink, None, arcs):
        return False
    for sources, targets in pairwise(sides):
        if (count := len(sources) * len(targets)) > 1:
            builder.expansion.take(count, "this order", statement.start, statement.end)
    sink.arrays["precedence"] += arcs
    return True


def _unwanted(
    builder: Builder, sink: Sink, action: tuple[str | int, ...] | None, arcs: list[Element]
) -> bool:
    """Whether the places of the statement's parts are not wanted."""
    places = builder.places
    if places is None or places.elements is None:
        return places is None
    if action in places.elements:
        return False
    first = len(sink.arrays["precedence"])
    return all(("precedence", first + i) not in places.elements for i in range(len(arcs)))
