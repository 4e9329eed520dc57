"""The value of a state variable in words."""

from __future__ import annotations


def value_text(value: bool | str | None) -> str:
    """A value as messages show it: true and false as JSON writes them, text in quotes."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return "not set" if value is None else repr(value)
