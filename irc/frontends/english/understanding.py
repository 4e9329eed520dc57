"""Finds the statements of a piece of text, or the reason why it has none."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from irc.diagnostics import Code
from irc.frontends.english.meaning import Inexact, meaning
from irc.frontends.english.names import StepNames
from irc.frontends.english.parsing import LONGEST, TooManyReadings, sentence_parser
from irc.frontends.english.reasons import TextFault, Unclear, because, not_understood, shown
from irc.frontends.english.sentences import Sentence
from irc.frontends.english.statements import EachAfterPrevious, Frame, Refused, Statement, Takes
from irc.frontends.english.things import thing_spans, with_things
from irc.frontends.english.words import Word, words_of

_LONGEST_TEXT = 20_000
"""Longer sentences are refused before they are parsed."""

_HEADS = frozenset(["TO", "FOR", "OF", "COLON", "HASH", "MUST", "YOU_MUST", "WANT_TO", "CAN"])
_TAILS = frozenset(
    [
        "COMMA",
        "REQUIRE",
        "INVOLVE",
        "HAVE",
        "HERE_ARE",
        "THE_FOLLOWING",
        "THESE",
        "YOU_MUST",
        "COLON",
    ]
)
_MOST_ENDS = 5
_LONGEST_TITLE = 8

_LIMITS = frozenset(["AT_A_TIME", "AT_MOST", "NO_TWO", "OVERLAP", "CANNOT"])
"""Words that no goal has: free text with one of them limits the steps."""

_ANNOUNCING = frozenset(["HERE_ARE", "THE_FOLLOWING", "THESE"])
_ONLY = re.compile(
    r"\bonly (?:one|two|three|a|\d+)\b|\b(?:one|single|two|\d+) (?:person|people|cooks?|workers?|"
    r"ovens?|stoves?|burners?|machines?)\b",
    re.IGNORECASE,
)
_CONDITIONAL = re.compile(
    r"\b(?:if|when|assuming|provided|given that|unless|without|only|alone|limited|single|except|"
    r"but|while|once|after|before|until|by|within|using|deadline|"
    r"with (?:an?|the|just|one|two|\d+))\b",
    re.IGNORECASE,
)


class Reader:
    """Finds the statements of pieces of one text; knows its steps' labels and names."""

    def __init__(self, text: str, labels: Collection[str]) -> None:
        self.text = text
        self.labels = labels
        self.names = StepNames(())
        self.steps_at = len(text)
        """The offset of the first step."""
        self.title: str | None = None
        """The goal that the text names; its question may repeat it."""
        self._parser = sentence_parser()

    def sentence(self, piece: Sentence) -> tuple[Statement, ...] | None:
        """The statements of a sentence; None if it is not understood. Raises `Unclear`."""
        if piece.end - piece.start > _LONGEST_TEXT:
            raise self._too_long(piece.start, piece.end)
        words = self._words(piece)
        found = self._readings(words, "sentence", piece)
        if found is None and self.names:
            named = self._words(piece, self.names)
            if any(word.kind == "NAME" for word in named):
                found = self._readings(named, "sentence", piece)
        if found is None:
            found = self._of_things(piece)
        return self._framed(words, piece) if found is None else found

    def _of_things(self, piece: Sentence) -> tuple[Statement, ...] | None:
        """The statements of a sentence that names things: its names are one word each."""
        for spans in thing_spans(self.text, piece.start, piece.end):
            for names in (None, self.names) if self.names else (None,):
                words = with_things(self._words(piece, names), spans, self.text)
                if (found := self._readings(words, "sentence", piece)) is not None:
                    return found
        return None

    def note(self, start: int, end: int) -> tuple[Statement, ...] | None:
        """The statements of a note beside a step's text, such as its duration. Raises `Unclear`."""
        if end - start > _LONGEST_TEXT:
            raise self._too_long(start, end)
        piece = Sentence(start, end)
        words = self._words(piece)
        if words and words[-1].text == ".":
            words.pop()
        return self._readings(words, "note", piece)

    def _too_long(self, start: int, end: int) -> Unclear:
        return Unclear(
            TextFault(
                Code.NOT_UNDERSTOOD,
                f"this sentence is too long ({end - start:,} characters): "
                f"{shown(self.text[start : start + 200])}",
                start,
                "write shorter sentences, each with a full stop at its end",
            )
        )

    def _words(self, piece: Sentence, names: StepNames | None = None) -> list[Word]:
        vocabulary = self._parser.vocabulary
        words = words_of(self.text, piece.start, piece.end, vocabulary, self.labels, names)
        if piece.asked:
            words.append(Word("QMARK", "?", piece.end, piece.end + 1))
        return words

    def _readings(
        self, words: Sequence[Word], start: str, piece: Sentence
    ) -> tuple[Statement, ...] | None:
        """The one meaning of the words. Raises `Unclear` if there are several."""
        if len(words) > LONGEST:
            raise self._too_long(piece.start, piece.end)
        quoted = self.text[piece.start : piece.end]
        try:
            found = self._parser.derivations(words, start)
        except TooManyReadings:
            raise Unclear(_ambiguous(quoted, piece.start)) from None
        meanings: dict[tuple[Statement, ...], None] = {}
        inexact: list[str] = []
        for derivation in found:
            try:
                meanings[meaning(derivation, words)] = None
            except Inexact as reason:
                inexact.append(str(reason))
        said = _sensible(list(meanings))
        refused = [s.reason for m in said for s in m if isinstance(s, Refused)] or (
            inexact if not said else []
        )
        if refused:
            raise Unclear(because(refused[0], piece.start, quoted))
        if len(said) > 1:
            raise Unclear(_ambiguous(quoted, piece.start))
        return said[0] if said else None

    def heading(self, start: int, end: int) -> bool:
        """Whether a line is a title: a few plain words, nothing that limits or orders."""
        piece = Sentence(start, end)
        words = self._words(piece)
        if not 0 < len(words) <= _LONGEST_TITLE or any(w.kind == "NUM" for w in words):
            return False
        harmless = self._harmless(words, 0, len(words), self.text[start:end])
        return harmless and not_understood(self.text, start, end).code is Code.NOT_UNDERSTOOD

    # Sentences of the frame hold free text: the goal of the task.

    def _framed(self, words: Sequence[Word], piece: Sentence) -> tuple[Statement, ...] | None:
        headed = bool(words) and words[0].kind in ("HASH", "GOAL")
        if headed and (self.title is not None or piece.start > self.steps_at):
            return None  # A second heading is not a title.
        for first, last in _free_parts(words):
            start, end = words[first].start, words[last - 1].end
            free = self.text[start:end]
            if not self._harmless(words, first, last, free):
                continue
            hidden = Word("FREE", free, start, end, free)
            found = self._readings([*words[:first], hidden, *words[last:]], "sentence", piece)
            if found and all(isinstance(statement, Frame) for statement in found):
                return tuple(
                    replace(s, text=" ".join(s.text.split())) if s.text else s
                    for s in found
                    if isinstance(s, Frame)
                )
        return None

    def _harmless(self, words: Sequence[Word], first: int, last: int, free: str) -> bool:
        """Whether free text is a goal and nothing else: no steps, no limits, no conditions."""
        if self.title is not None and _plain(free) == _plain(self.title):
            return True
        kinds = [word.kind for word in words[first:last]]
        numbered = any(
            kind in ("STEP", "STEPS") and following in ("NUM", "NUMS", "LABEL")
            for kind, following in itertools.pairwise(kinds)
        )
        if numbered or not _LIMITS.isdisjoint(kinds) or _ONLY.search(free):
            return False
        if any(word.kind in _ANNOUNCING for word in words[last:]):
            return True  # "To know if you are ill, here are the steps needed."
        return "UNIT" not in kinds and not _CONDITIONAL.search(free)


def _plain(text: str) -> str:
    return " ".join(text.lower().strip(" .?!:").split())


def _ambiguous(quoted: str, offset: int) -> TextFault:
    return TextFault(
        Code.AMBIGUOUS,
        f"this can be read in more than one way: {shown(quoted)}",
        offset,
        "write one sentence for each order",
    )


def _sensible(meanings: list[tuple[Statement, ...]]) -> list[tuple[Statement, ...]]:
    """Without readings that no one means: of "2 hours, 30 minutes" as two durations of one step,
    of "each step … the previous one" as one step before all.
    """
    if following := [m for m in meanings if any(isinstance(s, EachAfterPrevious) for s in m)]:
        return following
    single = [m for m in meanings if sum(isinstance(s, Takes) for s in m) <= 1]
    return single or meanings


def _free_parts(words: Sequence[Word]) -> Iterator[tuple[int, int]]:
    """[first, last) of what may be free text, the shortest first."""
    end = len(words)
    while end and words[end - 1].kind in ("QMARK", "COLON"):
        end -= 1
    heads = [0, *(i + 1 for i, w in enumerate(words[:end]) if w.kind in _HEADS)][: 2 * _MOST_ENDS]
    tails = [i for i, w in enumerate(words[:end]) if w.kind in _TAILS]
    tails = [*tails[: 2 * _MOST_ENDS], *tails[2 * _MOST_ENDS :][-_MOST_ENDS:], end]
    pairs = {(first, last) for first in heads for last in tails if first < last}
    yield from sorted(pairs, key=lambda pair: (pair[1] - pair[0], pair))
