"""Collects what sentences say of things and choices: resources, calendars, set-ups, selections."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from irc.diagnostics import Code
from irc.diagnostics.source import Pointer, Range
from irc.frontends.english.open_times import calendar, hours_of
from irc.frontends.english.reasons import TextFault, Unclear, because, shown
from irc.frontends.english.references import Finder, SentenceSpan
from irc.frontends.english.statements import (
    Begins,
    Changes,
    Due,
    MayPause,
    OpenTimes,
    Selects,
    Statement,
    UsesTheSame,
    UsesThing,
)

Document = dict[str, Any]


@dataclass
class Things:
    """The parts of the document that such sentences make. Steps are known by their positions."""

    resources: dict[str, tuple[Document, Range]] = field(default_factory=dict)
    uses: dict[int, list[Document]] = field(default_factory=dict)
    open_times: dict[str | None, list[tuple[OpenTimes, SentenceSpan]]] = field(default_factory=dict)
    """By thing, when it is open or closed; None: all work."""
    capacities: dict[str, int | None] = field(default_factory=dict)
    """By thing that steps use, how many there are; None: it is one."""
    select: list[tuple[Document, Range]] = field(default_factory=list)
    couplings: list[tuple[list[tuple[int, int]], Range]] = field(default_factory=list)
    due: dict[int, tuple[str, Range]] = field(default_factory=dict)
    optional: set[int] = field(default_factory=set)
    pausing: set[int] = field(default_factory=set)
    origin: str | None = None

    def take(self, statement: Statement, span: SentenceSpan, find: Finder) -> bool:
        """Adds a statement; returns whether it is one about these. Raises `Unclear`."""
        match statement:
            case Selects():
                self._select(statement, span, find)
            case Due():
                for position in find.positions(statement.refs, span):
                    self.due[position] = statement.time.text, _place(span)
            case UsesThing():
                self._use(statement, span, find)
            case UsesTheSame():
                self._use_the_same(statement, span, find)
            case OpenTimes():
                if statement.thing is not None:
                    self._resource(statement.thing, span)
                self.open_times.setdefault(statement.thing, []).append((statement, span))
            case Changes():
                self._change(statement, span)
            case MayPause():
                self.pausing.update(find.positions(statement.refs, span))
            case Begins():
                self.origin = statement.origin
            case _:
                return False
        return True

    def _resource(self, name: str, span: SentenceSpan) -> Document:
        return self.resources.setdefault(name, ({"id": name}, _place(span)))[0]

    def _select(self, selects: Selects, span: SentenceSpan, find: Finder) -> None:
        positions = find.positions(selects.refs, span)
        self.optional.update(positions)
        rule: Document = {"actions": [find.steps[p].id(p) for p in positions]}
        if selects.all_or_none:
            rule["all_or_none"] = True
        else:
            if selects.least:
                rule["min"] = selects.least
            if selects.most is not None:
                rule["max"] = selects.most
        self.select.append((rule, _place(span)))

    def _use(self, uses: UsesThing, span: SentenceSpan, find: Finder) -> None:
        for thing in uses.things:
            resource = self._resource(thing, span)
            if self.capacities.setdefault(thing, uses.capacity) != uses.capacity:
                raise Unclear(find.because("how many", span))
            if uses.capacity is not None:
                resource["capacity"] = uses.capacity
        one: Document = {"resource": uses.things[0]}
        if len(uses.things) > 1:
            one = {"one_of": list(uses.things)}
        if uses.family is not None:
            one["family"] = uses.family
        if uses.amount is not None and uses.amount > 1:
            one["amount"] = uses.amount
        for position in find.positions(uses.refs, span):
            self.uses.setdefault(position, []).append(one)

    def _use_the_same(self, same: UsesTheSame, span: SentenceSpan, find: Finder) -> None:
        """Those that do not say what they use may use what the others do."""
        positions = find.positions(same.refs, span)
        others = find.positions(same.others, span, positions) if same.others else positions
        every = list(dict.fromkeys((*others, *positions)))
        known = {p: k for p in every if (k := self._use_of(p, same.kind)) is not None}
        if not known:
            raise Unclear(find.because("same as what", span))
        first = next(iter(known))
        for position in every:
            if position not in known:
                uses = self.uses.setdefault(position, [])
                known[position] = len(uses)
                uses.append(dict(self.uses[first][known[first]]))
        self.couplings.append(([(p, known[p]) for p in every], _place(span)))

    def _use_of(self, position: int, kind: str) -> int | None:
        """The place of the use of a step whose things have a kind in their names."""
        for k, use in enumerate(self.uses.get(position, ())):
            things = use.get("one_of") or [use["resource"]]
            if all(kind.lower() in thing.lower() for thing in things):
                return k
        return None

    def _change(self, changes: Changes, span: SentenceSpan) -> None:
        setups = self._resource(changes.thing, span).setdefault("setups", {"times": []})
        row = {"from": changes.before, "to": changes.after, "time": changes.time.text}
        setups["times"].append(row)

    # The end of the text

    def faults(self, text: str, *, all_needed: bool) -> Iterator[TextFault]:
        """Yields the faults of all sentences together."""
        for rules in self.open_times.values():
            for opened, span in rules:
                if (opened.days or opened.dates) and self.origin is None:
                    yield because("no date", span.start, text[span.start : span.end])
        if all_needed and self.select:
            place = self.select[0][1]
            yield TextFault(
                Code.CONTRADICTION,
                "all steps are needed, but this sentence leaves some out: "
                f"{shown(text[place.start : place.end])}",
                place.start,
                "keep one of the two",
            )

    def add_to(self, document: Document, places: dict[Pointer, Range]) -> None:
        """Adds it all to a document that has its actions."""
        if self.origin is not None:
            document["origin"] = self.origin
        if self.open_times:
            document["calendars"] = [
                calendar(
                    hours_of(thing), [rule for rule, _ in rules], dated=self.origin is not None
                )
                for thing, rules in self.open_times.items()
            ]
        resources: list[Document] = document.get("resources", [])
        for name, (resource, place) in self.resources.items():
            places["resources", len(resources)] = place
            opened = {"calendar": hours_of(name)} if name in self.open_times else {}
            resources.append({**resource, **opened})
        if resources:
            document["resources"] = resources
        for position, action in enumerate(document["actions"]):
            self._add_to_action(position, action, places)
        names = [action["id"] for action in document["actions"]]
        for k, (rule, place) in enumerate(self.select):
            document.setdefault("select", []).append(rule)
            places["select", k] = place
        for k, (members, place) in enumerate(self.couplings):
            coupled = [{"action": names[p], "use": use} for p, use in members]
            document.setdefault("couplings", []).append({"same": "resource", "actions": coupled})
            places["couplings", k] = place
        if self.due:
            document["objective"] = ["minimize_tardiness", "minimize_makespan"]

    def _add_to_action(self, position: int, action: Document, places: dict[Pointer, Range]) -> None:
        if position in self.uses:
            # (They come first: couplings count them from 0.)
            action["uses"] = [*self.uses[position], *action.get("uses", ())]
        if None in self.open_times:
            action["calendar"] = hours_of(None)
        if position in self.optional:
            action["occurs"] = "optional"
        if position in self.pausing:
            action["breaks"] = "pause"
        if position in self.due:
            action["due"], places["actions", position, "due"] = self.due[position]


def _place(span: SentenceSpan) -> Range:
    return Range(span.start, span.end)
