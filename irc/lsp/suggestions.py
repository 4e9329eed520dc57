"""What completion offers, whatever the language."""

from __future__ import annotations

from dataclasses import dataclass

MOST_OFFERED = 2_000
"""No more are offered at once; typing on narrows them down."""


@dataclass(frozen=True, slots=True)
class Suggestion:
    """`text` in the place of [start, end). `label` is what the list shows; `typed` what the
    editor compares with what was typed."""

    label: str
    start: int
    end: int
    text: str
    kind: str
    typed: str = ""
