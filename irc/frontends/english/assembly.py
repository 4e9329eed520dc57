"""Builds an IR document, with the place of each of its elements, from statements."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from irc.diagnostics import Code
from irc.diagnostics.source import Pointer, Range
from irc.frontends.english.names import StepNames
from irc.frontends.english.reasons import TextFault, Unclear, shown
from irc.frontends.english.references import MOST_EDGES, Finder, ListedStep, SentenceSpan
from irc.frontends.english.statements import (
    Apart,
    AtATime,
    Chain,
    Deadline,
    EachAfterPrevious,
    Frame,
    Free,
    Ordering,
    OthersAfter,
    Place,
    Point,
    Ref,
    Refs,
    Statement,
    StoryPart,
    Takes,
)
from irc.frontends.english.used_things import Things

_TYPES = {
    ("end", "start"): "finish-start",
    ("start", "start"): "start-start",
    ("end", "end"): "finish-finish",
    ("start", "end"): "start-finish",
}
_SEARCHED = 5_000_000
"""Limit on the edges visited to find statements of freedom that an order contradicts."""


@dataclass
class Assembly:
    """Collects the statements of a text one by one."""

    text: str
    steps: Sequence[ListedStep]
    names: StepNames
    problems: list[TextFault] = field(default_factory=list)
    name: str | None = None
    unit: str = "s"
    ordered: bool = False
    """Whether the text defines the order."""
    listed_orders: bool = False
    """Whether the text announces its orders as a list, so that steps' own texts define none."""
    all_needed: bool = False
    none_ordered: SentenceSpan | None = None
    deadline: tuple[Any, Range] | None = None
    resources: list[tuple[dict[str, Any], Range]] = field(default_factory=list)
    uses: dict[int, list[str]] = field(default_factory=dict)
    precedence: list[dict[str, Any]] = field(default_factory=list)
    places: list[tuple[Range, Range, Range]] = field(default_factory=list)
    free: list[tuple[Free, list[int], SentenceSpan]] = field(default_factory=list)
    _implied: set[tuple[int, int]] = field(default_factory=set)
    _edges: dict[int, list[int]] = field(default_factory=dict)
    _story: list[int] | None = None
    _covered: set[int] = field(default_factory=set)
    _opened: SentenceSpan | None = None
    things: Things = field(default_factory=Things)
    find: Finder = field(init=False)

    def __post_init__(self) -> None:
        self.find = Finder(self.text, self.steps, self.names)

    def take(self, statements: Sequence[Statement], span: SentenceSpan) -> None:
        """Adds the statements of a sentence; their faults become problems."""
        for statement in statements:
            try:
                self._take(statement, span)
            except Unclear as unclear:
                self.problems.append(unclear.problem)

    def _take(self, statement: Statement, span: SentenceSpan) -> None:
        match statement:
            case Ordering():
                self._order(statement, span)
            case Chain():
                groups = [self.find.positions(refs, span) for refs in statement.groups]
                self._chain(groups, span)
                self._story, self._covered = groups[-1], {p for g in groups for p in g}
            case StoryPart():
                self._story_part(statement, span)
            case Place():
                self._place(statement, span)
            case OthersAfter():
                self._others_after(statement, span)
            case EachAfterPrevious():
                self._chain([[p] for p in range(len(self.steps))], span)
            case Free():
                self._free(statement, span)
            case Apart():
                self._apart(statement, span)
            case AtATime():
                self._at_a_time(statement.most, span)
            case Deadline():
                self._deadline(statement, span)
            case Takes():
                self._takes(statement, span)
            case Frame():
                self._frame(statement, span)
            case _ if self.things.take(statement, span, self.find):
                pass
            case _:
                raise TypeError(f"no way to take {statement!r}")

    # Ordering

    def _tell(self) -> None:
        self._story = None
        self._unopen()

    def _unopen(self) -> None:
        if self._opened is not None:
            self.problems.append(self.find.because("first", self._opened))
            self._opened = None

    def _order(self, order: Ordering, span: SentenceSpan) -> None:
        relative = {"previous", "all_previous", "all_other", "all"}
        first_relative = any(ref.kind in relative for ref in order.before.refs)
        second_relative = any(ref.kind in relative for ref in order.after.refs)
        if first_relative and second_relative:
            raise Unclear(self.find.because("nested", span))
        if first_relative:
            after = self.find.positions(order.after.refs, span)
            before = self.find.positions(order.before.refs, span, after)
        else:
            before = self.find.positions(order.before.refs, span)
            after = self.find.positions(order.after.refs, span, before)
        if order.most is not None and len(before) > 1:
            raise Unclear(self.find.because("lag of several", span))
        self.ordered = True
        if span.step is None or not any(r.kind == "this" for r in order.after.refs):
            self._tell()
        lag: dict[str, Any] = {}
        if order.before.edge != "end" or order.after.edge != "start":
            lag["type"] = _TYPES[order.before.edge, order.after.edge]
        if order.least is not None:
            lag["min_lag"] = order.least.text
        if order.most is not None:
            lag["max_lag"] = order.most.text
        places = (_place(order.before.refs, span), _place(order.after.refs, span))
        for first in before:
            for second in after:
                self._edge(first, second, span, lag, places)

    def _edge(
        self,
        first: int,
        second: int,
        span: SentenceSpan,
        lag: Mapping[str, Any] | None = None,
        places: tuple[Range, Range] | None = None,
    ) -> None:
        if len(self.precedence) >= MOST_EDGES:
            raise self.find.too_many(span)
        whole = Range(span.start, span.end)
        ids = (self.steps[first].id(first), self.steps[second].id(second))
        self.precedence.append({"before": ids[0], "after": ids[1], **(lag or {})})
        self.places.append((whole, *(places or (whole, whole))))
        if not lag or lag.get("type") is None:
            self._edges.setdefault(first, []).append(second)

    def _imply(self, first: int, second: int, span: SentenceSpan) -> None:
        """Adds an edge that a general sentence implies; a repetition counts once."""
        if first != second and (first, second) not in self._implied:
            self._implied.add((first, second))
            self._edge(first, second, span)

    def _chain(self, groups: Sequence[Sequence[int]], span: SentenceSpan) -> None:
        self.ordered = True
        self._unopen()
        for earlier, later in itertools.pairwise(groups):
            if not set(earlier).isdisjoint(later):
                raise Unclear(self.find.because("nested", span))
            for first in earlier:
                for second in later:
                    self._imply(first, second, span)

    def _story_part(self, part: StoryPart, span: SentenceSpan) -> None:
        positions = self.find.positions(part.refs, span)
        if part.when == "first":
            self._unopen()
            self._opened = span
            self._story, self._covered = positions, set(positions)
            return
        if self._story is None:
            raise Unclear(self.find.because("then", span))
        self._opened = None
        if part.when == "finally":
            beside = set(range(len(self.steps))) - set(positions)
            if not beside <= self._covered:
                raise Unclear(self.find.because("finally", span))
        self._chain([self._story, positions], span)
        self._covered |= set(positions)
        self._story = positions if part.when == "then" else None

    def _place(self, place: Place, span: SentenceSpan) -> None:
        positions = self.find.positions(place.refs, span)
        self.ordered = True
        self._tell()
        if place.where == "in order":
            if len(positions) < 2:
                raise Unclear(self.find.because("alone", span))
            self._chain([[p] for p in positions], span)
            return
        if len(positions) > 1:
            raise Unclear(self.find.because("nested", span))
        for other in range(len(self.steps)):
            first, second = (
                (positions[0], other) if place.where == "first" else (other, positions[0])
            )
            self._imply(first, second, span)

    def _others_after(self, statement: OthersAfter, span: SentenceSpan) -> None:
        before = self.find.positions(statement.point.refs, span)
        after = (Ref("all_other", (), span.start, span.end),)
        order = Ordering(statement.point, Point(after, "start"))
        if len(before) * len(self.steps) > MOST_EDGES:
            raise self.find.too_many(span)
        self._order(order, span)

    def _free(self, free: Free, span: SentenceSpan) -> None:
        self._tell()
        if any(ref.kind == "all" for ref in free.refs):
            self.ordered, self.none_ordered = True, span
            return
        self.free.append((free, self.find.positions(free.refs, span), span))

    # Limits

    def _at_a_time(self, most: int, span: SentenceSpan) -> None:
        name = "steps at a time"
        resource = {"id": name, "capacity": most}
        if any(known["id"] == name for known, _ in self.resources):
            raise Unclear(
                self._contradiction("two sentences limit how many steps may run at a time", span)
            )
        self.resources.append((resource, Range(span.start, span.end)))
        for position in range(len(self.steps)):
            self.uses.setdefault(position, []).append(name)

    def _apart(self, apart: Apart, span: SentenceSpan) -> None:
        positions = self.find.positions(apart.refs, span)
        if apart.others:
            others = self.find.positions(apart.others, span, positions)
            pairs = [(a, b) for a in positions for b in others if a != b]
        elif len(positions) > 2 and apart.pair:
            raise Unclear(self.find.because("three apart", span))
        elif len(positions) < 2:
            raise Unclear(self.find.because("alone", span))
        else:
            self._share(positions, span)
            return
        if len(pairs) > 1000:
            raise self.find.too_many(span)
        for pair in pairs:
            self._share(pair, span)

    def _share(self, positions: Sequence[int], span: SentenceSpan) -> None:
        name = f"one at a time {len(self.resources) + 1}"
        self.resources.append(({"id": name}, Range(span.start, span.end)))
        for position in positions:
            self.uses.setdefault(position, []).append(name)

    def _deadline(self, deadline: Deadline, span: SentenceSpan) -> None:
        if self.deadline is not None and self.deadline[0] != deadline.time.text:
            raise Unclear(self._contradiction("two sentences give different deadlines", span))
        self.deadline = (deadline.time.text, Range(span.start, span.end))

    # Durations and the frame

    def _takes(self, takes: Takes, span: SentenceSpan) -> None:
        positions = self.find.positions(takes.refs, span)
        if len(positions) > 1 and not takes.each:
            raise Unclear(self.find.because("each", span))
        for position in positions:
            step = self.steps[position]
            if step.time is not None and step.time != takes.time:
                raise Unclear(
                    self._contradiction(
                        f"another duration of step {step.id(position)[4:]}, unlike the first", span
                    )
                )
            step.time, step.time_place = takes.time, Range(span.start, span.end)

    def _contradiction(self, message: str, span: SentenceSpan) -> TextFault:
        quoted = shown(self.text[span.start : span.end])
        return TextFault(
            Code.CONTRADICTION, f"{message}: {quoted}", span.start, "keep one of the two"
        )

    def _frame(self, frame: Frame, span: SentenceSpan) -> None:
        match frame.kind:
            case "titled" if self.name is None:
                self.name = frame.text or None
            case "orders":
                self.ordered = self.listed_orders = True
            case "all needed":
                self.all_needed = True
            case "no orders":
                self.ordered = True
                self.none_ordered = span
            case "unit":
                self.unit = frame.text

    # The end of the text

    def finish(self) -> None:
        """Makes the checks that need all statements."""
        self._unopen()
        self.problems += self.things.faults(self.text, all_needed=self.all_needed)
        if self.none_ordered is not None and self.precedence:
            self.problems.append(
                self._contradiction(
                    "this sentence excludes any order, but other sentences give orders",
                    self.none_ordered,
                )
            )
        budget = _SEARCHED
        for free, positions, span in self.free:
            clash, budget = self._clash(free, positions, budget)
            if clash:
                self.problems.append(
                    self._contradiction("another sentence orders these steps", span)
                )

    def _clash(self, free: Free, positions: Sequence[int], budget: int) -> tuple[bool, int]:
        """(whether an order contradicts a freedom, the number of edges that may be visited yet)."""
        members = set(positions)
        if free.against == "all":
            return any(not members.isdisjoint(after) for after in self._edges.values()), budget
        for position in positions:
            waiting, seen = [position], {position}
            while waiting and budget > 0:
                for following in self._edges.get(waiting.pop(), ()):
                    budget -= 1
                    if following in members and following != position:
                        return True, budget
                    if following not in seen:
                        seen.add(following)
                        waiting.append(following)
        return False, budget

    def document(self) -> tuple[dict[str, Any], dict[Pointer, Range]]:
        """(the IR document, the place of each of its elements)."""
        places: dict[Pointer, Range] = {}
        document: dict[str, Any] = {"irc": "1"}
        if self.name:
            document["name"] = self.name
        document["time_unit"] = self.unit
        if self.deadline is not None:
            document["deadline"], places["deadline",] = self.deadline
        if self.resources:
            document["resources"] = [resource for resource, _ in self.resources]
            for index, (_, place) in enumerate(self.resources):
                places["resources", index] = place
        document["actions"] = [self._action(i, step, places) for i, step in enumerate(self.steps)]
        document["precedence"] = self.precedence
        self.things.add_to(document, places)
        for index, (whole, first, second) in enumerate(self.places):
            places["precedence", index] = whole
            places["precedence", index, "before"] = first
            places["precedence", index, "after"] = second
        return document, places

    def _action(
        self, position: int, step: ListedStep, places: dict[Pointer, Range]
    ) -> dict[str, Any]:
        places["actions", position] = step.place
        action: dict[str, Any] = {"id": step.id(position)}
        if step.title:
            action["label"] = step.title
        if step.time is not None:
            action["duration"] = step.time.document
            if step.time_place is not None:
                places["actions", position, "duration"] = step.time_place
        if position in self.uses:
            action["uses"] = [{"resource": name} for name in self.uses[position]]
        return action


def _place(refs: Refs, span: SentenceSpan) -> Range:
    if not refs or refs[0].end <= refs[0].start:
        return Range(span.start, span.end)
    return Range(refs[0].start, refs[-1].end)
