"""Which entries of a plan cannot have begun, by what was observed (docs/semantics.md).

Works on whole lists of entries and of instants, anew for each question, and knows nothing of
`irc.execution`. Batch resources, set-ups and numbers are not among what random executions have.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from irc.model import Action, DurationRange, Task
from irc.model.quantities import Number
from irc.schedule import Entry, Schedule

Key = tuple[str, int]


def not_begun(
    task: Task,
    schedule: Schedule,
    at: Number,
    observed: Mapping[Key, Entry],
    waiting: Collection[Key] = (),
) -> frozenset[Key]:
    """The occurrences that were to begin before `at` and cannot have.

    `observed` has the entries, as they were observed, of what was observed to have begun, and
    `waiting` are those that were observed not to have.
    """
    planned = {_key(entry): entry for entry in schedule.entries}
    known = {k: e for k, e in observed.items() if k not in waiting}
    presumed = [
        e for k, e in planned.items() if e.start < at and k not in known and k not in waiting
    ]
    presumed.sort(key=lambda e: (e.start, e.rank, e.id, e.occurrence))
    as_planned = _Facts(task, at, planned, known, list(planned.values()))
    gone: set[Key] = set()
    while True:
        kept = [entry for entry in presumed if _key(entry) not in gone]
        facts = _Facts(task, at, planned, known, [*known.values(), *kept])
        for place, entry in enumerate(kept):
            if any((entry.id, n) in known for n in _numbers_after(entry, planned)):
                continue  # Occurrences are numbered by start.
            ahead = [*known.values(), *kept[:place]]
            before = set(as_planned.against(entry, list(planned.values())))
            if set(facts.against(entry, ahead)) - before:
                gone |= {_key(entry), *((entry.id, n) for n in _numbers_after(entry, planned))}
                break
        else:
            return frozenset(gone)


def _key(entry: Entry) -> Key:
    return entry.id, entry.occurrence


def _numbers_after(entry: Entry, planned: Mapping[Key, Entry]) -> list[int]:
    return [number for name, number in planned if name == entry.id and number > entry.occurrence]


@dataclass(frozen=True)
class _Facts:
    """What is taken to have begun by `at`, and what of it is known."""

    task: Task
    at: Number
    planned: Mapping[Key, Entry]
    known: Collection[Key]
    begun: Sequence[Entry]

    def against(self, entry: Entry, ahead: Sequence[Entry]) -> Iterator[object]:
        """What forbids that an entry has begun; `ahead` has what it competes with."""
        action = self._done(entry)
        others = [e for e in ahead if _key(e) != _key(entry)]
        if entry.start < self.task.number(action.release):
            yield "release"
        yield from self._orders(entry)
        for name in entry.resources:
            if self._is_full(name, entry, others):
                yield "resource", name
        for condition in action.conditions:
            if condition.at == "end":
                continue
            if condition.value not in self._values(condition.var, entry, condition.at == "all"):
                yield "condition", condition.var, condition.at
        for name in {take.resource for take in action.consumes if take.at != "end"}:
            if self._is_out_of_stock(name, entry, others):
                yield "stock", name

    def _done(self, entry: Entry) -> Action:
        """The action of an entry as its mode has it."""
        return next(a for a in self.task.actions if a.id == entry.id).in_mode(entry.mode)

    def _orders(self, entry: Entry) -> Iterator[object]:
        begun = {e.id: e for e in self.begun}
        for edge in self.task.precedence:
            if edge.after != entry.id or not edge.type.endswith("-start"):
                continue
            first = begun.get(edge.before)
            if first is not None and first.status == "cancelled":
                continue
            if first is not None:
                point = first.start if edge.type == "start-start" else first.end
            elif (edge.before, 1) in self.planned:
                point = self.at + (0 if edge.type == "start-start" else self._least(edge.before))
            else:
                continue
            if entry.start - point < self.task.number(edge.min_lag):
                yield edge

    def _least(self, name: str) -> Number:
        action = next(a for a in self.task.actions if a.id == name)
        stated: list[Any] = [m.duration for m in action.modes] or [action.duration]
        least = [d.min if isinstance(d, DurationRange) else d for d in stated]
        return min(map(self.task.number, least))

    def _is_full(self, name: str, entry: Entry, others: Sequence[Entry]) -> bool:
        resource = next(r for r in self.task.resources if r.id == name)
        if entry.start == entry.end:
            return False
        instants = {entry.start}
        for other in others:
            if _key(other) in self.known and name in other.resources and other.start < other.end:
                instants.add(other.start)
        for instant in instants:
            if not entry.start <= instant < entry.end:
                continue
            capacity = resource.capacity
            for window in resource.availability:
                if self.task.number(window.from_) <= instant < self.task.number(window.to):
                    capacity = window.capacity
            held = [e.resources.get(name, 0) for e in others if e.start <= instant < e.end]
            if sum(held) + entry.resources[name] > capacity:
                return True
        return False

    def _values(self, var: str, entry: Entry, throughout: bool) -> set[object]:
        """The values that a variable can have just before an entry starts, or just after."""
        variable = next(v for v in self.task.state if v.id == var)
        by_world: dict[Number, set[object]] = {}
        for timed in variable.changes:
            by_world.setdefault(self.task.number(timed.at), set()).add(timed.value)
        brought: dict[Number, set[object]] = {}
        for past in self.begun:
            itself = _key(past) == _key(entry)
            world = past.id.startswith(f"{var} at ") and past.start == past.end
            for effect in self._done(past).effects:
                if effect.var != var or (itself and not throughout):
                    continue
                if effect.at == "start":
                    where = by_world if world else brought
                    where.setdefault(past.start, set()).add(effect.value)
                elif past.end <= self.at and past.status != "cancelled":
                    brought.setdefault(past.end, set()).add(effect.value)
        earlier = [t for t in (*by_world, *brought) if t < entry.start]
        found: set[object] = {variable.start_value}
        if earlier:
            found = by_world.get(max(earlier), set()) | brought.get(max(earlier), set())
        here = brought.get(entry.start, set())
        if entry.start in by_world:
            return by_world[entry.start] | (here if throughout else set())
        return found | here

    def _is_out_of_stock(self, name: str, entry: Entry, others: Sequence[Entry]) -> bool:
        resource = next(r for r in self.task.resources if r.id == name)
        rivals = {_key(e) for e in others}
        level = resource.initial
        for past in self.begun:
            for time, change, at_end in self._stock_changes(name, past):
                if _key(past) == _key(entry):
                    once = past.start == past.end and past.last_rank == past.rank
                    level += change if once or not at_end else 0
                elif time < entry.start or (
                    time == entry.start and (change > 0 or _key(past) in rivals)
                ):
                    level += change
        return level < resource.min

    def _stock_changes(self, name: str, past: Entry) -> Iterator[tuple[Number, int, bool]]:
        """(time, change, whether its end makes it) of a stock, for what has happened."""
        action = self._done(past)
        first = [c.amount for c in action.produces if c.resource == name and c.at == "start"]
        first += [-c.amount for c in action.consumes if c.resource == name and c.at != "end"]
        last = [c.amount for c in action.produces if c.resource == name and c.at != "start"]
        last += [-c.amount for c in action.consumes if c.resource == name and c.at == "end"]
        yield past.start, sum(first), False
        if past.status != "cancelled":
            yield past.end, sum(last), True
