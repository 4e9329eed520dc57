"""Names a PDDL file can hold: deterministic, collision-free, and never able to inject text."""

from __future__ import annotations

import re
import unicodedata

_LONGEST = 48
_PLAIN = re.compile(r"[a-z][a-z0-9_]{0,46}[a-z0-9]")
"""Texts that stay as they are (none is longer than `_LONGEST`)."""

_OUTSIDE = re.compile(r"[^a-z0-9_]+")

# fmt: off
RESERVED = frozenset((
    "action", "all", "always", "always-within", "and", "assign", "at", "at-end", "at-most-once",
    "at-start", "axiom", "condition", "constants", "constraints", "contingent", "decrease",
    "define", "derived", "domain", "duration", "durative-action", "effect", "either", "end",
    "equal", "exists", "forall", "functions", "goal", "hold-after", "hold-during", "imply",
    "increase", "init", "is-violated", "length", "maximize", "metric", "minimize", "not",
    "number", "object", "objects", "or", "over", "parameters", "precondition", "predicates",
    "preference", "problem", "requirements", "scale-down", "scale-up", "situation", "sometime",
    "sometime-after", "sometime-before", "start", "time", "total-cost", "total-time", "types",
    "undefined", "when", "within",
))
"""Words with a meaning of their own in PDDL 1.2 to 3.1 or in a planner's reader."""
# fmt: on


_FACTS = ("todo_", "begun_", "done_", "lag_", "after_", "during_", "open_", "released_")
"""The beginnings of facts' names; some readers have one name space for facts and actions."""


def _plain(text: str) -> str:
    if not text.isascii():
        text = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    return _OUTSIDE.sub("_", text.lower()).strip("_")[:_LONGEST] or "x"


class NameTable:
    """Hands out PDDL names; PDDL is case-insensitive, so all are lower case."""

    def __init__(self) -> None:
        self._taken: set[str] = set(RESERVED)
        self._numbers: dict[str, int] = {}

    def new(self, text: str) -> str:
        """A free name that reads like `text`: letters, digits and "_", starting with a letter."""
        name = text if _PLAIN.fullmatch(text) else _plain(text)
        if not name[0].isalpha() or name.startswith(_FACTS):
            name = f"x{name}"
        candidate, number = name, self._numbers.get(name, 1)
        while candidate in self._taken:
            number += 1
            candidate = f"{name}_{number}"
        self._taken.add(candidate)
        self._numbers[name] = number
        return candidate
