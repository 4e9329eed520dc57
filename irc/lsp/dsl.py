"""Reads parts of the DSL's own syntax: includes, pools, and the statement at a cursor."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.include import Included, Library
from irc.frontends.dsl.lexer import Lexeme, lexemes
from irc.frontends.dsl.lines import Statement, outline

MOST_TOKENS = 20_000
"""The editor's features skip a statement with more tokens, such as one very long line."""


@dataclass(frozen=True, slots=True)
class Word:
    """A name as it is written, with its place."""

    name: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class PoolStatement:
    """A pool in the text: `pool robots = r1, r2`."""

    pool: Word
    members: tuple[Word, ...]


@dataclass(frozen=True, slots=True)
class Cursor:
    """The statement before a cursor.

    `tokens` are those before the word that is being typed, which stands from `start` to the
    cursor; `quoted` says that it has begun with a quote. `change` tells a statement of an event.
    """

    tokens: tuple[Lexeme, ...]
    start: int
    quoted: bool = False
    change: bool = False


def includes(text: str) -> Iterator[tuple[str, int, int]]:
    """Each `include` of a text: (the name of the file, start and end of that name)."""
    for statement in _statements(text, "include"):
        tokens = _tokens(text, statement)
        if len(tokens) == 2 and tokens[1].type == "STRING":
            yield tokens[1].value, tokens[1].start_pos, tokens[1].end_pos


def included(text: str, path: Path) -> Iterator[Included]:
    """All files that a file includes, directly or not; unreadable ones are skipped."""
    library = Library(path.parent)
    seen = {path.resolve()}
    waiting = [(text, path.parent)]
    while waiting:
        current, beside = waiting.pop()
        for name, start, end in includes(current):
            try:
                found = library.open(name, beside, start, end)
            except Fault:
                continue  # A finding reports it.
            if found.path not in seen:
                seen.add(found.path)
                waiting.append((found.source.text, found.path.parent))
                yield found


def pools(text: str) -> Iterator[PoolStatement]:
    """The pools that a text declares: `pool robots = r1, r2`, `resource robots = r1, r2`."""
    for statement in (*_statements(text, "pool"), *_statements(text, "resource")):
        tokens = _tokens(text, statement)
        equals = next((i for i, t in enumerate(tokens) if t.type == "EQUALS"), 0)
        names = _words(tokens[1:equals])
        if len(names) == 1:
            yield PoolStatement(names[0], tuple(_words(tokens[equals + 1 :])))


def _words(tokens: Sequence[Lexeme]) -> list[Word]:
    """The names of a list that is separated by commas, up to the first other token."""
    found: list[Word] = []
    run: list[Lexeme] = []
    for token in (*tokens, Lexeme("COMMA", ",", 0, 0)):
        if token.type in ("WORD", "INT", "STRING"):
            run.append(token)
            continue
        if run:
            name = " ".join(t.value for t in run)
            found.append(Word(name, run[0].start_pos, run[-1].end_pos))
        run = []
        if token.type != "COMMA":
            break
    return found


def _statements(text: str, word: str) -> Iterator[Statement]:
    """The statements that begin with a word, also in bodies."""
    try:
        waiting = list(outline(text).statements)
    except Fault:
        return
    for statement in waiting:
        waiting += statement.body or ()
        begin = statement.start
        if text.startswith(word, begin) and text[begin + len(word) : begin + len(word) + 1] in (
            " ",
            "\t",
            '"',
        ):
            yield statement


def _tokens(text: str, statement: Statement) -> list[Lexeme]:
    """The tokens of a statement up to the first place without a token."""
    found: list[Lexeme] = []
    for begin, end in statement.spans:
        for token in lexemes(text, begin, end):
            if not isinstance(token, Lexeme) or len(found) > MOST_TOKENS:
                return found
            if token.type != "COMMENT":
                found.append(token)
    return found


_TYPED = "x"
"""A word in place of the text that will be typed, so that there is a statement to find."""


def cursor_at(text: str, offset: int) -> Cursor | None:
    """The statement at a cursor, read from the text before it; None in a comment, and if the text
    before it cannot be read."""
    before = text[:offset] + _TYPED
    try:
        statements = outline(before).statements
    except Fault:
        return None
    change, last = False, None
    while statements:
        last = statements[-1]
        change = _holds_changes(last, change)
        statements = last.body or []
    if last is None or last.end != len(before):
        return None
    return _in_statement(before, last, _is_change(before, last, change))


def _holds_changes(statement: Statement, change: bool) -> bool:
    """Whether the body of a statement has changes; the body of a `for` has what is around it."""
    if statement.body is None:
        return change
    return statement.first == "event" or (change and statement.first == "for")


def _is_change(text: str, statement: Statement, change: bool) -> bool:
    return change or text.startswith("event", statement.start)


def _in_statement(before: str, statement: Statement, change: bool) -> Cursor | None:
    end = len(before)
    tokens: list[Lexeme] = []
    for begin, stop in statement.spans:
        for token in lexemes(before, begin, stop):
            if len(tokens) > MOST_TOKENS:
                return None
            if not isinstance(token, Lexeme):
                if token.kind == "unclosed" and token.end == end:
                    return _after_colon(tokens, token.start, True, change)
                return None
            if token.type == "COMMENT":
                if token.end_pos == end:
                    return None
                continue
            if token.end_pos == end:
                return _after_colon(tokens, token.start_pos, False, change)
            tokens.append(token)
    return None


def _after_colon(tokens: list[Lexeme], start: int, quoted: bool, change: bool) -> Cursor:
    """The tokens after the colon of a `for` or an `event` on its line, a statement of its own."""
    while tokens and tokens[0].value in ("for", "event", "add", "remove"):
        colon = next((i for i, t in enumerate(tokens) if t.type == "COLON"), None)
        if colon is None:
            # The head of an event is not a change itself.
            change = change and tokens[0].value != "event"
            break
        change = change and tokens[0].value in ("for", "event")
        tokens = tokens[colon + 1 :]
    return Cursor(tuple(tokens), start, quoted, change)
