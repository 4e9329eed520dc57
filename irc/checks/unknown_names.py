"""Guesses which declared name an undeclared one stands for."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from irc.diagnostics.suggest import Certain, closest

MOST_GUESSES = 50
"""Limit on guesses for different unknown names: each guess compares the name with all names."""


class Guesses:
    """The declared name that an undeclared one is close to, and whether that is certain."""

    def __init__(self, tables: Mapping[str, Collection[str]]) -> None:
        self.tables = tables
        self._certain: dict[tuple[str, int], Certain] = {}
        self._made: dict[tuple[str, str], tuple[str | None, bool]] = {}

    def of(self, kind: str, name: str) -> tuple[str | None, bool]:
        """(the guess or None, whether the guess is certain)."""
        if (kind, name) in self._made:
            return self._made[kind, name]
        if len(self._made) >= MOST_GUESSES:
            return None, False
        known = self.tables[kind]
        # Events declare further names while they are checked, so the size belongs to the key.
        if (kind, len(known)) not in self._certain:
            self._certain[kind, len(known)] = Certain(known)
        match = self._certain[kind, len(known)].match(name)
        guess = (closest(name, known), False) if match is None else (match, True)
        self._made[kind, name] = guess
        return guess


def value_meant(value: bool | str, values: Collection[bool | str]) -> bool | str | None:
    """The declared value of a state variable that an undeclared one certainly stands for."""
    if isinstance(value, bool):
        return None
    quoted = {"true": True, "false": False}.get(value.casefold())
    if quoted is not None and any(v is quoted for v in values):
        return quoted
    return Certain([v for v in values if isinstance(v, str)]).match(value)
