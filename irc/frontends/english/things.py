"""Finds the names of things in a sentence: of resources and their families.

They are free text, so no grammar knows them. Each form of sentence says where they stand; there the
words become one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from irc.frontends.english.words import Word

Spans = tuple[tuple[int, int], ...]
"""The [start, end) of each name, in order."""

_NAME = r"[^\W\d_][\w'’-]*(?: [\w'’-]+){0,3}?"
_END = r"\.?\s*\Z"

_FORMS = tuple(
    re.compile(form, re.IGNORECASE)
    for form in (
        rf".*?\buses? (?:the|an?) (?!same\b)({_NAME})(?: for ({_NAME}))?{_END}",
        rf".*?\buses? the same ({_NAME})(?: as\b.*)?{_END}",
        rf".*?\buses? [\w-]+ of the [\w-]+ ({_NAME}){_END}",
        rf"the ({_NAME}) (?:is (?:open|free|available|closed)|are (?:open|closed))\b.*{_END}",
        rf"(?:changing|switching) the ({_NAME}) from ({_NAME}) to ({_NAME}) takes?\b.*{_END}",
    )
)
_ONE_OF = re.compile(rf".*?\buses? (?:one|either)(?: of)? (?:the )?(.*?){_END}", re.IGNORECASE)
_MEMBER = re.compile(rf"\s*({_NAME})\s*(?:,\s*(?:or|and)\b|,|\b(?:or|and)\b|\Z)", re.IGNORECASE)


def thing_spans(text: str, start: int, end: int) -> Iterator[Spans]:
    """Where the names of things stand in text[start:end], for each form that it may have."""
    sentence = text[start:end].replace("\n", " ")
    for form in _FORMS:
        if (found := form.fullmatch(sentence)) is not None:
            groups = [k for k in range(1, form.groups + 1) if found[k]]
            yield tuple((start + found.start(k), start + found.end(k)) for k in groups)
    if (found := _ONE_OF.fullmatch(sentence)) is not None:
        at, stop = found.span(1)
        members: list[tuple[int, int]] = []
        while at < stop and (member := _MEMBER.match(sentence, at, stop)) is not None:
            members.append((start + member.start(1), start + member.end(1)))
            at = member.end()
        if at == stop and len(members) > 1:
            yield tuple(members)


def with_things(words: Sequence[Word], spans: Spans, text: str) -> list[Word]:
    """The words, with each name of a thing as one."""
    found: list[Word] = []
    placed: set[int] = set()
    for word in words:
        inside = next((k for k, (a, b) in enumerate(spans) if a <= word.start < b), None)
        if inside is None:
            found.append(word)
        elif inside not in placed:
            placed.add(inside)
            start, end = spans[inside]
            found.append(Word("THING", " ".join(text[start:end].split()), start, end))
    return found
