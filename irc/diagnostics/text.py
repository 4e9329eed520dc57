"""Diagnostics as text for people: the message, the source line with a caret, the hint."""

from __future__ import annotations

import unicodedata
from collections import Counter
from collections.abc import Iterable

from irc.diagnostics.finding import Code, Diagnostic, Severity
from irc.diagnostics.source import Source, pointer_text

SHOWN_PER_CODE = 50
"""At most this many diagnostics of one code are shown; then comes the number of the others."""

_WIDEST_EXCERPT = 100


def render(diagnostics: Iterable[Diagnostic], source: Source | None, *, notes: bool = True) -> str:
    """The text of located diagnostics, with or without the notes."""
    shown: Counter[Code] = Counter()
    blocks = []
    for d in diagnostics:
        if d.severity is Severity.NOTE and not notes:
            continue
        shown[d.code] += 1
        if shown[d.code] <= SHOWN_PER_CODE:
            blocks.append(_block(d, source))
    blocks += [
        f"… and {count - SHOWN_PER_CODE} more of {code.id} ({code.summary})"
        for code, count in shown.items()
        if count > SHOWN_PER_CODE
    ]
    return "\n".join(blocks)


def _block(d: Diagnostic, source: Source | None) -> str:
    lines = [f"{d.severity}[{d.code.id}]: {d.message}"]
    source = d.within or source
    if source is not None and d.offset is not None and d.column is not None:
        lines.append(f"  --> {source.name}:{d.line}:{d.column}")
        shown, caret = excerpt(source.line_at(d.offset), d.column - 1)
        number = str(d.line)
        lines += [f" {number} | {shown}", f" {' ' * len(number)} | {' ' * caret}^"]
    elif d.pointer:
        lines.append(f"  --> {pointer_text(d.pointer)}")
    if d.hint:
        lines.append(f"  hint: {d.hint}")
    return "\n".join(lines)


def excerpt(line: str, column: int) -> tuple[str, int]:
    """At most `_WIDEST_EXCERPT` printable characters of a line, and the cell for the caret."""
    start = 0 if column < _WIDEST_EXCERPT else column - _WIDEST_EXCERPT // 2
    cut = "".join(c if c.isprintable() else " " for c in line[start : start + _WIDEST_EXCERPT])
    lead = "…" if start else ""
    tail = "…" if start + _WIDEST_EXCERPT < len(line) else ""
    return lead + cut + tail, len(lead) + sum(map(_cells, cut[: column - start]))


def _cells(character: str) -> int:
    """The number of terminal cells of a character (Unicode Standard Annex 11)."""
    if unicodedata.combining(character):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1
