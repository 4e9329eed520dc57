"""Splits lines into statements: continuation lines, and blocks by indentation.

A line with more indentation than the statement above it continues that statement, or begins its
body if that statement ends in a colon. A line that begins with a closing bracket continues it too.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from irc.diagnostics import Code
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.lexer import Lexeme, lexemes

MAX_NESTING = 32
"""Deeper blocks are refused."""

_LINE = re.compile(r"^([ \t]*)((?!\r?$)[^ \t\n#][^\n]*)", re.MULTILINE)
_OPENERS = ("for", "event", "add", "remove")
_FIRST = re.compile(r"(for|event|add|remove|metadata)(?![\w{'’.&-])|(lapsed|choices)(?=[ \t]*\{)")


@dataclass(slots=True)
class Statement:
    """One statement: its spans of text, and its body if it is a block."""

    spans: list[tuple[int, int]]
    first: str = ""
    """Its first word, if that may open a block or free-form data."""
    body: list[Statement] | None = None
    tokens: list[Lexeme] | None = None
    """The tokens, if the statement is the part of a line after a colon."""
    open: bool = False

    @property
    def start(self) -> int:
        """The offset of its first character."""
        return self.spans[0][0]

    @property
    def end(self) -> int:
        """The offset behind the last character of its last line."""
        return self.spans[-1][1]


@dataclass(slots=True)
class Outline:
    """The statements of a text, and the faults of their indentation."""

    statements: list[Statement] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)


def outline(text: str) -> Outline:
    """The statements of a text as a tree."""
    found = Outline()
    levels: list[tuple[str, list[Statement]]] = [("", found.statements)]
    for line in _LINE.finditer(text):
        indent, begin, end = line.group(1), line.start(2), line.end(2)
        current, siblings = levels[-1]
        if indent != current:
            last = siblings[-1] if siblings else None
            if last is not None and _goes_on(last, indent, current, text, begin):
                _extend(last, begin, end, text)
                continue
            siblings = _level(levels, indent, begin, found)
        elif siblings and text[begin] in "}])":
            _extend(siblings[-1], begin, end, text)
            continue
        statement = Statement([(begin, end)])
        siblings.append(statement)
        if text[begin] in "fearmlc":
            _note_first(statement, text)
    return found


def _goes_on(last: Statement, indent: str, current: str, text: str, begin: int) -> bool:
    deeper = len(indent) > len(current) and indent.startswith(current)
    if not deeper:
        return False
    return not last.open and last.body is None


def _note_first(statement: Statement, text: str) -> None:
    word = _FIRST.match(text, statement.start)
    if word:
        statement.first = word[1] or word[2]
        _note_colon(statement, text)


def _extend(statement: Statement, begin: int, end: int, text: str) -> None:
    statement.spans.append((begin, end))
    _note_colon(statement, text)


def _note_colon(statement: Statement, text: str) -> None:
    """Records whether the statement so far ends in a colon, so that a body follows."""
    if statement.first not in _OPENERS:
        return
    begin, end = statement.spans[-1]
    last = None
    for token in lexemes(text, begin, end):
        if not isinstance(token, Lexeme):
            return
        if token.type != "COMMENT":
            last = token
    statement.open = last is not None and last.type == "COLON"


def _level(
    levels: list[tuple[str, list[Statement]]], indent: str, begin: int, found: Outline
) -> list[Statement]:
    """The list of statements to which a statement with this indentation belongs."""
    current, siblings = levels[-1]
    if len(indent) > len(current) and indent.startswith(current):
        last = siblings[-1] if siblings else None
        if last is not None and last.open:
            if len(levels) > MAX_NESTING:
                raise Fault(
                    Code.TOO_LARGE, f"blocks nested more than {MAX_NESTING} deep", begin, begin + 1
                )
            last.open, last.body = False, []
            levels.append((indent, last.body))
            return last.body
        found.faults.append(
            Fault(
                Code.DSL_INDENTATION,
                "this line is indented, but no statement above it continues or has a body",
                begin,
                begin + 1,
                "remove the spaces before it",
            )
        )
        return siblings
    while len(levels) > 1 and len(levels[-1][0]) > len(indent):
        levels.pop()
    expected, siblings = levels[-1]
    if expected != indent:
        mixed = not (indent.startswith(expected) or expected.startswith(indent))
        found.faults.append(
            Fault(
                Code.DSL_INDENTATION,
                "tabs and spaces are mixed, so it is not clear to what this line belongs"
                if mixed
                else "no statement above this line has the same indentation",
                begin,
                begin + 1,
                "indent all lines of a block equally, with spaces",
            )
        )
    return siblings
