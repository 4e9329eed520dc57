"""The suggestions of completion, for every language."""

from __future__ import annotations

from dataclasses import dataclass

MOST_OFFERED = 2_000
"""At most this many suggestions are offered at once; further typing reduces them."""


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A suggestion: `text` replaces [start, end). The list shows `label`; the editor compares
    `typed` with the typed text."""

    label: str
    start: int
    end: int
    text: str
    kind: str
    typed: str = ""
