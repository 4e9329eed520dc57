"""Finds the known name that an unknown one means: a guess for a hint, a certain one for a repair.

A guess may be wrong and is only shown. A repair is applied without asking, so it is offered only if
exactly one known name differs from the written one only in

- upper and lower case, spaces, underscores, hyphens or a compatibility form of Unicode, or else
- one slip: a letter missing, doubled or added, or two neighbouring letters swapped, in a word of at
  least five letters; or a letter replaced by another in a word of at least seven. Digits and short
  words distinguish names (`robot1`, `cut_a`), so a change in them is no slip; and in short words a
  replaced letter makes another word (`bake`, `cake`).

The words of the IR itself are few and fixed, so four letters are enough there for both.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Collection, Iterable, Sequence
from functools import lru_cache
from typing import NamedTuple

_MANY = 5_000
"""With more names, a guess compares only those with the same first letter."""

_MOST_FOR_SLIPS = 10_000
"""With more names, only case and separators are corrected, not slips."""


def closest(name: str, known: Iterable[str]) -> str | None:
    """The closest known name, if one is close: the certain one, else a guess."""
    from difflib import get_close_matches

    candidates: Sequence[str] = list(known)
    if len(candidates) > _MANY:
        # Close matching takes quadratic time; in a large file compare only similar lengths.
        candidates = [k for k in candidates if k[:1] == name[:1] and abs(len(k) - len(name)) < 3]
    close = get_close_matches(name, candidates[:_MANY], n=1, cutoff=0.6)
    return (
        close[0] if close else _only(k for k in candidates if normal_form(k) == normal_form(name))
    )


@lru_cache(maxsize=4096)
def normal_form(name: str) -> str:
    """A name without its case, spaces, underscores and hyphens, which people vary freely."""
    folded = unicodedata.normalize("NFKC", name).casefold()
    return "".join(c for c in folded if c not in "_-‐‑–" and not c.isspace())


class SlipRule(NamedTuple):
    """The least length of a word in which a slip, or a replaced letter, is corrected."""

    slip: int
    replaced: int


NAMES = SlipRule(slip=5, replaced=7)
"""For the names that authors choose."""

KEYWORDS = SlipRule(slip=4, replaced=4)
"""For the fields and values of the IR."""


class Certain:
    """Known names, indexed to find the one that an unknown name certainly means."""

    def __init__(self, known: Collection[str], rule: SlipRule = NAMES) -> None:
        self.rule = rule
        self._by_form: dict[str, list[str]] = {}
        for name in dict.fromkeys(known):
            self._by_form.setdefault(normal_form(name), []).append(name)
        self._by_rest: dict[str, list[str]] = {}
        if len(known) <= _MOST_FOR_SLIPS:
            for name in dict.fromkeys(known):
                for rest in _with_one_less(name.casefold()):
                    self._by_rest.setdefault(rest, []).append(name)

    def match(self, name: str) -> str | None:
        """The one known name that is certainly meant; None in doubt."""
        form = normal_form(name)
        if form in self._by_form:
            return _only(self._by_form[form]) if form else None
        near = {
            known
            for rest in _with_one_less(name.casefold())
            for known in self._by_rest.get(rest, ())
            if _differs_by_one(name.casefold(), known.casefold()) is not None
        }
        known = _only(near)
        return known if known is not None and self._is_slip(name, known) else None

    def _is_slip(self, name: str, known: str) -> bool:
        name, known = name.casefold(), known.casefold()
        found = _differs_by_one(name, known)
        if found is None:
            return False
        at, length = found
        changed = name[at : at + length] + known[at : at + length]
        replaced = len(name) == len(known) and length == 1
        # Where one is longer, what was added stands in the longer one only.
        if len(name) != len(known):
            changed = max(name, known, key=len)[at]
        least = self.rule.replaced if replaced else self.rule.slip
        return changed.isalpha() and min(_word(name, at), _word(known, at)) >= least - (
            len(name) != len(known)
        )


@lru_cache(maxsize=1024)
def certain_keyword(word: str, known: tuple[str, ...]) -> str | None:
    """The field or value of the IR that is certainly meant."""
    return Certain(known, KEYWORDS).match(word)


def _only(names: Iterable[str]) -> str | None:
    found = list(names)
    return found[0] if len(found) == 1 else None


def _with_one_less(name: str) -> set[str]:
    """A name, and the name without each one of its characters; names one slip apart share one."""
    return (
        {name, *(name[:i] + name[i + 1 :] for i in range(len(name)))} if len(name) < 200 else {name}
    )


def _differs_by_one(a: str, b: str) -> tuple[int, int] | None:
    """(place, characters) of one added, missing, replaced or swapped character, else None."""
    if abs(len(a) - len(b)) > 1:
        return None
    at = next(
        (i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b))
    )
    if len(a) == len(b):
        if a[at + 1 :] == b[at + 1 :]:
            return at, 1
        swapped = a[at : at + 2] == b[at : at + 2][::-1] and a[at + 2 :] == b[at + 2 :]
        return (at, 2) if swapped else None
    longer, shorter = (a, b) if len(a) > len(b) else (b, a)
    return (at, 1) if longer[at + 1 :] == shorter[at:] else None


def _word(name: str, at: int) -> int:
    """The number of letters of the word that contains a place, or ends at it."""
    if at >= len(name) or not name[at].isalpha():
        at -= 1
    if at < 0:
        return 0
    start = end = at
    while start > 0 and name[start - 1].isalpha():
        start -= 1
    while end < len(name) and name[end].isalpha():
        end += 1
    return end - start


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """A hint with the closest known name, if one is close."""
    from irc.diagnostics.suggest import closest

    close = closest(name, known)
    return None if close is None else f"did you mean `{close}`?"
