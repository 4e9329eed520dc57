"""Finds the steps (by position) that references mean."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from irc.diagnostics import Code
from irc.diagnostics.source import Range
from irc.frontends.english.names import StepNames
from irc.frontends.english.reasons import TextFault, Unclear, because, shown
from irc.frontends.english.statements import Ref, Refs, Time

MOST_EDGES = 1_000_000
"""A text whose sentences mean more precedences than this is refused."""


@dataclass
class ListedStep:
    """A step of the list."""

    label: int | str | None
    title: str
    place: Range
    time: Time | None = None
    time_place: Range | None = None

    def id(self, position: int) -> str:
        """Its id in the IR."""
        return f"step{position + 1 if self.label is None else self.label}"


@dataclass(frozen=True)
class SentenceSpan:
    """The span of a sentence, and the step (by position) to whose item it belongs."""

    start: int
    end: int
    step: int | None = None


@dataclass
class Finder:
    """Finds the steps that references mean, in one text."""

    text: str
    steps: Sequence[ListedStep]
    names: StepNames
    _by_label: dict[int | str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        unlabelled = all(step.label is None for step in self.steps)
        for position, step in enumerate(self.steps):
            label = position + 1 if unlabelled else step.label
            if label is not None:
                self._by_label.setdefault(label, position)

    def position(self, label: int | str | None) -> int | None:
        """The step with a label."""
        return None if label is None else self._by_label.get(label)

    def positions(
        self, refs: Refs, span: SentenceSpan, others: Sequence[int] | None = None
    ) -> list[int]:
        """The steps that references mean. `others`: those on the other side of the order."""
        found: dict[int, None] = {}
        for ref in refs:
            for position in self._resolved(ref, span, others):
                found[position] = None
                if len(found) > MOST_EDGES:
                    raise self.too_many(span)
        return list(found)

    def _resolved(
        self, ref: Ref, span: SentenceSpan, others: Sequence[int] | None
    ) -> Iterator[int]:
        count = len(self.steps)
        match ref.kind:
            case "label":
                yield self._labelled(ref.value[0], ref)
            case "range":
                yield from self._range(ref, span)
            case "name":
                yield self._named(ref)
            case "nth" | "first" | "last":
                place = {"first": 1, "last": count}.get(ref.kind) or ref.value[0]
                yield self._nth(place, ref, span)
            case "this":
                if span.step is None:
                    raise Unclear(self.because("this", span, ref.start))
                yield span.step
            case "all":
                yield from (p for p in range(count) if others is None or p not in others)
            case "all_other" if others is not None:
                beside = set(others)
                yield from (p for p in range(count) if p not in beside)
            case "previous" | "all_previous" if others is not None and len(others) == 1:
                yield from self._previous(ref, others[0], span)
            case "previous" if span.step is not None:
                yield from self._previous(ref, span.step, span)
            case _:
                raise Unclear(self.because("nested", span, ref.start))

    def _previous(self, ref: Ref, position: int, span: SentenceSpan) -> Iterator[int]:
        if ref.kind == "all_previous":
            yield from range(position)
        elif position == 0:
            raise Unclear(self._unknown("there is no step before the first", ref.start))
        else:
            yield position - 1

    def _labelled(self, label: int | str, ref: Ref) -> int:
        position = self._by_label.get(label)
        if position is None:
            raise Unclear(self._unknown(f"there is no step {label}", ref.start))
        return position

    def _range(self, ref: Ref, span: SentenceSpan) -> Iterator[int]:
        low, high = ref.value
        if not (isinstance(low, int) and isinstance(high, int)) or low > high:
            raise Unclear(self._unknown(f"{low} to {high} is no range of steps", ref.start))
        if high - low > MOST_EDGES:
            raise Unclear(self._unknown(f"there is no step {high}", ref.start))
        for label in range(low, high + 1):
            yield self._labelled(label, ref)

    def _named(self, ref: Ref) -> int:
        positions = self.names.steps(ref.value[0])
        if not positions:
            raise Unclear(self._unknown(f"there is no step {shown(ref.value[0])}", ref.start))
        if len(positions) > 1:
            raise Unclear(
                TextFault(
                    Code.AMBIGUOUS,
                    f"{len(positions)} steps have the text {shown(ref.value[0])}",
                    ref.start,
                    "name the step by its number",
                )
            )
        return positions[0]

    def _nth(self, place: int, ref: Ref, span: SentenceSpan) -> int:
        """The step at a place of the list; where the steps have numbers they must agree."""
        if place > len(self.steps):
            raise Unclear(self._unknown(f"there is no step {place}", ref.start))
        label = self.steps[place - 1].label
        if isinstance(label, int) and label != place and ref.kind == "nth":
            raise Unclear(self.because("label", span, ref.start))
        return place - 1

    def _unknown(self, message: str, offset: int) -> TextFault:
        labels = [str(s.label) for s in self.steps if s.label is not None]
        hint = "the text lists no steps"
        if labels:
            hint = f"the steps listed are {labels[0]} to {labels[-1]} ({len(labels)} steps)"
        elif self.steps:
            hint = "name a step by its text in quotes"
        return TextFault(Code.UNKNOWN_STEP, message, offset, hint)

    def because(self, reason: str, span: SentenceSpan, offset: int | None = None) -> TextFault:
        start = span.start if offset is None else offset
        return because(reason, start, self.text[span.start : span.end])

    def too_many(self, span: SentenceSpan) -> Unclear:
        return Unclear(
            TextFault(
                Code.TOO_LARGE,
                f"the sentences mean more than {MOST_EDGES:,} precedences",
                span.start,
                "put a step of no duration between the groups",
            )
        )
