"""The value of a state variable in words."""

from __future__ import annotations

from fractions import Fraction

from irc.model.quantities import Number
from irc.model.times import format_number


def value_text(value: bool | str | Number | None) -> str:
    """A value as messages show it: true and false as JSON writes them, text in quotes."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, Fraction)):
        return format_number(value)
    return "not set" if value is None else repr(value)


def limits_text(least: Number | None, greatest: Number | None) -> str:
    """Limits of a number variable as messages show them: "at least 10", "5"."""
    if least is not None and least == greatest:
        return format_number(least)
    parts = [] if least is None else [f"at least {format_number(least)}"]
    parts += [] if greatest is None else [f"at most {format_number(greatest)}"]
    return " and ".join(parts) or "any number"
