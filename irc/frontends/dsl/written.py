"""Writes small parts in the DSL: names, values, times, ranges, free-form data."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from typing import Any

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.frontends.dsl.lexer import Lexeme, lexemes, needs_quotes, quoted
from irc.model.quantities import Quantity
from irc.model.times import Instant, format_number

_WIDEST = 88


def name(text: str) -> str:
    """A name, in quotes if it needs them."""
    return quoted(text) if needs_quotes(text) else text


def names(texts: Iterable[str]) -> str:
    """A list of names."""
    return ", ".join(map(name, texts)) or "[]"


def last_name(text: str) -> str:
    """A name that may not end in a number, which would be read as a duration."""
    written = name(text)
    return quoted(text) if written[-1:].isdigit() and written.split()[-1].isdigit() else written


def value(said: bool | str | int | Fraction) -> str:
    """A value of a state variable; texts that look like the booleans are quoted."""
    if isinstance(said, bool):
        return str(said).lower()
    if isinstance(said, (int, Fraction)):
        return signed(said)
    return quoted(said) if said in ("true", "false", "number") else name(said)


def bare(said: Instant) -> str:
    """The text of a time, with or without a sign."""
    if isinstance(said, (int, Fraction)):
        return format_number(said)
    return said.text if isinstance(said, Quantity) else said.isoformat()


def time(said: Instant) -> str:
    """A time at a place without signs, without quotes if possible."""
    text = bare(said)
    return text if _is_time(text) else quoted(text)


def signed(said: Instant) -> str:
    """A time at a place where a sign may stand."""
    text = bare(said)
    return text if _is_time(text.removeprefix("-")) else quoted(text)


def _is_time(text: str) -> bool:
    tokens = list(lexemes(text, 0, len(text))) if "{" not in text and "\n" not in text else []
    if len(tokens) != 1:
        return False
    token = tokens[0]
    return isinstance(token, Lexeme) and token.type in ("INT", "TIME") and token.value == text


def span(low: Instant, high: Instant, *, sign: bool = False) -> str:
    """A range `low .. high`; an end without a unit is quoted if the other one has a unit."""
    write = signed if sign else time
    least, most = time(low), write(high)
    if least[0] != '"' and most[0] != '"' and _has_unit(low) != _has_unit(high):
        if not _has_unit(low) and low != 0:
            least = quoted(least)
        if not _has_unit(high) and high != 0:
            most = quoted(most)
    return f"{least} .. {most}"


def _has_unit(said: Instant) -> bool:
    return isinstance(said, (Quantity, datetime))


def lag(low: Instant, high: Instant | None) -> str:
    """The lag after a reference: ` + 3 s .. 2 min`; empty if there is none."""
    if type(low) is int and low == 0:
        return "" if high is None else f" + 0 .. {signed(high)}"
    text = bare(low)
    negative = text.startswith("-") and _is_time(text[1:])
    if high is None:
        return f" - {text[1:]}" if negative else f" + {time(low)}"
    if not negative:
        return f" + {span(low, high, sign=True)}"
    least, most = text[1:], signed(high)
    if most[0] != '"' and _has_unit(low) != _has_unit(high):
        if _has_unit(low):
            most = most if high == 0 else quoted(most)
        else:
            return f' + "{text}" .. {most}'
    return f" - {least} .. {most}"


def free_form(data: dict[str, Any]) -> str:
    """Free-form data as JSON: on one line if it is short, else indented."""
    short = _json(data, None, 0)
    return short if len(short) <= _WIDEST else _json(data, 4, 0)


def _json(data: Any, indent: int | None, level: int) -> str:
    if isinstance(data, dict):
        items = [f"{quoted(str(k))}: {_json(v, indent, level + 1)}" for k, v in data.items()]
        return _enclosed("{", items, "}", indent, level)
    if isinstance(data, (list, tuple)):
        return _enclosed("[", [_json(v, indent, level + 1) for v in data], "]", indent, level)
    if data is None or isinstance(data, bool):
        return {None: "null", True: "true", False: "false"}[data]
    if isinstance(data, str):
        return quoted(data)
    if (isinstance(data, float) and not isfinite(data)) or (
        isinstance(data, Decimal) and not data.is_finite()
    ):
        raise InputError(
            Report((Diagnostic(Code.BAD_NUMBER, f"metadata: {data} is not a number in JSON"),))
        )
    if isinstance(data, (int, float, Decimal)):
        return str(data)
    raise InputError(
        Report((Diagnostic(Code.WRONG_TYPE, f"metadata: {type(data).__name__} is not JSON"),))
    )


def _enclosed(opening: str, items: list[str], closing: str, indent: int | None, level: int) -> str:
    if not items or indent is None:
        return f"{opening}{', '.join(items)}{closing}"
    inner, outer = " " * indent * (level + 1), " " * indent * level
    return f"{opening}\n{inner}" + f",\n{inner}".join(items) + f"\n{outer}{closing}"
