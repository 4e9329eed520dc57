"""Reads the small parts of a statement's tree: names, numbers and times, with their places."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from irc.diagnostics import Code, did_you_mean
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.lexer import (
    CLAUSE_WORDS,
    STATEMENT_WORDS,
    Lexeme,
    clause_like,
    quoted,
    resource_clause_like,
)

if TYPE_CHECKING:
    from lark import Tree

    Node = Tree[Any] | Lexeme

_LONGEST_INT = 40
_MOST_DIGITS = 1000
_PLAIN_NUMBER = re.compile(r"[0-9./]+(?:[eE][+-]?[0-9]+)?")


@dataclass(frozen=True, slots=True)
class Placed:
    """A value and its place."""

    value: Any
    start: int
    end: int


def kind(node: Any) -> str:
    """The rule of a tree, the type of a token, "" for an absent part."""
    if node is None:
        return ""
    # The name of a rule is of Lark's own text type, which is slow to compare.
    return node.type if type(node) is Lexeme else _rule(node)


def _rule(node: Any) -> str:
    return str(node.data)


def span(node: Node) -> tuple[int, int]:
    """The span of a node, from its first token to its last."""
    first: Any = node
    while not isinstance(first, Lexeme):
        first = next(child for child in first.children if child is not None)
    last: Any = node
    while not isinstance(last, Lexeme):
        last = next(child for child in reversed(last.children) if child is not None)
    return first.start_pos, last.end_pos


def parts(node: Any, *kinds: str) -> list[Any]:
    """The children of these kinds."""
    return [child for child in node.children if kind(child) in kinds]


def part(node: Any, *kinds: str) -> Any:
    """The first child of these kinds, or None."""
    return next(iter(parts(node, *kinds)), None)


def name(node: Any) -> Placed:
    """The text of a name or value: its words, or the text in quotes."""
    words = node.children
    if len(words) == 1:
        return Placed(words[0].value, words[0].start_pos, words[0].end_pos)
    value = " ".join([word.value for word in words])
    return Placed(value, words[0].start_pos, words[-1].end_pos)


def no_resource_clause(node: Any) -> None:
    """Refuses an unquoted name of a resource that looks like a misspelt clause."""
    if node.children[0].type == "STRING":
        return
    misspelt = resource_clause_like(node.children)
    if misspelt is not None:
        word, meant = misspelt
        raise Fault(
            Code.DSL_SYNTAX,
            f"found `{word}` before a number; expected a clause such as `capacity`, `initial`",
            *span(word),
            f'did you mean `{meant}`? If it belongs to the name, put the name in "quotes"',
        )


def text(token: Lexeme) -> Placed:
    """The text in quotes."""
    return Placed(str(token), token.start_pos, token.end_pos)


def names(node: Any) -> list[Placed]:
    """The names of a list; none for `[]`."""
    return [name(child) for child in parts(node, "name", "value")]


def value(node: Any) -> Placed:
    """A value of a state variable: unquoted true and false are the booleans."""
    found = name(node)
    unquoted = kind(node.children[0]) != "STRING"
    if unquoted and found.value in ("true", "false"):
        return Placed(found.value == "true", found.start, found.end)
    return found


def integer(node: Any) -> Placed:
    """A whole number, with its sign if it has one."""
    start, end = span(node)
    if kind(node) == "INT":
        return Placed(_int(node), start, end)
    number = _int(part(node, "INT"))
    return Placed(-number if part(node, "MINUS") is not None else number, start, end)


def _int(token: Lexeme) -> int:
    if len(token) > _MOST_DIGITS:
        raise Fault(Code.BAD_NUMBER, "a number out of range", *span(token))
    return int(token.value)


def time(node: Any, *, negative: bool = False) -> Placed:
    """A time in the form of JSON: a number or a text, which `parse_span` reads later."""
    if kind(node) == "signed":
        minus = part(node, "MINUS")
        found = time(part(node, "INT", "TIME", "STRING"), negative=minus is not None)
        return found if minus is None else Placed(found.value, minus.start_pos, found.end)
    start, end = span(node)
    if kind(node) == "INT" and len(node) <= _LONGEST_INT:
        return Placed(-int(node.value) if negative else int(node.value), start, end)
    if negative and kind(node) == "STRING":
        raise Fault(
            Code.DSL_SYNTAX,
            "there is a sign before a quoted time",
            start,
            end,
            "put the sign inside the quotes",
        )
    return Placed(f"-{node}" if negative else str(node), start, end)


def day_time(node: Any) -> Placed:
    """A time of day (`06:00`), or a time since the beginning of a cycle."""
    return Placed(str(node), *span(node)) if kind(node) == "CLOCK" else time(node)


def alike(low: Any, high: Any) -> None:
    """Refuses a range of which only one end has a unit: `5 .. 10 min` has two meanings."""
    tokens = [part(n, "INT", "TIME", "STRING") if kind(n) == "signed" else n for n in (low, high)]
    if any(t is None or kind(t) == "STRING" for t in tokens):
        return
    bare = [_PLAIN_NUMBER.fullmatch(str(t)) is not None for t in tokens]
    if bare[0] == bare[1]:
        return
    without = tokens[0] if bare[0] else tokens[1]
    if not str(without).strip("0."):
        return  # 0 is the same in every unit.
    raise Fault(
        Code.DSL_SYNTAX,
        f"one end of this range has a unit and `{without}` has none",
        *span(without),
        f"give both a unit; if the task's own unit is meant, write {quoted(str(without))}",
    )


@dataclass(frozen=True, slots=True)
class Head:
    """The beginning of an action or mode: its name, and its duration if it has one."""

    name: Placed
    time: Any
    """The token of the duration, or None."""


def head(node: Any) -> Head:
    """Splits the words of a head: the last piece is the duration if it is a number or a time."""
    pieces = list(node.children)
    first, last = pieces[0], pieces[-1]
    if kind(first) == "STRING":
        if len(pieces) > 1 and kind(pieces[1]) == "WORD":
            raise _after(pieces[1], "the name in quotes")
        if len(pieces) > 2:
            raise _after(pieces[2], "the duration")
        return Head(text(first), pieces[1] if len(pieces) > 1 else None)
    duration = last if len(pieces) > 1 and kind(last) != "WORD" else None
    words = pieces[:-1] if duration is not None else pieces
    return Head(_plain(words), duration)


def plain_head(node: Any) -> Placed:
    """The name of a head that has no duration."""
    pieces = list(node.children)
    if kind(pieces[0]) == "STRING" and len(pieces) == 1:
        return text(pieces[0])
    return _plain(pieces)


def _plain(words: list[Any]) -> Placed:
    for i, word in enumerate(words):
        if kind(word) in ("WORD", "INT"):
            continue
        if i == 0:
            raise Fault(
                Code.DSL_NAME, f"found the time `{word}` where a name is expected", *span(word)
            )
        after = words[i + 1] if i + 1 < len(words) else None
        if after is not None and kind(after) == "WORD":
            raise _after(after, f"`{word}`")
        raise Fault(
            Code.DSL_NAME,
            f"`{word}` cannot be a part of an unquoted name",
            *span(word),
            'put the name in "quotes"',
        )
    misspelt = clause_like(words)
    if misspelt is not None:
        word, meant = misspelt
        raise Fault(
            Code.DSL_SYNTAX,
            f"found `{word}` after a number; expected a clause such as `on`, `by`, `after`",
            *span(word),
            f'did you mean `{meant}`? If it belongs to the name, put the name in "quotes"',
        )
    value = " ".join(map(str, words))
    return Placed(value, span(words[0])[0], span(words[-1])[1])


def _after(token: Lexeme, what: str) -> Fault:
    """The fault of a word after a duration: a misspelt clause, or a name that needs quotes."""
    near = did_you_mean(str(token), sorted(CLAUSE_WORDS))
    return Fault(
        Code.DSL_SYNTAX,
        f"found `{token}` after {what}; expected a clause such as `on`, `by`, `after`",
        *span(token),
        near or 'if it belongs to the name, put the name in "quotes"',
    )


def no_duration(found: Head) -> Fault:
    """The fault of an action without a duration, which is often another, misspelt statement."""
    words = str(found.name.value).split()
    near = did_you_mean(words[0], sorted(STATEMENT_WORDS)) if words else None
    return Fault(
        Code.DSL_SYNTAX,
        f"the action {_shown(found.name.value)} has no duration",
        found.name.start,
        found.name.end,
        near or "write it after the name, as in `boil eggs 4 min`",
    )


def _shown(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")
