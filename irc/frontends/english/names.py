"""Finds steps by their own text: "Boil the water", "boiling water", not "the water is boiled"."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

_WORD = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")
_ARTICLES = frozenset(["the", "a", "an"])
_SIGNS = frozenset(",-'/&;:")
"""Signs in a name that are ignored."""

_LONGEST = 40
_VOWELS = "aeiou"

Key = tuple[str, ...]


def key_of(text: str) -> Key:
    """The words of a step's text for comparison: without case, signs and articles."""
    words = (w.lower().replace("’", "'") for w in _WORD.findall(text))
    return tuple(w for w in words if w not in _ARTICLES)


def _gerunds(verb: str) -> set[str]:
    """The possible spellings of the -ing form of a verb."""
    forms = {verb + "ing"}
    if verb.endswith("ie"):
        forms.add(verb[:-2] + "ying")
    elif verb.endswith("e") and not verb.endswith("ee"):
        forms = {verb[:-1] + "ing"}
    elif len(verb) > 2 and verb[-1] not in _VOWELS + "wxy" and verb[-2] in _VOWELS:
        forms.add(verb + verb[-1] + "ing")
    return forms


class StepNames:
    """An index of the steps (by position) by their texts."""

    def __init__(self, titles: Sequence[str]) -> None:
        self._steps: dict[Key, list[int]] = {}
        for position, title in enumerate(titles):
            key = key_of(title)
            if not key or len(key) > _LONGEST:
                continue
            self._steps.setdefault(key, []).append(position)
            for gerund in _gerunds(key[0]):
                self._steps.setdefault((gerund, *key[1:]), []).append(position)
        self._by_first: dict[str, list[Key]] = {}
        for key in self._steps:
            self._by_first.setdefault(key[0], []).append(key)
        for keys in self._by_first.values():
            keys.sort(key=len, reverse=True)

    def __bool__(self) -> bool:
        return bool(self._steps)

    @property
    def known(self) -> Mapping[Key, Sequence[int]]:
        """The positions of the steps with each text."""
        return self._steps

    def steps(self, text: str) -> Sequence[int]:
        """The positions of the steps that a text names."""
        return self._steps.get(key_of(text), ())

    def match(self, texts: Sequence[str], at: int, shortest: int) -> int:
        """The number of words from `at` on that name a step: the longest name; 0 for none."""
        for key in self._by_first.get(texts[at], ())[:100]:
            if len(key) >= shortest and (count := _matches(key, texts, at)):
                return count
        return 0


def _matches(key: Key, texts: Sequence[str], at: int) -> int:
    index, first = 0, at
    while index < len(key):
        if at >= len(texts):
            return 0
        if texts[at] == key[index]:
            index += 1
        elif texts[at] not in _ARTICLES and texts[at] not in _SIGNS:
            return 0
        at += 1
    return at - first
