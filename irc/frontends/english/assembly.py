"""Statements → an IR document with the place of each of its elements in the text."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from irc.diagnostics import Code
from irc.diagnostics.source import Pointer, Range
from irc.frontends.english.names import Names
from irc.frontends.english.reasons import Problem, Unclear, shown
from irc.frontends.english.references import MOST_EDGES, Finder, Said, Step
from irc.frontends.english.statements import (
    Apart,
    AtATime,
    Chain,
    Deadline,
    EachAfterPrevious,
    Frame,
    Free,
    Order,
    OthersAfter,
    Place,
    Point,
    Ref,
    Refs,
    Statement,
    Takes,
    Told,
)

_TYPES = {
    ("end", "start"): "finish-start",
    ("start", "start"): "start-start",
    ("end", "end"): "finish-finish",
    ("start", "end"): "start-finish",
}
_SEARCHED = 5_000_000
"""Edges looked at to find statements of freedom that an order contradicts."""


@dataclass
class Assembly:
    """Takes up the statements of a text one by one."""

    text: str
    steps: Sequence[Step]
    names: Names
    problems: list[Problem] = field(default_factory=list)
    name: str | None = None
    unit: str = "s"
    ordered: bool = False
    """The text says what there is to say about the order."""
    listed_orders: bool = False
    """It announces its orders as a list, so that steps' own texts say nothing of the order."""
    all_needed: bool = False
    none_ordered: Said | None = None
    deadline: tuple[Any, Range] | None = None
    resources: list[tuple[dict[str, Any], Range]] = field(default_factory=list)
    uses: dict[int, list[str]] = field(default_factory=dict)
    precedence: list[dict[str, Any]] = field(default_factory=list)
    places: list[tuple[Range, Range, Range]] = field(default_factory=list)
    free: list[tuple[Free, list[int], Said]] = field(default_factory=list)
    _implied: set[tuple[int, int]] = field(default_factory=set)
    _edges: dict[int, list[int]] = field(default_factory=dict)
    _story: list[int] | None = None
    _covered: set[int] = field(default_factory=set)
    _opened: Said | None = None
    find: Finder = field(init=False)

    def __post_init__(self) -> None:
        self.find = Finder(self.text, self.steps, self.names)

    def take(self, statements: Sequence[Statement], said: Said) -> None:
        """Takes up what a sentence says; its faults become problems."""
        for statement in statements:
            try:
                self._take(statement, said)
            except Unclear as unclear:
                self.problems.append(unclear.problem)

    def _take(self, statement: Statement, said: Said) -> None:
        match statement:
            case Order():
                self._order(statement, said)
            case Chain():
                groups = [self.find.positions(refs, said) for refs in statement.groups]
                self._chain(groups, said)
                self._story, self._covered = groups[-1], {p for g in groups for p in g}
            case Told():
                self._told(statement, said)
            case Place():
                self._place(statement, said)
            case OthersAfter():
                self._others_after(statement, said)
            case EachAfterPrevious():
                self._chain([[p] for p in range(len(self.steps))], said)
            case Free():
                self._free(statement, said)
            case Apart():
                self._apart(statement, said)
            case AtATime():
                self._at_a_time(statement.most, said)
            case Deadline():
                self._deadline(statement, said)
            case Takes():
                self._takes(statement, said)
            case Frame():
                self._frame(statement, said)
            case _:
                raise TypeError(f"no way to take {statement!r}")

    # Order

    def _tell(self) -> None:
        self._story = None
        self._unopen()

    def _unopen(self) -> None:
        if self._opened is not None:
            self.problems.append(self.find.because("first", self._opened))
            self._opened = None

    def _order(self, order: Order, said: Said) -> None:
        relative = {"previous", "all_previous", "all_other", "all"}
        first_relative = any(ref.kind in relative for ref in order.before.refs)
        second_relative = any(ref.kind in relative for ref in order.after.refs)
        if first_relative and second_relative:
            raise Unclear(self.find.because("nested", said))
        if first_relative:
            after = self.find.positions(order.after.refs, said)
            before = self.find.positions(order.before.refs, said, after)
        else:
            before = self.find.positions(order.before.refs, said)
            after = self.find.positions(order.after.refs, said, before)
        if order.most is not None and len(before) > 1:
            raise Unclear(self.find.because("lag of several", said))
        self.ordered = True
        if said.step is None or not any(r.kind == "this" for r in order.after.refs):
            self._tell()
        lag: dict[str, Any] = {}
        if order.before.edge != "end" or order.after.edge != "start":
            lag["type"] = _TYPES[order.before.edge, order.after.edge]
        if order.least is not None:
            lag["min_lag"] = order.least.text
        if order.most is not None:
            lag["max_lag"] = order.most.text
        places = (_place(order.before.refs, said), _place(order.after.refs, said))
        for first in before:
            for second in after:
                self._edge(first, second, said, lag, places)

    def _edge(
        self,
        first: int,
        second: int,
        said: Said,
        lag: Mapping[str, Any] | None = None,
        places: tuple[Range, Range] | None = None,
    ) -> None:
        if len(self.precedence) >= MOST_EDGES:
            raise self.find.too_many(said)
        whole = Range(said.start, said.end)
        ids = (self.steps[first].id(first), self.steps[second].id(second))
        self.precedence.append({"before": ids[0], "after": ids[1], **(lag or {})})
        self.places.append((whole, *(places or (whole, whole))))
        if not lag or lag.get("type") is None:
            self._edges.setdefault(first, []).append(second)

    def _imply(self, first: int, second: int, said: Said) -> None:
        """An edge that a general sentence means; said twice it counts once, without a word."""
        if first != second and (first, second) not in self._implied:
            self._implied.add((first, second))
            self._edge(first, second, said)

    def _chain(self, groups: Sequence[Sequence[int]], said: Said) -> None:
        self.ordered = True
        self._unopen()
        for earlier, later in itertools.pairwise(groups):
            if not set(earlier).isdisjoint(later):
                raise Unclear(self.find.because("nested", said))
            for first in earlier:
                for second in later:
                    self._imply(first, second, said)

    def _told(self, told: Told, said: Said) -> None:
        positions = self.find.positions(told.refs, said)
        if told.when == "first":
            self._unopen()
            self._opened = said
            self._story, self._covered = positions, set(positions)
            return
        if self._story is None:
            raise Unclear(self.find.because("then", said))
        self._opened = None
        if told.when == "finally":
            beside = set(range(len(self.steps))) - set(positions)
            if not beside <= self._covered:
                raise Unclear(self.find.because("finally", said))
        self._chain([self._story, positions], said)
        self._covered |= set(positions)
        self._story = positions if told.when == "then" else None

    def _place(self, place: Place, said: Said) -> None:
        positions = self.find.positions(place.refs, said)
        self.ordered = True
        self._tell()
        if place.where == "in order":
            if len(positions) < 2:
                raise Unclear(self.find.because("alone", said))
            self._chain([[p] for p in positions], said)
            return
        if len(positions) > 1:
            raise Unclear(self.find.because("nested", said))
        for other in range(len(self.steps)):
            first, second = (
                (positions[0], other) if place.where == "first" else (other, positions[0])
            )
            self._imply(first, second, said)

    def _others_after(self, statement: OthersAfter, said: Said) -> None:
        before = self.find.positions(statement.point.refs, said)
        after = (Ref("all_other", (), said.start, said.end),)
        order = Order(statement.point, Point(after, "start"))
        if len(before) * len(self.steps) > MOST_EDGES:
            raise self.find.too_many(said)
        self._order(order, said)

    def _free(self, free: Free, said: Said) -> None:
        self._tell()
        if any(ref.kind == "all" for ref in free.refs):
            self.ordered, self.none_ordered = True, said
            return
        self.free.append((free, self.find.positions(free.refs, said), said))

    # Limits

    def _at_a_time(self, most: int, said: Said) -> None:
        name = "steps at a time"
        resource = {"id": name, "capacity": most}
        if any(known["id"] == name for known, _ in self.resources):
            raise Unclear(
                self._contradiction("how many steps may run at a time appears twice", said)
            )
        self.resources.append((resource, Range(said.start, said.end)))
        for position in range(len(self.steps)):
            self.uses.setdefault(position, []).append(name)

    def _apart(self, apart: Apart, said: Said) -> None:
        positions = self.find.positions(apart.refs, said)
        if apart.others:
            others = self.find.positions(apart.others, said, positions)
            pairs = [(a, b) for a in positions for b in others if a != b]
        elif len(positions) > 2 and apart.pair:
            raise Unclear(self.find.because("three apart", said))
        elif len(positions) < 2:
            raise Unclear(self.find.because("alone", said))
        else:
            self._share(positions, said)
            return
        if len(pairs) > 1000:
            raise self.find.too_many(said)
        for pair in pairs:
            self._share(pair, said)

    def _share(self, positions: Sequence[int], said: Said) -> None:
        name = f"one at a time {len(self.resources) + 1}"
        self.resources.append(({"id": name}, Range(said.start, said.end)))
        for position in positions:
            self.uses.setdefault(position, []).append(name)

    def _deadline(self, deadline: Deadline, said: Said) -> None:
        if self.deadline is not None and self.deadline[0] != deadline.time.text:
            raise Unclear(self._contradiction("the deadline is said twice, differently", said))
        self.deadline = (deadline.time.text, Range(said.start, said.end))

    # Durations and the frame

    def _takes(self, takes: Takes, said: Said) -> None:
        positions = self.find.positions(takes.refs, said)
        if len(positions) > 1 and not takes.each:
            raise Unclear(self.find.because("each", said))
        for position in positions:
            step = self.steps[position]
            if step.time is not None and step.time != takes.time:
                raise Unclear(
                    self._contradiction(
                        f"a second duration of step {step.id(position)[4:]}, unlike the first", said
                    )
                )
            step.time, step.time_place = takes.time, Range(said.start, said.end)

    def _contradiction(self, message: str, said: Said) -> Problem:
        quoted = shown(self.text[said.start : said.end])
        return Problem(
            Code.CONTRADICTION, f"{message}: {quoted}", said.start, "keep one of the two"
        )

    def _frame(self, frame: Frame, said: Said) -> None:
        match frame.kind:
            case "titled" if self.name is None:
                self.name = frame.text or None
            case "orders":
                self.ordered = self.listed_orders = True
            case "all needed":
                self.all_needed = True
            case "all told":
                self.ordered = True
                self.none_ordered = said
            case "unit":
                self.unit = frame.text

    # The end of the text

    def finish(self) -> None:
        """What can be judged only when all has been said."""
        self._unopen()
        if self.none_ordered is not None and self.precedence:
            self.problems.append(
                self._contradiction("no order at all, and orders besides", self.none_ordered)
            )
        budget = _SEARCHED
        for free, positions, said in self.free:
            clash, budget = self._clash(free, positions, budget)
            if clash:
                self.problems.append(
                    self._contradiction("another sentence orders these steps", said)
                )

    def _clash(self, free: Free, positions: Sequence[int], budget: int) -> tuple[bool, int]:
        """Whether an order contradicts a freedom, and how many edges may still be looked at."""
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
        """The IR document, and where each of its elements stands."""
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
        for index, (whole, first, second) in enumerate(self.places):
            places["precedence", index] = whole
            places["precedence", index, "before"] = first
            places["precedence", index, "after"] = second
        return document, places

    def _action(self, position: int, step: Step, places: dict[Pointer, Range]) -> dict[str, Any]:
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


def _place(refs: Refs, said: Said) -> Range:
    if not refs or refs[0].end <= refs[0].start:
        return Range(said.start, said.end)
    return Range(refs[0].start, refs[-1].end)
