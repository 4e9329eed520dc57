"""Fills `{name}` in the body of a `for` with values."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from irc.diagnostics import Code, did_you_mean
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.lexer import Lexeme, lexemes

Value = str | int

_BRACES = re.compile(r"\{([^{}\"\n]*)\}")
_INSIDE = re.compile(r"\s*([^\W\d]\w*)\s*(?:([+-])\s*([0-9]{1,9})\s*)?")


def filled(tokens: Sequence[Lexeme], values: Mapping[str, Value]) -> list[Lexeme]:
    """The tokens with every `{name}` and `{name + 1}` filled in.

    A value is read only as part of a name, or as a number if it is the whole token, so that a
    value in a list cannot become a clause. Raises `Fault`.
    """
    return [_filled(token, values) if "{" in token.value else token for token in tokens]


def _filled(token: Lexeme, values: Mapping[str, Value]) -> Lexeme:
    quoted = token.type == "STRING"
    if token.type not in ("STRING", "WORD", "TIME") or (quoted and not values):
        return token

    def one(match: re.Match[str]) -> str:
        inside = _INSIDE.fullmatch(match[1])
        if quoted and (inside is None or inside[1] not in values):
            return match[0]
        return str(_value(inside, token, values))

    text = _BRACES.sub(one, token.value)
    kind = token.type
    if not text:
        raise Fault(
            Code.DSL_TEMPLATE,
            f"`{token.value}` stands for nothing here",
            token.start_pos,
            token.end_pos,
        )
    if kind == "TIME":
        found = list(lexemes(text, 0, len(text)))
        if len(found) == 1 and isinstance(found[0], Lexeme) and found[0].type != "STRING":
            # `{item}s` may be a number of seconds, and as well many of an item.
            kind = found[0].type
        else:
            raise Fault(
                Code.DSL_TEMPLATE, f"`{text}` is not a time", token.start_pos, token.end_pos
            )
    elif kind == "WORD" and text.isascii() and text.isdigit():
        kind = "INT"
    elif kind == "WORD" and _BRACES.fullmatch(token.value):
        found = list(lexemes(text, 0, len(text)))
        if len(found) == 1 and isinstance(found[0], Lexeme) and found[0].type == "TIME":
            kind = "TIME"
    return Lexeme(kind, text, token.start_pos, token.end_pos)


def _value(inside: re.Match[str] | None, token: Lexeme, values: Mapping[str, Value]) -> Value:
    if inside is None:
        raise Fault(
            Code.DSL_TEMPLATE,
            f"`{token.value}` is not filled in",
            token.start_pos,
            token.end_pos,
            'braces hold the name of a `for`, as in {item} or {i + 1}; else use "quotes"',
        )
    if inside[1] not in values:
        hint = did_you_mean(inside[1], values)
        if hint is None and not values:
            hint = 'braces have a meaning only in a `for`; otherwise put the name in "quotes"'
        raise Fault(
            Code.DSL_TEMPLATE,
            f"there is no `for {inside[1]}` around this",
            token.start_pos,
            token.end_pos,
            hint,
        )
    value = values[inside[1]]
    if inside[2] is None:
        return value
    number = _number(value)
    if number is None:
        raise Fault(
            Code.DSL_TEMPLATE,
            f"`{inside[1]}` is {str(value)[:40]!r}, which is no number to reckon with",
            token.start_pos,
            token.end_pos,
        )
    return number + int(inside[3]) if inside[2] == "+" else number - int(inside[3])


def _number(value: Value) -> int | None:
    if isinstance(value, int):
        return value
    return int(value) if value.isascii() and value.isdigit() and len(value) < 20 else None
