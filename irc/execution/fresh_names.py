"""Names for activities and reservoirs that the task does not have."""

from __future__ import annotations

from collections.abc import Container


def fresh_name(name: str, taken: Container[str]) -> str:
    """A name that is not taken, made from `name`."""
    while name in taken:
        name += "'"
    return name
