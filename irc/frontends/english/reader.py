"""A text in controlled English → the raw IR document, or every fault of the text."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Pointer, Range, Source
from irc.frontends.english.assembly import Assembly
from irc.frontends.english.layout import (
    Block,
    Item,
    Paragraph,
    Span,
    blocks_of,
    without_emphasis,
)
from irc.frontends.english.names import StepNames
from irc.frontends.english.reasons import TextFault, Unclear, not_understood, shown
from irc.frontends.english.references import ListedStep, SentenceSpan
from irc.frontends.english.sentences import Sentence, sentences_of
from irc.frontends.english.statements import Frame, Statement
from irc.frontends.english.steps import StepText, hidden_order, is_optional, order_cue, read_step
from irc.frontends.english.understanding import Reader
from irc.frontends.json.document import RawDocument

MAX_CHARACTERS = 20_000_000
"""Longer texts are refused: nobody wrote them by hand, and reading them takes minutes."""

_MOST_PROBLEMS = 200
_MOST_JOINED = 4
_KINDS = ("named", "numbered", "bullet")
"""Kinds of markers, the most telling first: the steps are the items that have it."""


def read_english(text: str, name: str) -> RawDocument:
    """The raw IR document of an English text.

    Raises `InputError` with every sentence that is not understood and every fault of the text.
    """
    findings = Findings()
    if text.startswith("\ufeff"):
        findings.add(Code.BYTE_ORDER_MARK, "a byte-order mark at the start is ignored", offset=0)
        text = text[1:]
    source = Source(name, text)
    if len(text) > MAX_CHARACTERS:
        findings.add(
            Code.TOO_LARGE,
            f"the text has {len(text):,} characters; irc reads at most {MAX_CHARACTERS:,} "
            "as English",
        )
        raise InputError(Report(tuple(findings.items), source))
    assembly = _Text(text).assembled()
    for problem in assembly.problems[:_MOST_PROBLEMS]:
        findings.add(problem.code, problem.message, hint=problem.hint, offset=problem.offset)
    if assembly.problems:
        raise InputError(Report(tuple(findings.items), source))
    content, places = assembly.document()
    return RawDocument(content, Source(name, text, _Locator(places)), findings)


@dataclass(frozen=True, slots=True)
class _Locator:
    """Finds the places of elements."""

    places: Mapping[Pointer, Range]

    def __call__(self, _text: str, wanted: frozenset[Pointer]) -> Mapping[Pointer, Range]:
        return {pointer: self.places[pointer] for pointer in wanted if pointer in self.places}


class _Text:
    """The reading of one text."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.blocks = blocks_of(without_emphasis(text))
        labels = {_label(b) for b in self.blocks if isinstance(b, Item)}
        self.reader = Reader(
            without_emphasis(text), frozenset(x for x in labels if isinstance(x, str))
        )
        self.starts: list[int] = []
        """The offsets of the steps, once they are known."""
        self.own: dict[int, int] = {}
        """The number of lines of an item that are its own text."""

    def assembled(self) -> Assembly:
        """All statements of the text, collected in order."""
        items = self._step_items()
        steps = [self._step(item, step_text) for item, step_text in items]
        names = StepNames([step.title for step in steps])
        self.reader.names = names
        assembly = Assembly(self.text, steps, names)
        if not steps:
            assembly.problems.append(self._no_steps())
        self.reader.steps_at = steps[0].place.start if steps else len(self.text)
        position_of = {id(item): position for position, (item, _) in enumerate(items)}
        text_of = {id(item): step_text for item, step_text in items}
        if not steps:
            return assembly
        for block in self.blocks:
            position = position_of.get(id(block))
            self._take(block, position, text_of.get(id(block)), assembly)
            if len(assembly.problems) > _MOST_PROBLEMS:
                return assembly
        self._judge_labels(assembly)
        self._judge(items, assembly)
        assembly.finish()
        return assembly

    # Which items are steps

    def _step_items(self) -> list[tuple[Item, StepText]]:
        items = [b for b in self.blocks if isinstance(b, Item)]
        kinds = {_item_kind(item) for item in items}
        if len(kinds) > 1:
            kinds = {_item_kind(i) for i in items if not self._is_bare_note(i)} or kinds
        kind = next((kind for kind in _KINDS if kind in kinds), _KINDS[0])
        chosen: list[tuple[Item, StepText]] = []
        listing = True
        indent: int | None = None
        for block in self.blocks:
            if isinstance(block, Paragraph):
                listing = not self._heads_orders(block.lines) and (
                    listing or self._heads_steps(block.lines)
                )
                continue
            if _item_kind(block) != kind:
                continue
            if indent is None:
                indent = block.indent
            lines = self._own_lines(block)
            step_text = read_step(self.reader, lines)
            self.own[id(block)] = len(lines)
            if not step_text.timed and (
                self._is_said(block) or block.indent > indent or not (listing or block.named)
            ):
                continue
            chosen.append((block, step_text))
            listing = listing and not self._heads_orders(block.more)
        return chosen

    def _is_bare_note(self, item: Item) -> bool:
        """Whether an item has no text but a note: "Step 3: 5 minutes"."""
        try:
            return self.reader.note(*item.body) is not None
        except Unclear:
            return True

    def _own_lines(self, item: Item) -> list[Span]:
        """The lines of an item's own text: its first line and the lines that continue it."""
        lines = [item.body]
        for line in item.more:
            if self._understood(sentences_of(self.reader.text, [line])) or lines[-1][1] == 0:
                break
            lines.append(line)
        return lines

    def _heads_orders(self, lines: list[Span]) -> bool:
        said = self._statements(sentences_of(self.reader.text, lines[-1:]))
        return any(isinstance(s, Frame) and s.kind == "orders" for s in said)

    def _heads_steps(self, lines: list[Span]) -> bool:
        said = self._statements(sentences_of(self.reader.text, lines[-1:]))
        return any(isinstance(s, Frame) and s.kind in ("plain", "titled") for s in said)

    def _is_said(self, item: Item) -> bool:
        """Whether an item without a duration is a sentence about steps, not a step."""
        for span in (item.body, item.line):
            if self._understood(sentences_of(self.reader.text, [span])):
                return True
        return False

    def _understood(self, sentences: Sequence[Sentence]) -> bool:
        try:
            return bool(sentences) and all(
                self.reader.sentence(s) is not None and not _is_frame(self.reader.sentence(s))
                for s in sentences
            )
        except Unclear:
            return True

    def _statements(self, sentences: Sequence[Sentence]) -> Iterator[Statement]:
        for sentence in sentences:
            try:
                yield from self.reader.sentence(sentence) or ()
            except Unclear:
                continue

    def _step(self, item: Item, step_text: StepText) -> ListedStep:
        start, end = step_text.title
        title = " ".join(self.reader.text[start:end].split()).rstrip(" .,;:-–—")
        return ListedStep(_label(item), title, Range(item.line[0], item.line[1]))

    # Statements

    def _take(
        self, block: Block, position: int | None, step_text: StepText | None, assembly: Assembly
    ) -> None:
        text = self.reader.text
        if isinstance(block, Paragraph):
            lines = block.lines
            if block is self.blocks[0] and assembly.name is None and self._is_heading(lines[0]):
                assembly.name = self.reader.title = text[slice(*lines[0])].rstrip(" :")
                lines = lines[1:]
            self._take_sentences(sentences_of(text, lines), None, assembly)
            return
        if step_text is None:
            self._take_item(block, assembly)
            return
        assembly.problems += step_text.problems
        for statements, (start, end) in step_text.notes:
            assembly.take(statements, SentenceSpan(start, end, position))
        below = block.more[self.own[id(block)] - 1 :]
        for sentence in step_text.rest:
            self._take_remark(sentence, position, assembly)
        self._take_sentences(sentences_of(text, below), position, assembly)

    def _is_heading(self, line: Span) -> bool:
        """Whether the first line is only a title: "Baking a cake"."""
        sentences = sentences_of(self.reader.text, [line])
        if len(sentences) != 1 or self.text[line[1] - 1] in ".!?":
            return False
        try:
            understood = self.reader.sentence(sentences[0]) is not None
        except Unclear:
            return False
        return not understood and self.reader.heading(sentences[0].start, sentences[0].end)

    def _take_item(self, item: Item, assembly: Assembly) -> None:
        """Reads an item that is not a step: a sentence of the list, with or without its marker."""
        text = self.reader.text
        labelled = assembly.find.position(_label(item))
        if labelled is not None and self._is_bare_note(item):
            try:
                said = self.reader.note(*item.body) or ()
            except Unclear as unclear:
                assembly.problems.append(unclear.problem)
            else:
                assembly.take(said, SentenceSpan(item.line[0], item.line[1], labelled))
            self._take_sentences(sentences_of(text, item.more), labelled, assembly)
            return
        position = self._step_above(item, assembly)
        for span in (item.body, item.line):
            sentences = sentences_of(text, [span, *item.more])
            if self._understood(sentences):
                self._take_sentences(sentences, position, assembly)
                return
        self._take_sentences(sentences_of(text, [item.body, *item.more]), position, assembly)

    def _step_above(self, item: Item, assembly: Assembly) -> int | None:
        """The step under which an item is indented."""
        if item.indent == 0:
            return None
        starts = [step.place.start for step in assembly.steps] if not self.starts else self.starts
        self.starts = starts
        position = bisect_left(starts, item.line[0]) - 1
        if position < 0:
            return None
        above = starts[position]
        return position if item.indent > above - (self.text.rfind("\n", 0, above) + 1) else None

    def _take_remark(self, sentence: Sentence, position: int | None, assembly: Assembly) -> None:
        """A sentence behind a step's own: understood, or a harmless part of the description."""
        try:
            said = self.reader.sentence(sentence)
        except Unclear as unclear:
            assembly.problems.append(unclear.problem)
            return
        if said is not None:
            assembly.take(said, SentenceSpan(sentence.start, sentence.end, position))
            return
        problem = not_understood(self.text, sentence.start, sentence.end)
        assembly.problems.append(problem)

    def _take_sentences(
        self, sentences: Sequence[Sentence], position: int | None, assembly: Assembly
    ) -> None:
        at = 0
        while at < len(sentences):
            count = 1
            try:
                said, count = self._next(sentences, at)
            except Unclear as unclear:
                assembly.problems.append(unclear.problem)
            else:
                whole = sentences[at].joined(sentences[at + count - 1])
                if said is None:
                    assembly.problems.append(not_understood(self.text, whole.start, whole.end))
                else:
                    self._note_title(said)
                    assembly.take(said, SentenceSpan(whole.start, whole.end, position))
            at += count
            if len(assembly.problems) > _MOST_PROBLEMS:
                return

    def _note_title(self, said: Sequence[Statement]) -> None:
        for statement in said:
            if isinstance(statement, Frame) and statement.kind == "titled":
                self.reader.title = statement.text

    def _next(
        self, sentences: Sequence[Sentence], at: int
    ) -> tuple[tuple[Statement, ...] | None, int]:
        """(the statements of the next sentence, the number of its pieces)."""
        first = sentences[at]
        if first.open:
            for count in range(_MOST_JOINED, 1, -1):
                pieces = sentences[at : at + count]
                if len(pieces) == count and all(piece.open for piece in pieces[:-1]):
                    try:
                        said = self.reader.sentence(first.joined(pieces[-1]))
                    except Unclear:
                        continue
                    if said is not None:
                        return said, count
        said = self.reader.sentence(first)
        if said is not None or first.open:
            return said, 1
        for count in (2, 3):
            pieces = sentences[at : at + count]
            whole = first.joined(pieces[-1])
            if len(pieces) == count and "\n" not in self.text[whole.start : whole.end]:
                said = self.reader.sentence(whole)
                if said is not None:
                    return said, count
        return None, 1

    # The whole

    def _judge_labels(self, assembly: Assembly) -> None:
        """Reports different steps with one number; the checks report exact repetitions."""
        first: dict[int | str, ListedStep] = {}
        for step in assembly.steps:
            if step.label is None:
                continue
            earlier = first.setdefault(step.label, step)
            if (earlier.title, earlier.time) != (step.title, step.time):
                line = self.text.count("\n", 0, earlier.place.start) + 1
                assembly.problems.append(
                    TextFault(
                        Code.DUPLICATE_ID,
                        f"step {step.label} is listed twice with different contents",
                        step.place.start,
                        f"it is listed first in line {line}; give one of the two another number",
                    )
                )

    def _judge(self, items: Sequence[tuple[Item, StepText]], assembly: Assembly) -> None:
        for step, (item, step_text) in zip(assembly.steps, items, strict=True):
            quoted = shown(self.text[item.line[0] : item.line[1]])
            if step.time is None and not step_text.problems:
                assembly.problems.append(
                    TextFault(
                        Code.NO_DURATION,
                        f"a step without a duration: {quoted}",
                        item.line[0],
                        'write it in parentheses at the end: "(10 minutes)"',
                    )
                )
            if not assembly.listed_orders and (cue := order_cue(self.text, step_text.title)):
                assembly.problems.append(
                    TextFault(
                        Code.AMBIGUOUS,
                        f"{shown(cue[0])} in the text of a step: after which steps? {quoted}",
                        cue.start(),
                        'say the order in a sentence: "Step 2 must precede step 3."',
                    )
                )
            if not assembly.listed_orders and (
                hidden := hidden_order(self.reader, step_text.title)
            ):
                assembly.problems.append(
                    TextFault(
                        Code.AMBIGUOUS,
                        f"the text of a step speaks of another step or of the order: {quoted}",
                        hidden,
                        'say the order in a sentence: "Step 2 must precede step 3.", or announce '
                        'all orders with "These ordering constraints must be obeyed:"',
                    )
                )
            if not assembly.all_needed and is_optional(self.text, step_text.title):
                assembly.problems.append(
                    TextFault(
                        Code.VAGUE,
                        f"is the step left out or not? {quoted}",
                        item.line[0],
                        'say "All steps must be executed.", or take the step out',
                    )
                )
        if (
            not assembly.ordered
            and len({s.label for s in assembly.steps}) > 1
            and not assembly.problems
        ):
            assembly.problems.append(
                TextFault(
                    Code.NO_ORDER,
                    "the text does not say in which order the steps must be done",
                    assembly.steps[0].place.start,
                    'say "Step 1 must precede step 2.", "The steps must be done in this order." or '
                    '"The steps can be done in any order."',
                )
            )

    def _no_steps(self) -> TextFault:
        stripped = self.text.lstrip()
        return TextFault(
            Code.NO_STEPS,
            "the text is empty" if not stripped else "there is no list of steps in the text",
            min(len(self.text) - len(stripped), max(0, len(self.text) - 1)),
            'write each step on a line of its own: "Step 1. Boil the water (10 minutes)"',
        )


def _is_frame(said: Any) -> bool:
    return bool(said) and all(isinstance(s, Frame) and s.kind == "titled" for s in said)


def _label(item: Item) -> int | str | None:
    if item.label is None:
        return None
    return int(item.label) if item.label.isdigit() else item.label


def _item_kind(item: Item) -> str:
    if item.named:
        return "named"
    return "bullet" if item.label is None else "numbered"
