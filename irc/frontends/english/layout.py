"""Splits the lines of a text into list items with their markers, and paragraphs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

Span = tuple[int, int]
"""A span [start, end) of the text."""

_NOUN = r"(?:step|task|activity|action|stage|phase|job|operation|subtask)"
_LABEL = r"(?:[0-9]{1,9}[a-z]?|[A-Za-z]{1,2}[0-9]{1,5}|[A-Za-z])"
_NAMED = (
    rf"(?P<named>{_NOUN})(?:[ \t]*\#?[ \t]*(?=[0-9])|[ \t]+)(?P<label>{_LABEL})"
    r"[ \t]*(?:[.:)\]](?![0-9])|[-–—](?=[ \t])|(?=\([^()]*\)[ \t]*[:–—-]))"
)
_NUMBERED = r"[(\[]?(?P<bare>[0-9]{1,9}|[A-Z][0-9]{0,5})[.)\]](?=[ \t]|[^\W\d])"
_CODED = r"(?P<coded>[A-Z][0-9]{1,5}):(?=[ \t])"
_BULLET = r"[*+•‣◦▪●–—-][ \t]+(?:\[[ xX]?\][ \t]+)?"

_MARKER = re.compile(
    rf"[ \t>]*(?:(?P<bullet>{_BULLET}))?(?:{_NAMED}|{_NUMBERED}|{_CODED})?", re.IGNORECASE
)
_INLINE = re.compile(
    rf"(?<=[.!?;,)\]:])[ \t]+(?={_NOUN}[ \t]*\#?[ \t]*[0-9]{{1,9}}[.:)][ \t])", re.I
)
_FIRST_OF_MANY = re.compile(r"[ \t]*[0-9]{1,9}[.)][ \t]")
_INLINE_NUMBER = re.compile(r"(?<=[.;)])[ \t]+(?=[0-9]{1,9}[.)][ \t])")
_RULE = re.compile(r"[ \t]*(?:[-*_=~]{3,}|```\w*|~~~\w*)[ \t]*")
_EMPHASIS = re.compile(r"\*\*|__|(?<!\S)\*(?=\S)|(?<=[^\s*])\*(?!\S)")
_UNFINISHED = frozenset(
    [
        "step",
        "steps",
        "task",
        "tasks",
        "and",
        "or",
        "precede",
        "precedes",
        "before",
        "after",
        "than",
        "to",
        "by",
        "until",
        "follow",
        "follows",
        "of",
        "on",
        "for",
        "the",
        "is",
        "are",
        "must",
        "be",
        "from",
        "with",
        "when",
        "once",
        "as",
        "that",
        "in",
    ]
)


@dataclass
class Item:
    """A line that begins with a marker, and the lines below that belong to it."""

    line: Span
    body: Span
    label: str | None
    named: bool
    """Whether the marker has a noun: "Step 3." rather than "3."."""
    indent: int
    more: list[Span] = field(default_factory=list)


@dataclass
class Paragraph:
    """Lines without a marker, no blank line between them."""

    lines: list[Span]


Block = Item | Paragraph


def without_emphasis(text: str) -> str:
    """The text with spaces instead of Markdown's emphasis, so that no offset changes."""
    return _EMPHASIS.sub(lambda m: " " * len(m[0]), text) if "*" in text or "__" in text else text


def blocks_of(text: str) -> list[Block]:
    """The blocks of a text, in order."""
    blocks: list[Block] = []
    broken = True
    for start, end in _lines(text):
        if not text[start:end].strip() or _RULE.fullmatch(text, start, end):
            broken = True
            continue
        for part in _inline_items(text, start, end):
            _add(text, part, blocks, broken)
            broken = False
    return blocks


def _lines(text: str) -> Iterator[Span]:
    at = 0
    while at < len(text):
        end = text.find("\n", at)
        end = len(text) if end < 0 else end
        yield at, (end - 1 if text[at:end].endswith("\r") else end)
        at = end + 1


def _inline_items(text: str, start: int, end: int) -> list[Span]:
    cuts = [m.end() for m in _INLINE.finditer(text, start, end)]
    if not cuts and _FIRST_OF_MANY.match(text, start, end):
        cuts = [m.end() for m in _INLINE_NUMBER.finditer(text, start, end)]
    return list(zip([start, *cuts], [*cuts, end], strict=True))


def _add(text: str, line: Span, blocks: list[Block], broken: bool) -> None:
    start, end = _stripped(text, *line)
    last = blocks[-1] if blocks and not broken else None
    match = _MARKER.match(text, *line)
    marked = match is not None and bool(
        match["bullet"] or match["named"] or match["bare"] or match["coded"]
    )
    if match is None or not marked or _continues(text, last):
        if isinstance(last, Item):
            last.more.append((start, end))
        elif isinstance(last, Paragraph):
            last.lines.append((start, end))
        else:
            blocks.append(Paragraph([(start, end)]))
        return
    label = match["label"] or match["bare"] or match["coded"]
    if match["bare"] and match["bare"].isalpha() and not match["bare"].isupper():
        label = None
    body = _stripped(text, match.end(), end)
    blocks.append(Item((start, end), body, label, match["named"] is not None, start - line[0]))


def _continues(text: str, last: Block | None) -> bool:
    """Whether the last line ends inside a sentence, so that this line continues it."""
    if last is None:
        return False
    lines: Sequence[Span] = (
        last.lines if isinstance(last, Paragraph) else (last.more or [last.line])
    )
    start, end = lines[-1]
    words = text[max(start, end - 40) : end].split()
    return bool(words) and words[-1].lower() in _UNFINISHED


def _stripped(text: str, start: int, end: int) -> Span:
    while start < end and text[start].isspace():
        start += 1
    while end > start and text[end - 1].isspace():
        end -= 1
    return start, end
