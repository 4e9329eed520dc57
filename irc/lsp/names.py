"""Finds the name at a place of a text, and its declarations."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from irc.diagnostics.source import Pointer, Range, Source
from irc.lsp.analysis import Analysis
from irc.lsp.mentions import Kind, Mention, mentions

Key = tuple[Kind, str, str | None]
"""The key of a named element: its kind, its name and, for a value, its state variable."""


class Spot(NamedTuple):
    """A span of a text; `within` is an included text, or None for the document's own."""

    start: int
    end: int
    within: Source | None


class Found(NamedTuple):
    """A mention and its place."""

    mention: Mention
    spot: Spot


@dataclass(frozen=True)
class Names:
    """All mentions of a text with their places.

    A repeated statement of the DSL has many of them at one place.
    """

    all: tuple[Found, ...] = ()
    declared: Mapping[Key, tuple[Spot, ...]] = field(default_factory=dict)
    _own: Mapping[tuple[int, int], tuple[Mention, ...]] = field(default_factory=dict)

    def at(self, offset: int) -> tuple[tuple[Mention, ...], Spot] | None:
        """The mentions at an offset of the text itself, declarations first; the innermost place."""
        around = [place for place in self._own if place[0] <= offset <= place[1]]
        if not around:
            return None
        # If two places touch at the offset, take the one that begins there.
        best = min(around, key=lambda p: (p[1] == offset, p[1] - p[0]))
        found = sorted(self._own[best], key=lambda m: not m.declares)
        return tuple(found), Spot(*best, None)

    def declarations(self, found: Iterable[Mention]) -> list[Spot]:
        """The places where the named elements are declared, each place once."""
        spots: dict[Spot, None] = {}
        for mention in found:
            for spot in self.declared.get(key_of(mention), ()):
                spots[spot] = None
        return list(spots)

    def known(self, kind: Kind, owner: str | None = None) -> list[str]:
        """The declared names of a kind, in the order of the text."""
        return [name for k, name, o in self.declared if k is kind and o == owner]


def key_of(mention: Mention) -> Key:
    """The key of the element that a mention names."""
    return mention.kind, mention.name, mention.owner


def names_of(analysis: Analysis) -> Names:
    """The names of a text, as far as it could be read."""
    if analysis.content is None or analysis.source is None:
        return Names()
    mentioned = list(mentions(analysis.content))
    places = analysis.source.locate(m.pointer for m in mentioned)
    found: list[Found] = []
    own: dict[tuple[int, int], list[Mention]] = defaultdict(list)
    declared: dict[Key, dict[Spot, None]] = defaultdict(dict)
    for mention in mentioned:
        spot = _spot(mention.pointer, places)
        if spot is None:
            continue
        found.append(Found(mention, spot))
        if spot.within is None:
            own[spot.start, spot.end].append(mention)
        if mention.declares:
            declared[key_of(mention)][spot] = None
    return Names(
        tuple(found),
        {key: tuple(spots) for key, spots in declared.items()},
        {place: tuple(listed) for place, listed in own.items()},
    )


def _spot(pointer: Pointer, places: Mapping[Pointer, Range | None]) -> Spot | None:
    place = places.get(pointer)
    return None if place is None else Spot(place.start, place.end, place.within)
