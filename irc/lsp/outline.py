"""The declarations of a text as an outline for the editor."""

from __future__ import annotations

from dataclasses import dataclass

from irc.diagnostics.source import Pointer
from irc.lsp.analysis import Analysis
from irc.lsp.mentions import Kind, Mention
from irc.lsp.names import Names


@dataclass(frozen=True, slots=True)
class OutlineEntry:
    """A declaration: its span, and the span of its name in it."""

    kind: Kind
    name: str
    start: int
    end: int
    name_start: int
    name_end: int


def outline(analysis: Analysis, names: Names) -> list[OutlineEntry]:
    """The declarations of the text itself, in its order; each place once."""
    source = analysis.source
    if source is None:
        return []
    found: dict[tuple[int, int], list[Mention]] = {}
    for mention, spot in names.all:
        if mention.declares and mention.kind is not Kind.VALUE and spot.within is None:
            found.setdefault((spot.start, spot.end), []).append(mention)
    wholes = source.locate(_element(m.pointer) for listed in found.values() for m in listed)
    entries = []
    for (start, end), listed in found.items():
        mention = listed[0]
        whole = wholes.get(_element(mention.pointer))
        begin, stop = (start, end) if whole is None else (whole.start, whole.end)
        # Several names at one place come from a repeated statement: show its own text.
        name = mention.name if len(listed) == 1 else source.text[start:end]
        entries.append(
            OutlineEntry(mention.kind, name or "…", min(begin, start), max(stop, end), start, end)
        )
    return sorted(entries, key=lambda entry: entry.start)


def _element(pointer: Pointer) -> Pointer:
    """The pointer of the element to which an id belongs."""
    return pointer[:-1]
