"""Reads a list item as a step: its text, and the notes beside it (duration, order)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from irc.diagnostics import Code
from irc.frontends.english.layout import Span
from irc.frontends.english.reasons import TextFault, Unclear, not_understood, shown
from irc.frontends.english.sentences import Sentence, sentences_of
from irc.frontends.english.statements import Statement, Takes
from irc.frontends.english.understanding import Reader
from irc.frontends.english.units import UNITS

_LONGEST_NOTE = 300
_MOST_TAILS = 8

_SEPARATOR = re.compile(r"\s[-–—]\s+|[:,;=–—]\s+|\s[|]\s")
_TRIGGER = re.compile(
    r"\b(?:which takes|that takes|it takes|and takes|takes?|taking|lasts?|lasting|for|requires?|"
    r"needs?|duration|time needed|time required|depends?|after|before|once|when)\b",
    re.IGNORECASE,
)
_ORDER_TRIGGER = re.compile(
    r"(?:depends?|after|before|once|when|requires?|needs?)\b", re.IGNORECASE
)
_UNIT = "|".join(sorted((u for u in UNITS if len(u) > 1), key=len, reverse=True))
_AMOUNT = (
    r"(?:[0-9½¼¾⅓⅔]|\b(?:an?|one|two|three|four|five|six|seven|eight|nine|ten|eleven|twelve|fifteen|"
    r"twenty|thirty|forty|fifty|sixty|ninety|half|few|couple|several|some))"
)
_DURATION = re.compile(rf"{_AMOUNT}[\s-]*(?:an?\s+|of\s+)?(?:{_UNIT})\b", re.IGNORECASE)
_BOUND = re.compile(r"\b(?:at least|at most|minimum|maximum|min\.? of|max\.? of)\b", re.IGNORECASE)
_UNIT_WORD = re.compile(rf"\b(?:{_UNIT})\b|[0-9]\s*[hmsd]\b|\btime\b", re.IGNORECASE)
_STEP_NUMBER = re.compile(
    r"\b(?:steps?|tasks?|activity|activities|stages?|phases?|jobs?|operations?)\s*#?\s*[0-9]",
    re.IGNORECASE,
)
_ORDER_WORD = re.compile(
    r"\b(?:after|before|until|once|when|while|during|then|follow\w*|parallel|simultaneous\w*|"
    r"same time|concurrent\w*|requires?|depends?|needs?|unless|wait\w*|finish\w*|complet\w*|done|"
    r"starts?|started|precedes?|prior|together|except)\b",
    re.IGNORECASE,
)
_CUE = re.compile(
    r"(?:and\s+)?(?:then|next|finally|lastly|after (?:that|this|which)|afterwards?|subsequently|"
    r"meanwhile|in the meantime|at the same time|simultaneously|once (?:that|this) is)\b",
    re.IGNORECASE,
)
_OPTIONAL = re.compile(
    r"[(\[]\s*optional\s*[)\]]|\boptional(?:ly)?\s*[:,]|^\s*optional(?:ly)?\b", re.I
)


_LINK = re.compile(r"\b(?:after|before|until|once|when|while|following)\b", re.IGNORECASE)
_BINDING = re.compile(
    r"\b(?:after|before|until|once|while|must|only|right away|immediately|same time|"
    r"parallel|wait)\b",
    re.IGNORECASE,
)
_PLAIN_WORD = re.compile(r"[^\W_]+")
_PARENTHESIS = re.compile(r"[(\[][^()\[\]]{1,200}[)\]]")


_REPEATED = re.compile(r"\b(?:twice|thrice|times|each|every|per)\b|\b[0-9]+ ?[x×]", re.IGNORECASE)


@dataclass
class StepText:
    """The parts of one item: the title of its step, notes and sentences."""

    title: Span
    notes: list[tuple[tuple[Statement, ...], Span]] = field(default_factory=list)
    """Statements beside the step's text, with their places."""
    rest: list[Sentence] = field(default_factory=list)
    """Sentences after the step's own."""
    problems: list[TextFault] = field(default_factory=list)
    unreadable: bool = False
    """Whether a note is not understood."""

    @property
    def timed(self) -> bool:
        """Whether the item has a duration, or a note that may be one but is not understood."""
        return self.unreadable or any(
            isinstance(s, Takes) for statements, _ in self.notes for s in statements
        )


def read_step(reader: Reader, lines: list[Span]) -> StepText:
    """The parts of the step in the lines of an item."""
    text = reader.text
    step = StepText((lines[0][0], lines[-1][1]))
    sentences = sentences_of(text, lines)
    if len(sentences) > 1 and not _ends_with_note(reader, step.title):
        first = sentences[0]
        step.rest = sentences[1:]
        step.title = (first.start, first.end)
    _take_parenthesised(reader, step)
    if not step.timed:
        _take_leading(reader, step)
    _take_tails(reader, step)
    if not step.timed:
        _take_parenthesised(reader, step)
    _judge_title(text, step)
    return step


def _ends_with_note(reader: Reader, span: Span) -> bool:
    inner = _last_parenthesis(reader.text, span[0], _without_stop(reader.text, *span))
    if inner is None:
        return False
    try:
        return reader.note(inner[0] + 1, inner[1] - 1) is not None
    except Unclear:
        return True


def _without_stop(text: str, start: int, end: int) -> int:
    while end > start and (text[end - 1].isspace() or text[end - 1] in ".,;:!"):
        end -= 1
    return end


def _last_parenthesis(text: str, start: int, end: int) -> Span | None:
    """The span of the parenthesis at the end of a text, with the parentheses."""
    if end <= start or text[end - 1] not in ")]":
        return None
    depth = 0
    for at in range(end - 1, max(start, end - _LONGEST_NOTE) - 1, -1):
        depth += (text[at] in ")]") - (text[at] in "([")
        if depth == 0:
            return at, end
    return None


def _take_parenthesised(reader: Reader, step: StepText) -> None:
    """Moves "(3 minutes)", "(after step 2)" from the end of the step's text to the notes."""
    text = reader.text
    while True:
        start, end = step.title
        found = _last_parenthesis(text, start, _without_stop(text, start, end))
        if found is None or not _note(reader, step, (found[0] + 1, found[1] - 1), explicit=True):
            return
        step.title = (start, found[0])


def _take_leading(reader: Reader, step: StepText) -> None:
    """Moves "(3 minutes)" from the beginning to the notes."""
    text, (start, end) = reader.text, step.title
    if start < end and text[start] in "([":
        close = text.find(")" if text[start] == "(" else "]", start, start + _LONGEST_NOTE)
        if 0 <= close < end and _note(reader, step, (start + 1, close), explicit=True):
            rest = close + 1
            while rest < end and (text[rest].isspace() or text[rest] in ":-–—"):
                rest += 1
            step.title = (rest, end)


def _take_tails(reader: Reader, step: StepText) -> None:
    """Moves "takes 3 minutes", ": 3 minutes", ", after step 2" from the end to the notes."""
    start, end = step.title
    stop = _without_stop(reader.text, start, end)
    for first, last in _tails(reader.text, start, stop):
        ordered = _ORDER_TRIGGER.match(reader.text, last) is not None
        beside = reader.text[max(start, first - 1) : first] in (")", "]")
        if ordered and not beside and not _STEP_NUMBER.search(reader.text, last, stop):
            continue  # "Wash the hands before boarding" is the step's own text.
        if not ordered and step.timed:
            continue
        if _note(reader, step, (last, stop)):
            step.title = (start, first)
            if _is_doubtful(reader.text, start, first, last):
                step.problems.append(_two_times(reader.text, start, stop))
            return


def _is_doubtful(text: str, start: int, first: int, last: int) -> bool:
    """Whether a duration without parentheses may not be that of the whole step.

    text[start:first] is the step's text, the note begins at `last`: "pages 10 - 20 minutes".
    """
    bare = text[last : last + 3].lower() == "for"
    if bare and _DURATION.search(text, start, first):
        return True
    if first == last and not bare:
        return False  # "takes 5 minutes"
    title = text[start:first].rstrip()
    return bool(_REPEATED.search(title)) or (
        title[-1:].isdigit() and text[first:last].strip() != ":"
    )


def _tails(text: str, start: int, stop: int) -> Iterator[Span]:
    """(end of the title, start of the note) of possible notes, the longest first."""
    window = max(start, stop - _LONGEST_NOTE)
    cuts = [(m.start(), m.end()) for m in _SEPARATOR.finditer(text, window, stop)]
    cuts += [(m.start(), m.start()) for m in _TRIGGER.finditer(text, window, stop)]
    yield from sorted(cuts)[-_MOST_TAILS:]
    if not cuts or cuts[0][0] > start:
        yield start, start


def _note(reader: Reader, step: StepText, span: Span, *, explicit: bool = False) -> bool:
    """Whether a piece is a note beside the step's text, possibly a faulty one."""
    if span[1] - span[0] > _LONGEST_NOTE:
        return False
    try:
        statements = reader.note(*span)
    except Unclear as unclear:
        step.problems.append(unclear.problem)
        step.unreadable = True
        return True
    if statements is not None and (statements or reader.text[slice(*span)].strip()):
        step.notes.append((statements, span))
        return True
    if explicit and _looks_like_note(reader.text, *span):
        step.problems.append(_unreadable_note(reader.text, *span))
        step.unreadable = True
        return True
    return False


def _looks_like_note(text: str, start: int, end: int) -> bool:
    """Whether a parenthesis that is not understood is meant as a duration or an order."""
    piece = text[start:end]
    short = len(piece.split()) <= 8
    timed = short and (
        _DURATION.search(piece) or (_UNIT_WORD.search(piece) and piece[:1] in "~≈<>")
    )
    return bool(timed or (_STEP_NUMBER.search(piece) and _ORDER_WORD.search(piece)))


def _unreadable_note(text: str, start: int, end: int) -> TextFault:
    problem = not_understood(text, start, end)
    if bound := _BOUND.search(text, start, end):
        message = f"vague: {shown(bound[0])} in {shown(text[start:end])}"
        return TextFault(
            Code.VAGUE, message, bound.start(), 'write one time, or a range: "(5 to 10 minutes)"'
        )
    if problem.code is not Code.NOT_UNDERSTOOD:
        return problem
    return TextFault(
        problem.code,
        f"not understood as a duration or an order: {shown(text[start:end])}",
        start,
        'write "(3 minutes)", "(2 hours 30 minutes)", "(2-3 hours)" or "(5 minutes, after step 2)"',
    )


def _two_times(text: str, start: int, end: int) -> TextFault:
    return TextFault(
        Code.AMBIGUOUS,
        f"which of these times is the step's duration? {shown(text[start:end])}",
        start,
        'put the duration of the whole step in parentheses at its end: "(30 minutes)"',
    )


def _judge_title(text: str, step: StepText) -> None:
    """Refuses titles that contain an order or several durations, which are not read."""
    start, end = step.title
    for m in _PARENTHESIS.finditer(text, start, end):
        inner = m[0][1:-1]
        alone = _DURATION.match(inner.strip())
        if alone and alone.end() == len(inner.strip()):
            step.problems.append(_two_times(text, start, end))
            return
    if (number := _STEP_NUMBER.search(text, start, end)) and _ORDER_WORD.search(text, start, end):
        step.problems.append(
            TextFault(
                Code.NOT_UNDERSTOOD,
                f"the text of a step contains an order: {shown(text[start:end])}",
                number.start(),
                "write it as a sentence of its own, or in parentheses at the end: "
                '"(5 minutes, after step 2)"',
            )
        )


def order_cue(text: str, span: Span) -> re.Match[str] | None:
    """The word in a step's text for "after the previous step", such as "Then …"."""
    return _CUE.match(text, *span)


def hidden_order(reader: Reader, span: Span) -> int | None:
    """The place of an order in a step's text: after "after", or in parentheses."""
    text = reader.text
    for word in _LINK.finditer(text, *span):
        words = [m[0].lower() for m in _PLAIN_WORD.finditer(text, word.end(), span[1])]
        if words and reader.names.match(words, 0, 1):
            return word.start()
    for inner in _PARENTHESIS.finditer(text, *span):
        if binding := _BINDING.search(text, inner.start(), inner.end()):
            return binding.start()
    return None


def is_optional(text: str, span: Span) -> bool:
    """Whether a step's text calls the step optional."""
    return _OPTIONAL.search(text[slice(*span)]) is not None
