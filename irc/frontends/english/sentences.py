"""Splits lines into sentences, with attention to abbreviations, decimals and parentheses."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from irc.frontends.english.layout import Span

_STOP = re.compile(r"[.!?]+[\"”’)\]]*(?=\s|$)")
_LAST_WORD = re.compile(r"([^\W_][\w.]*)$")
_ABBREVIATIONS = frozenset(
    [
        "vs",
        "e.g",
        "i.e",
        "approx",
        "st",
        "mr",
        "mrs",
        "ms",
        "dr",
        "prof",
        "jr",
        "sr",
        "inc",
        "ltd",
        "fig",
        "no",
        "etc",
        "al",
        "mt",
    ]
)
_SHORT_UNITS = frozenset(
    [
        "min",
        "mins",
        "sec",
        "secs",
        "hr",
        "hrs",
        "h",
        "m",
        "s",
        "wk",
        "wks",
        "yr",
        "yrs",
        "mo",
        "mos",
    ]
)


@dataclass(frozen=True, slots=True)
class Sentence:
    """A sentence at [start, end), without its full stop."""

    start: int
    end: int
    asked: bool = False
    """Whether it ends with a question mark."""
    open: bool = False
    """Whether its line ends without a full stop, so that the next line may continue it."""

    def joined(self, last: Sentence) -> Sentence:
        """The sentence from the start of this one to the end of a later one."""
        return Sentence(self.start, last.end, last.asked, last.open)


def sentences_of(text: str, lines: Sequence[Span]) -> list[Sentence]:
    """The sentences of some lines, in order."""
    found: list[Sentence] = []
    for start, end in lines:
        found += _of_line(text, start, end)
    return found


def _of_line(text: str, start: int, end: int) -> list[Sentence]:
    found, at = [], start
    for stop in _STOP.finditer(text, start, end):
        if stop.end() < end and not _ends_here(text, at, stop, end):
            continue
        if stop.start() > at:
            closed = stop.start() + len(stop.group()) if stop.group()[-1] in ")]" else stop.start()
            found.append(Sentence(at, closed, "?" in stop.group()))
        at = stop.end()
        while at < end and text[at].isspace():
            at += 1
    if at < end:
        found.append(Sentence(at, end, open=text[end - 1] != ":"))
    return found


def _ends_here(text: str, start: int, stop: re.Match[str], end: int) -> bool:
    following = text[stop.end() : min(end, stop.end() + 20)].lstrip()[:1]
    if "." not in stop.group():
        return not following.islower()
    if following.islower():
        return False
    word = _LAST_WORD.search(text, max(start, stop.start() - 20), stop.start())
    last = word[1].lower() if word else ""
    if last in _ABBREVIATIONS:
        return False
    return not (last in _SHORT_UNITS and following.isdigit())
