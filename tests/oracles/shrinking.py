"""Shrinking: the smallest document found for which something still goes wrong.

Greedy deletion of parts and simplification of values, again and again until nothing helps
(Zeller and Hildebrandt, "Simplifying and isolating failure-inducing input", 2002).
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from typing import Any

Place = tuple[str | int, ...]


def shrunk(document: Any, fails: Callable[[Any], bool], most: int = 2_000) -> Any:
    """A smaller document that fails as well; at most `most` documents are tried."""
    tried = 0
    improved = True
    while improved:
        improved = False
        for smaller in _smaller(document):
            tried += 1
            if tried > most:
                return document
            if fails(smaller):
                document, improved = smaller, True
                break
    return document


def _smaller(document: Any) -> Iterator[Any]:
    """The documents with one part less, then those with one simpler value."""
    places = sorted(_places(document), key=len)
    for place in places:
        if place:
            yield _without(document, place)
    for place in places:
        value = _at(document, place)
        for simpler in _simpler(value):
            yield _with(document, place, simpler)


def _places(value: Any, here: Place = ()) -> Iterator[Place]:
    yield here
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _places(part, (*here, key))
    elif isinstance(value, list):
        for k, part in enumerate(value):
            yield from _places(part, (*here, k))


def _simpler(value: Any) -> Iterator[Any]:
    if isinstance(value, bool):
        return
    if isinstance(value, int) and value not in (0, 1):
        yield 0
        yield 1
        yield value // 2
    elif isinstance(value, int) and value == 1:
        yield 0
    elif isinstance(value, str) and value[:1].isdigit():
        yield 1


def _at(document: Any, place: Place) -> Any:
    for step in place:
        document = document[step]
    return document


def _with(document: Any, place: Place, value: Any) -> Any:
    if not place:
        return value
    changed = copy.deepcopy(document)
    _at(changed, place[:-1])[place[-1]] = value
    return changed


def _without(document: Any, place: Place) -> Any:
    changed = copy.deepcopy(document)
    del _at(changed, place[:-1])[place[-1]]
    return changed
