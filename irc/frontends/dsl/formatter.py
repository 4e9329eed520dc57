"""The layout of a DSL text: spacing, indentation and columns; words and comments stay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from irc.diagnostics import InputError
from irc.frontends.dsl.lexer import (
    CLAUSE_WORDS,
    STATEMENT_WORDS,
    Lexeme,
    classified,
    lexemes,
)
from irc.frontends.dsl.lines import Outline, Statement, outline
from irc.frontends.dsl.metadata import FREE_FORM

INDENT = 4
_MOST_BLANK_LINES = 2
_WIDEST_COLUMN = 44
"""Longer names are not put into columns."""

_SPELLED = {"ARROW": "->", "DOTS": "..", "TIMES": "*", "MINUS": "-"} | {
    "AT_LEAST": ">=",
    "AT_MOST": "<=",
    "LOSES": "-=",
}
_NOTHING_BEFORE = {"COMMA", "COLON", "CLOSE"}


def formatted(text: str, name: str = "<text>") -> str:
    """The text in the standard layout, with the same meaning.

    Raises `InputError` with the faults of a text that cannot be read; included files are not read.
    """
    from irc.frontends.dsl.reader import syntax_faults

    faults = syntax_faults(text, name)
    if faults.diagnostics:
        raise InputError(faults)
    return format_dsl(text)


def format_dsl(text: str) -> str:
    """The text in the standard layout, if it has no faults."""
    text = text.removeprefix("\ufeff").replace("\r\n", "\n")
    lines = _Layout(text, outline(text)).lines()
    _columns(lines)
    return "".join(f"{_shown(line)}\n" for line in _without_long_gaps(lines))


@dataclass(slots=True)
class _Line:
    """One line: its depth, its text, or the parts that stand in columns."""

    indent: int = 0
    text: str = ""
    comment: str = ""
    cells: tuple[str, str, str] | None = None
    """Name, duration and the rest of an action that fills one line."""

    @property
    def blank(self) -> bool:
        return not (self.text or self.comment)


@dataclass(slots=True)
class _Place:
    """The statement that a line begins or continues, with its depth."""

    statement: Statement
    depth: int
    goes_on: bool
    change: bool
    """Whether the statement is a change of an event."""


class _Layout:
    """Formats the lines of a text one by one."""

    def __init__(self, text: str, found: Outline) -> None:
        self.text = text
        self.places: dict[int, _Place] = {}
        self._note(found.statements, 0, change=False)
        self.levels = [""]
        self.opened = False

    def _note(self, statements: Sequence[Statement], depth: int, *, change: bool) -> None:
        for statement in statements:
            for i, (begin, _) in enumerate(statement.spans):
                self.places[begin] = _Place(statement, depth, i > 0, change)
            inner = statement.first == "event" or (change and statement.first == "for")
            self._note(statement.body or (), depth + 1, change=inner)

    def lines(self) -> list[_Line]:
        """Every line of the text, formatted."""
        found: list[_Line] = []
        begin = 0
        for raw in self.text.split("\n"):
            body = raw.strip(" \t\r")
            at = begin + (len(raw) - len(raw.lstrip(" \t")))
            begin += len(raw) + 1
            if not body:
                found.append(_Line())
            elif at in self.places:
                found.append(self._line(raw, at, at + len(raw.lstrip(" \t").rstrip(" \t\r"))))
            else:
                found.append(self._comment(raw, body))
        return found

    def _comment(self, raw: str, body: str) -> _Line:
        indent = raw[: len(raw) - len(raw.lstrip(" \t"))]
        depth = max(
            (d for d, level in enumerate(self.levels) if len(level) <= len(indent)), default=0
        )
        if self.opened and len(indent) > len(self.levels[-1]):
            depth = len(self.levels)
        return _Line(depth * INDENT, comment=body)

    def _line(self, raw: str, at: int, end: int) -> _Line:
        place = self.places[at]
        statement = place.statement
        if statement.first in FREE_FORM:
            return self._free_form(raw, place)
        tokens = [t for t in lexemes(self.text, at, end) if isinstance(t, Lexeme)]
        comment = ""
        if tokens and tokens[-1].type == "COMMENT":
            comment = self.text[tokens[-1].start_pos : tokens[-1].end_pos].rstrip()
            tokens.pop()
        indent = place.depth * INDENT
        if place.goes_on:
            closes = bool(tokens) and tokens[0].type == "CLOSE"
            indent += 0 if closes else INDENT
        else:
            self._enter(raw, place)
        alone = not (place.goes_on or place.change) and len(statement.spans) == 1
        cells = self._cells(tokens) if alone else None
        return _Line(indent, self._set(tokens), comment, cells)

    def _enter(self, raw: str, place: _Place) -> None:
        indent = raw[: len(raw) - len(raw.lstrip(" \t"))]
        self.levels = [*self.levels[: place.depth], indent]
        self.opened = place.statement.body is not None

    def _free_form(self, raw: str, place: _Place) -> _Line:
        if place.goes_on:
            return _Line(0, raw.rstrip())
        self._enter(raw, place)
        first = place.statement.first
        word, _, rest = raw.strip().partition(first)
        return _Line(place.depth * INDENT, f"{word}{first} {rest.strip()}".rstrip())

    def _set(self, tokens: Sequence[Lexeme]) -> str:
        parts: list[str] = []
        for i, token in enumerate(tokens):
            if i and _spaced(tokens, i):
                parts.append(" ")
            parts.append(_SPELLED.get(token.type) or self.text[token.start_pos : token.end_pos])
        return "".join(parts)

    def _cells(self, tokens: list[Lexeme]) -> tuple[str, str, str] | None:
        if not tokens or (tokens[0].type == "WORD" and tokens[0].value in STATEMENT_WORDS):
            return None
        end = next(
            (
                i
                for i, token in enumerate(classified(tokens))
                if token.type not in ("WORD", "INT", "TIME", "STRING")
            ),
            len(tokens),
        )
        if end < 2 or tokens[end - 1].type == "WORD":
            return None
        start = end - 1
        if end + 1 < len(tokens) and tokens[end].type == "DOTS":
            end += 2
        if end < len(tokens) and tokens[end].type in ("ARROW", "COMMA", "COLON"):
            return None
        return (self._set(tokens[:start]), self._set(tokens[start:end]), self._set(tokens[end:]))


def _spaced(tokens: Sequence[Lexeme], i: int) -> bool:
    before, token = tokens[i - 1], tokens[i]
    if token.type in _NOTHING_BEFORE or before.type == "OPEN":
        return False
    return not (before.type == "MINUS" and _is_sign(tokens, i - 1))


def _is_sign(tokens: Sequence[Lexeme], i: int) -> bool:
    """Whether a minus belongs to the number after it, not to the lag of a reference."""
    if i == 0:
        return False
    before = tokens[i - 1]
    return before.type in ("DOTS", "EQUALS", "COMMA", "PLUS", *_OF_LEVELS) or (
        before.type == "WORD" and before.value in CLAUSE_WORDS
    )


_OF_LEVELS = ("AT_LEAST", "AT_MOST", "EXACTLY", "GAINS", "LOSES", "BECOMES", "CHANGES_TO")


def _columns(lines: list[_Line]) -> None:
    """Puts neighbouring actions into columns."""
    at = 0
    while at < len(lines):
        end = at
        while (
            end < len(lines)
            and lines[end].cells is not None
            and (lines[end].indent == lines[at].indent)
        ):
            end += 1
        if end - at > 1:
            _align(lines[at:end])
        at = max(end, at + 1)


def _align(lines: Sequence[_Line]) -> None:
    cells = [line.cells for line in lines if line.cells is not None]
    widths = [
        max((len(c[k]) for c in cells if len(c[k]) <= _WIDEST_COLUMN), default=0) for k in (0, 1)
    ]
    for line in lines:
        if line.cells is not None:
            name, duration, rest = line.cells
            text = f"{name.ljust(widths[0])}  {duration}"
            if rest:
                text = f"{name.ljust(widths[0])}  {duration.ljust(widths[1])}  {rest}"
            line.text = text


def _shown(line: _Line) -> str:
    text = " " * line.indent + line.text if line.text else ""
    if not line.comment:
        return text
    return f"{text}  {line.comment}" if line.text else " " * line.indent + line.comment


def _without_long_gaps(lines: list[_Line]) -> list[_Line]:
    found: list[_Line] = []
    gap = 0
    for line in lines:
        gap = gap + 1 if line.blank else 0
        if gap <= _MOST_BLANK_LINES and (found or not line.blank):
            found.append(line)
    while found and found[-1].blank:
        found.pop()
    return found
