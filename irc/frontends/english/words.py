"""Splits a sentence into words of the language: terminals of the grammar, with their places."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from irc.frontends.english.names import StepNames
from irc.frontends.english.units import UNITS
from irc.model.quantities import MAX_DIGITS

WORD, OTHER = "WORD", "OTHER"
"""Kinds that no rule of the grammar has: unknown words and unknown signs."""

_RAW = re.compile(
    r"""(?P<tag><[^<>\n]{0,60}>)
    |(?P<quote>"[^"\n]{1,300}"|“[^”\n]{1,300}”|«[^»\n]{1,300}»|`[^`\n]{1,300}`
        |(?<!\w)['‘][^'‘’\n]{1,300}['’](?!\w))
    |(?P<arrow>-{1,3}>|={1,2}>|[→⇒➔➜])
    |(?P<num>[0-9]{1,3}(?:,[0-9]{3})+(?:\.[0-9]+)?(?![0-9])|[0-9]*\.[0-9]+|[0-9]+)
    |(?P<vulgar>[½⅓⅔¼¾⅕⅖⅗⅘⅙⅚⅛⅜⅝⅞])
    |(?P<abbreviation>e\.g\.?|n/a\b)
    |(?P<label>[A-Za-z]{1,3}[0-9]{1,5}\b)
    |(?P<word>[^\W\d_]+(?:['’][^\W\d_]+)*)
    |(?P<hash>\#{1,6})
    |(?P<sign>\S)""",
    re.VERBOSE,
)

_VULGAR = dict(
    zip(
        "½⅓⅔¼¾⅕⅖⅗⅘⅙⅚⅛⅜⅝⅞",
        (
            Fraction(*pair)
            for pair in (
                *((1, 2), (1, 3), (2, 3), (1, 4), (3, 4), (1, 5), (2, 5), (3, 5), (4, 5)),
                *((1, 6), (5, 6), (1, 8), (3, 8), (5, 8), (7, 8)),
            )
        ),
        strict=True,
    )
)
_SMALL = [
    "zero",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
    "thirteen",
    "fourteen",
    "fifteen",
    "sixteen",
    "seventeen",
    "eighteen",
    "nineteen",
]
_TENS = ["twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"]
_NUMBER_WORDS: Mapping[str, int] = {
    **{word: value for value, word in enumerate(_SMALL)},
    **{word: 10 * value for value, word in enumerate(_TENS, 2)},
}

_LONG_LIST = 6
"""Lists of at least this many numbers become one word: the parser's time grows with lists."""

_AMOUNT_KINDS = frozenset(["NUM", "ONE", "A", "HALF", "QUARTER_OF"])


@dataclass(frozen=True, slots=True)
class Word:
    """One terminal: its kind, its text as written, its [start, end) in the text, its value."""

    kind: str
    text: str
    start: int
    end: int
    value: object = None


class Vocabulary:
    """The words and fixed phrases of the grammar, with their terminals."""

    def __init__(self, terminals: Mapping[str, str]) -> None:
        self._phrases: dict[str, list[tuple[tuple[str, ...], str]]] = {}
        for phrase, kind in terminals.items():
            parts = tuple(raw.group().lower() for raw in _RAW.finditer(phrase))
            self._phrases.setdefault(parts[0], []).append((parts, kind))
        for known in self._phrases.values():
            known.sort(key=lambda entry: -len(entry[0]))

    def match(self, texts: Sequence[str], at: int) -> tuple[int, str] | None:
        """(the number of words of the longest known phrase at `at`, its terminal)."""
        for parts, kind in self._phrases.get(texts[at], ()):
            if len(parts) == 1 or tuple(texts[at : at + len(parts)]) == parts:
                return len(parts), kind
        return None

    def knows(self, word: str) -> bool:
        """Whether a phrase begins with this word."""
        return word in self._phrases


@dataclass(frozen=True, slots=True)
class _Raw:
    group: str
    text: str
    start: int
    end: int


def words_of(
    text: str,
    start: int,
    end: int,
    vocabulary: Vocabulary,
    labels: Collection[str],
    names: StepNames | None = None,
) -> list[Word]:
    """The words of text[start:end].

    `labels` are the steps' labels that are not numbers; with `names`, steps' own texts count as
    one word each.
    """
    raws = [
        _Raw(str(m.lastgroup), m.group(), m.start(), m.end())
        for m in _RAW.finditer(text, start, end)
    ]
    texts = [raw.text.lower().replace("’", "'") for raw in raws]
    return _with_long_lists(list(_words(text, raws, texts, vocabulary, labels, names)))


def _words(
    text: str,
    raws: Sequence[_Raw],
    texts: Sequence[str],
    vocabulary: Vocabulary,
    labels: Collection[str],
    names: StepNames | None,
) -> Iterator[Word]:
    at, before = 0, ""
    while at < len(raws):
        if names is not None and (count := _named(names, texts, at, vocabulary)):
            start, end = raws[at].start, raws[at + count - 1].end
            yield Word("NAME", text[start:end], start, end, text[start:end])
            before, at = "NAME", at + count
            continue
        count, kind, value = _kind(raws, texts, at, before, vocabulary, labels)
        last = raws[at + count - 1]
        if kind:
            written = (
                raws[at].text if count == 1 else " ".join(r.text for r in raws[at : at + count])
            )
            yield Word(kind, written, raws[at].start, last.end, value)
            before = kind
        at += count


def _named(names: StepNames, texts: Sequence[str], at: int, vocabulary: Vocabulary) -> int:
    """The number of words at `at` that are a step's own text; a word of the language is not."""
    word = texts[at]
    common = vocabulary.knows(word) or word in _NUMBER_WORDS or word in UNITS or not word.isalpha()
    return names.match(texts, at, 2 if common else 1)


def _kind(
    raws: Sequence[_Raw],
    texts: Sequence[str],
    at: int,
    before: str,
    vocabulary: Vocabulary,
    labels: Collection[str],
) -> tuple[int, str, object]:
    """(the number of raw words of the next word, its kind or "" to leave it out, its value)."""
    raw, text = raws[at], texts[at]
    if raw.group in ("num", "vulgar"):
        return _number(raws, at, labels)
    if raw.group == "hash":
        return _hash(raws, at)
    if raw.group == "tag":
        return 1, "TAG", None
    if raw.group == "quote":
        return 1, "QUOTE", raw.text[1:-1]
    if raw.text in labels:
        return 1, "LABEL", raw.text
    if text in UNITS and _is_unit(texts, at, before, vocabulary):
        # "5 min. 30 sec": the point belongs to the unit.
        pointed = at + 1 < len(raws) and texts[at + 1] == "." and raws[at + 1].start == raw.end
        return (2 if pointed else 1), "UNIT", text
    if found := vocabulary.match(texts, at):
        return found[0], found[1], None
    if text in _NUMBER_WORDS:
        return _number_words(texts, at)
    return 1, (WORD if raw.group in ("word", "label") else OTHER), None


def _hash(raws: Sequence[_Raw], at: int) -> tuple[int, str, object]:
    """A heading's "#", or that of "#3", which is left out."""
    following = raws[at + 1] if at + 1 < len(raws) else None
    if following is None or following.start > raws[at].end:
        return 1, ("HASH" if at == 0 else OTHER), None
    return 1, ("" if following.group == "num" else OTHER), None


def _is_unit(texts: Sequence[str], at: int, before: str, vocabulary: Vocabulary) -> bool:
    """Whether a word is a unit: short units only after a number, "second" not before "step"."""
    counted = before in _AMOUNT_KINDS
    if texts[at] == "second":
        following = vocabulary.match(texts, at + 1) if at + 1 < len(texts) else None
        return counted and (following is None or following[1] != "STEP")
    return counted or (len(texts[at]) > 3 and texts[at] != "mins")


def _number(raws: Sequence[_Raw], at: int, labels: Collection[str]) -> tuple[int, str, object]:
    raw = raws[at]
    if len(raw.text) > MAX_DIGITS:
        return 1, OTHER, None
    following = raws[at + 1] if at + 1 < len(raws) else None
    if following is not None and following.start == raw.end and raw.text + following.text in labels:
        return 2, "LABEL", raw.text + following.text
    fraction = _fraction(raws, at)
    if fraction is not None:
        return fraction[0], "NUM", fraction[1]
    if (dated := _clock_or_date(raws, at)) is not None:
        return dated
    digits = raw.text.replace(",", "")
    whole = Fraction(int(digits) if digits.isdigit() else digits)
    if raw.text.isdigit() and (mixed := _fraction(raws, at + 1)) and mixed[1] < 1:
        return 1 + mixed[0], "NUM", whole + mixed[1]
    if following is not None and following.text in "/:" and following.start == raw.end:
        return 1, OTHER, None  # A clock time, or an impossible fraction.
    return 1, "NUM", whole


def _clock_or_date(raws: Sequence[_Raw], at: int) -> tuple[int, str, object] | None:
    """A time of day ("8:30") or a date ("2026-03-02"), written without spaces."""
    for count, kind, pattern in ((3, "CLOCK", _CLOCK), (5, "DATE", _DATE)):
        parts = raws[at : at + count]
        joined = all(a.end == b.start for a, b in pairwise(parts))
        text = "".join(part.text for part in parts)
        if len(parts) == count and joined and pattern.fullmatch(text):
            return count, kind, f"{text:0>5}" if kind == "CLOCK" else text
    return None


_CLOCK = re.compile(r"(?:[01]?[0-9]|2[0-3]):[0-5][0-9]|24:00")
_DATE = re.compile(r"[0-9]{4}-(?:0[1-9]|1[0-2])-(?:0[1-9]|[12][0-9]|3[01])")


def _fraction(raws: Sequence[_Raw], at: int) -> tuple[int, Fraction] | None:
    """(the number of raw words at `at` that are a fraction ("1/2", "½"), its value)."""
    if at < len(raws) and raws[at].group == "vulgar":
        return 1, _VULGAR[raws[at].text]
    parts = raws[at : at + 3]
    if (
        len(parts) == 3
        and parts[1].text in ("/", "⁄")
        and parts[0].text.isdigit()
        and parts[2].text.isdigit()
        and len(parts[0].text) <= MAX_DIGITS
        and len(parts[2].text) <= MAX_DIGITS
        and int(parts[2].text) > 0
        and not (at + 3 < len(raws) and raws[at + 3].text == "/")
    ):
        return 3, Fraction(int(parts[0].text), int(parts[2].text))
    return None


def _number_words(texts: Sequence[str], at: int) -> tuple[int, str, object]:
    value, count = _NUMBER_WORDS[texts[at]], 1
    rest = texts[at + 1 : at + 3]
    if texts[at] in _TENS:
        if rest[:1] == ["-"] and len(rest) == 2 and 1 <= _NUMBER_WORDS.get(rest[1], 0) <= 9:
            value, count = value + _NUMBER_WORDS[rest[1]], 3
        elif rest and 1 <= _NUMBER_WORDS.get(rest[0], 0) <= 9:
            value, count = value + _NUMBER_WORDS[rest[0]], 2
    return count, "NUM", Fraction(value)


def _with_long_lists(words: list[Word]) -> list[Word]:
    """The same words, with each long list of numbers after "step" as one word."""
    if len(words) < 2 * _LONG_LIST:
        return words
    merged: list[Word] = []
    at = 0
    while at < len(words):
        members, after = _listed(words, at) if _follows_step(merged) else ([], at)
        if len(members) >= _LONG_LIST:
            written = f"{members[0].text}, …, {members[-1].text}"
            merged.append(Word("NUMS", written, members[0].start, members[-1].end, tuple(members)))
            at = after
        else:
            merged.append(words[at])
            at += 1
    return merged


def _follows_step(words: Sequence[Word]) -> bool:
    return bool(words) and words[-1].kind in ("STEP", "STEPS")


def _listed(words: Sequence[Word], at: int) -> tuple[list[Word], int]:
    """(the numbers of "1, 2, step 3" from `at` on, the end of the list)."""
    members: list[Word] = []
    while at < len(words) and words[at].kind in ("NUM", "LABEL"):
        following = words[at + 1].kind if at + 1 < len(words) else ""
        if following in ("UNIT", "DASH", "TO", "AND"):
            break
        members.append(words[at])
        if following != "COMMA":
            return members, at + 1
        ahead = at + 3 if at + 2 < len(words) and words[at + 2].kind == "STEP" else at + 2
        if ahead >= len(words) or words[ahead].kind not in ("NUM", "LABEL"):
            return members, at + 1
        nearest = words[ahead + 1].kind if ahead + 1 < len(words) else ""
        if nearest in ("UNIT", "DASH", "TO"):
            return members, at + 1
        if nearest == "AND":
            # The last but one: "…, 5 and 6" ends with a list of its own in the grammar.
            members.append(words[ahead])
            return members, ahead + 1
        at = ahead
    return members, at
