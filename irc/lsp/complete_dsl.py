"""Completion in the DSL: words that the grammar allows, and names that the task declares.

What stands before the cursor is given to the parser of statements, so that what is offered is
what can be read there; the rest of the text may be broken as it likes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import get_args

from irc.frontends.dsl.grammar import accepted
from irc.frontends.dsl.lexer import (
    CHANGE_PHRASES,
    CLAUSE_WORDS,
    PHRASES,
    RULES,
    STATEMENT_WORDS,
    Lexeme,
    classified,
    quoted,
)
from irc.frontends.dsl.written import name as written_name
from irc.lsp.dsl import Cursor, cursor_at, pools
from irc.lsp.mentions import Kind
from irc.lsp.names import Names
from irc.lsp.suggestions import MOST_OFFERED, Suggestion
from irc.model.parts import ObjectiveName
from irc.model.quantities import UNIT_SECONDS

KEYWORDS = {
    **{word.upper(): word for word in STATEMENT_WORDS | CLAUSE_WORDS | {"in"}},
    **{kind: " ".join(phrase) for phrase, kind in PHRASES.items()},
    **{kind: " ".join(phrase) for phrase, kind in RULES.items()},
    **{kind: " ".join(phrase) for phrase, kind in CHANGE_PHRASES.items()},
}
"""Every word of the grammar, by the kind of its token."""

_LONGEST_NAME = 8
"""At most this many words before the cursor can be the beginning of a typed name."""

_UNITS = tuple(unit for unit in ("s", "min", "h", "day", "week", "month") if unit in UNIT_SECONDS)


@dataclass(frozen=True, slots=True)
class _Wanted:
    """The kinds of names that can stand at a place."""

    kinds: tuple[Kind, ...] = ()
    owner: str | None = None
    words: tuple[str, ...] = ()


_NOTHING = _Wanted()
_ACTIONS = _Wanted((Kind.ACTION,))
_RESOURCES = _Wanted((Kind.RESOURCE,))
_VARIABLES = _Wanted((Kind.VARIABLE,))
_GROUPS = _Wanted((Kind.GROUP,))
_GOALS = _Wanted((Kind.ACTION, Kind.VARIABLE))

_OPENING = {
    **dict.fromkeys(("ON", "BY", "CONSUMES", "PRODUCES", "SET_CAPACITY"), _RESOURCES),
    **dict.fromkeys(("AFTER", "ENDS_AFTER", "ARROW", "START_OF", "END_OF", "CANCEL"), _ACTIONS),
    **dict.fromkeys(("OBSERVE", "SET_DURATION", "SET_RELEASE", "REMOVE"), _ACTIONS),
    **dict.fromkeys(("SET_DEADLINE_OF_ACTION",), _ACTIONS),
    **dict.fromkeys(("CANCEL_GROUP", "SET_DEADLINE_OF_GROUP", "OF_GROUP"), _GROUPS),
    **dict.fromkeys(("NEEDS", "SETS", "SET_STATE"), _VARIABLES),
    **dict.fromkeys(("GOAL", "SET_GOALS"), _GOALS),
    **dict.fromkeys({*RULES.values()} - {"SAME_ORDER", "SELECT"}, _ACTIONS),
    **dict.fromkeys(("OF", "IF", "THEN", "JOBS"), _ACTIONS),
    "SAME_ORDER": _RESOURCES,
    "UNIT": _Wanted(words=_UNITS),
}
"""The kinds of names that follow a word."""

_FACTS = frozenset(("NEEDS", "SETS", "SET_STATE", "GOAL", "SET_GOALS"))
_PASSED = frozenset(
    ("WORD", "INT", "STRING", "TIME", "TIMES", "OPEN", "OR", "PLUS", "MINUS", "DOTS")
) | {"AT_START", "AT_END", "THROUGHOUT"}
"""The tokens that may stand between a word and its names."""


@dataclass(slots=True)
class _Offers:
    """Collects suggestions, each text once: the one that replaces most of the typed text."""

    end: int
    found: dict[tuple[str, str], Suggestion] = field(default_factory=dict)

    def add(self, text: str, kind: str, start: int, label: str | None = None) -> None:
        if len(self.found) < MOST_OFFERED:
            offered = Suggestion(label or text, start, self.end, text, kind, text)
            self.found[text, kind] = offered


def complete_dsl(text: str, offset: int, names: Names, path: Path | None) -> list[Suggestion]:
    """The suggestions at a place of a text with known names."""
    cursor = cursor_at(text, offset)
    if cursor is None:
        return []
    offers = _Offers(offset)
    if cursor.quoted and [t.value for t in cursor.tokens] == ["include"]:
        for name in _files(path):
            offers.add(quoted(name), "file", cursor.start)
    elif cursor.quoted:
        wanted = _wanted(_classified(cursor, cursor.tokens))
        for kind, name in _names(wanted, names, text):
            offers.add(quoted(name), kind, cursor.start, name)
    else:
        _complete(text, cursor, names, offers)
    return list(offers.found.values())


def _complete(text: str, cursor: Cursor, names: Names, offers: _Offers) -> None:
    tokens = cursor.tokens
    for back in range(min(len(tokens), _LONGEST_NAME) + 1):
        if back and tokens[-back].type not in ("WORD", "INT"):
            break
        typed = tokens[: len(tokens) - back]
        start = tokens[-back].start_pos if back else cursor.start
        fragment = " ".join(text[start : offers.end].split()) if back else ""
        if back and text[cursor.start - 1 : cursor.start].isspace() and cursor.start == offers.end:
            fragment += " "
        known = _classified(cursor, typed)
        kinds = accepted(known, "change" if cursor.change else "statement")
        for kind in sorted(kinds & KEYWORDS.keys()):
            if KEYWORDS[kind].startswith(fragment):
                offers.add(KEYWORDS[kind], "keyword", start)
        if "WORD" in kinds and not (known and known[-1].type in ("WORD", "INT", "STRING")):
            for kind_, name in _names(_wanted(known), names, text):
                if name.casefold().startswith(fragment.casefold()):
                    written = name if kind_ == "keyword" else written_name(name)
                    offers.add(written, kind_, start, name)


def _classified(cursor: Cursor, tokens: Sequence[Lexeme]) -> list[Lexeme]:
    return classified(list(tokens), change=cursor.change)


def _wanted(tokens: list[Lexeme]) -> _Wanted:
    """The kinds of names that can follow these tokens."""
    comma = False
    for i in range(len(tokens) - 1, -1, -1):
        kind = tokens[i].type
        if kind == "COMMA":
            comma = True
        elif kind == "EQUALS":
            found = _behind_equals(tokens, i, comma)
            if found is not None:
                return found
        elif kind in ("MINIMIZE", "MAXIMIZE"):
            return _Wanted(words=tuple(_aims(kind)))
        elif kind == "INITIAL":
            return _Wanted(words=tuple(_values_said(tokens)))
        elif kind in _OPENING:
            return _OPENING[kind]
        elif kind not in _PASSED:
            return _NOTHING
    return _ACTIONS


def _behind_equals(tokens: list[Lexeme], i: int, comma: bool) -> _Wanted | None:
    """The kind of the names that follow `=`; None after a comma that begins something new."""
    head = tokens[0].type
    if head == "GROUP":
        return _ACTIONS
    if head in ("POOL", "RESOURCE"):
        return _RESOURCES
    if head == "SET_GOALS" and i == 1:
        return _GOALS
    governing = next((t.type for t in reversed(tokens[:i]) if t.type in _OPENING), None)
    if governing not in _FACTS:
        return _NOTHING
    if comma:
        return None
    words: list[str] = []
    for token in reversed(tokens[:i]):
        if token.type not in ("WORD", "INT", "STRING"):
            break
        words.insert(0, token.value)
    return _Wanted((Kind.VALUE,), " ".join(words), ())


def _aims(sense: str) -> Iterator[str]:
    for name in get_args(ObjectiveName):
        begun, _, aim = name.partition("_")
        if begun == sense.lower():
            yield aim


def _values_said(tokens: list[Lexeme]) -> Iterator[str]:
    """The values that the statement itself lists: `state chicken = raw, grilled initial …`."""
    behind = False
    words: list[str] = []
    for token in tokens:
        if behind and token.type in ("WORD", "INT", "STRING"):
            words.append(token.value)
            continue
        if words:
            yield " ".join(words)
        words = []
        behind = behind or token.type == "EQUALS"


def _names(wanted: _Wanted, names: Names, text: str) -> Iterator[tuple[str, str]]:
    """The (kind, name) pairs of the wanted names."""
    for kind in wanted.kinds:
        owner = wanted.owner if kind is Kind.VALUE else None
        known = names.known(kind, owner)
        for name in known:
            yield kind.value, name
        if kind is Kind.VALUE and not known:
            yield from (("keyword", word) for word in ("true", "false"))
        if kind is Kind.RESOURCE:
            yield from (("pool", pool.pool.name) for pool in pools(text))
    for word in wanted.words:
        yield "keyword", word


_MOST_FILES = 1000


def _files(path: Path | None) -> list[str]:
    """The files beside this one that it can include."""
    if path is None:
        return []
    try:
        beside = sorted(p.name for p in path.parent.iterdir() if p.suffix == ".irc" and p != path)
    except OSError:
        return []
    return beside[:_MOST_FILES]
