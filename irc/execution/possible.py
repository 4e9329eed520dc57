"""Whether what is only presumed to have begun can have begun, given what is known to have happened.

A plan is presumed to be carried out, but not where that cannot be: an action does not begin before
its predecessors are through, on a resource that others hold, in a world or with a stock that it
cannot begin with. In doubt it can.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, cast

from irc.execution.state import Key, key_of
from irc.model import Action, Precedence, Resource, Task
from irc.model.quantities import Number
from irc.model.world_changes import is_world_change
from irc.schedule import CANCELLED, Entry

if TYPE_CHECKING:
    from irc.model.details import Limits


class _LevelChange(NamedTuple):
    """A change of a number by an entry (None: by the world)."""

    time: Number
    amount: Number
    sets: bool
    entry: Entry | None = None


class _Holders:
    """The entries that hold a resource, in order of their starts."""

    def __init__(self) -> None:
        self._entries: list[Entry] = []
        self._longest: Number = 0

    def __iter__(self) -> Iterator[Entry]:
        return iter(self._entries)

    def add(self, entry: Entry) -> None:
        """Adds an entry."""
        insort(self._entries, entry, key=_start)
        self._longest = max(self._longest, entry.end - entry.start)

    def remove(self, entry: Entry) -> None:
        """Removes an entry."""
        first = bisect_left(self._entries, entry.start, key=_start)
        del self._entries[self._entries.index(entry, first)]

    def during(self, start: Number, end: Number) -> list[Entry]:
        """The entries that begin before `end` and end after `start`."""
        first = bisect_left(self._entries, start - self._longest, key=_start)
        last = bisect_left(self._entries, end, key=_start)
        return [entry for entry in self._entries[first:last] if entry.end > start]


def _start(entry: Entry) -> Number:
    return entry.start


_NOBODY = _Holders()


@dataclass
class Happened:
    """The facts about a task as of `now`.

    `begun` are the entries of what has begun; `planned` is all else that is planned.
    """

    task: Task
    now: Number
    begun: dict[Key, Entry] = field(default_factory=dict)
    planned: dict[Key, Entry] = field(default_factory=dict)
    certain: Collection[Key] = ()
    """The keys in `begun` that were observed."""
    holders: dict[str, _Holders] = field(default_factory=dict)
    """The entries that hold each resource."""

    @classmethod
    def all_of(cls, task: Task, entries: Iterable[Entry], now: Number) -> Happened:
        """The facts if all entries are carried out as they are."""
        happened = cls(task, now)
        for entry in entries:
            happened.add(entry)
        return happened

    def add(self, entry: Entry) -> None:
        """Adds what has begun."""
        self.begun[key_of(entry)] = entry
        for name in entry.resources:
            self.holders.setdefault(name, _Holders()).add(entry)

    def remove(self, entry: Entry) -> None:
        """Takes back that it has begun."""
        del self.begun[key_of(entry)]
        for name in entry.resources:
            self.holders[name].remove(entry)

    def can_begin(self, entry: Entry) -> bool:
        """Whether an occurrence can have begun when and as its entry says."""
        return not any(self.faults(entry))

    def faults(self, entry: Entry) -> list[bool]:
        """Whether each of window, predecessors, resources, conditions and stock forbids a start."""
        action = self._carried_out(entry)
        if action is None:
            return [False] * 5
        return [
            not self._in_window(action, entry),
            not all(self._has_passed(edge, entry) for edge in self.before.get(entry.id, ())),
            not all(self._has_room(name, entry) for name in entry.resources),
            bool(action.conditions) and not self._world_allows(action, entry),
            bool(action.consumes) and not self._stock_lasts(action, entry),
        ]

    def _carried_out(self, entry: Entry) -> Action | None:
        """The action of an entry, in its mode."""
        action = self.actions.get(entry.id)
        return None if action is None else action.in_mode(entry.mode)

    @cached_property
    def actions(self) -> Mapping[str, Action]:
        return {action.id: action for action in self.task.actions}

    @cached_property
    def before(self) -> Mapping[str, list[Precedence]]:
        """The precedences that bind the start of each action."""
        found: dict[str, list[Precedence]] = {}
        for edge in self.task.precedence:
            if edge.type in ("finish-start", "start-start"):
                found.setdefault(edge.after, []).append(edge)
        return found

    @cached_property
    def resources(self) -> Mapping[str, Resource]:
        return {resource.id: resource for resource in self.task.resources}

    @cached_property
    def world_changes(self) -> list[tuple[str, Number, str, object]]:
        """(id, time, variable, value) of each change of the world."""
        clock = self.task.clock
        return [
            (a.id, clock.number(a.start), a.effects[0].var, a.effects[0].value)
            for a in self.task.actions
            if a.start is not None and is_world_change(a, clock)
        ]

    # --- the five reasons ---

    def _in_window(self, action: Action, entry: Entry) -> bool:
        return self.task.clock.number(action.release) <= entry.start

    def _has_passed(self, edge: Precedence, entry: Entry) -> bool:
        lag = self.task.clock.number(edge.min_lag)
        key = edge.before, 1
        past = self.begun.get(key)
        if past is not None and past.status == CANCELLED:
            return True
        if past is not None:
            point = past.start if edge.type == "start-start" else past.end
        elif key in self.planned:
            point = self.now
        else:
            return True
        return entry.start >= point + lag

    def _has_room(self, name: str, entry: Entry) -> bool:
        """Whether the resource has room for it when it starts, and when others are known to."""
        resource = self.resources.get(name)
        if resource is None or entry.start == entry.end:
            return True
        own, holders = entry.resources[name], self.holders.get(name, _NOBODY)
        beside = holders.during(entry.start, entry.end)
        others = [e for e in beside if key_of(e) != key_of(entry)]
        seen = [e for e in others if key_of(e) in self.certain] if self.certain else ()
        later = [e.start for e in seen if entry.start < e.start < entry.end and e.end > e.start]
        for time in (entry.start, *later):
            held = sum(e.resources[name] for e in others if e.start <= time < e.end)
            if held + own > self._capacity(resource, time):
                return False
        if resource.kind == "batch" and any(
            e.start != entry.start and e.start < entry.end and entry.start < e.end for e in others
        ):
            return False  # It would be in a load that has begun, or begins, without it.
        return resource.setups is None or self._is_set_up(resource, entry, holders)

    def _is_set_up(self, resource: Resource, entry: Entry, holders: Iterable[Entry]) -> bool:
        """Whether the set-up since the last use can have been done by its start."""
        from irc.lowering.setups import setup_between

        ended = [
            e for e in holders if e.start < e.end <= entry.start and key_of(e) != key_of(entry)
        ]
        last = max(ended, key=lambda e: (e.start, e.end), default=None)
        if last is None or last.id not in self.actions:
            return True
        before, after = (
            {
                use.family
                for use in (*action.uses, *(u for m in action.modes for u in m.uses))
                if resource.id in use.alternatives
            }
            for action in (self.actions[last.id], self.actions[entry.id])
        )
        needed = min(
            (self.task.clock.number(setup_between(resource, a, b)) for a in before for b in after),
            default=0,
        )
        return last.end + needed <= entry.start

    def _capacity(self, resource: Resource, time: Number) -> int:
        clock = self.task.clock
        for window in resource.availability:
            if clock.number(window.from_) <= time < clock.number(window.to):
                return window.capacity
        return resource.capacity

    def _world_allows(self, action: Action, entry: Entry) -> bool:
        return all(
            self._level_may_be(c.var, entry, c.limits, with_own=c.at == "all")
            if c.asks_for_a_level
            else c.value in self._values_at(c.var, entry, c.at == "all")
            for c in action.conditions
            if c.at != "end"
        )

    def _level_may_be(self, var: str, entry: Entry, limits: Limits, *, with_own: bool) -> bool:
        """Whether a number can be within limits when an entry starts, in some order of the changes
        of that instant."""
        changes = [c for c in self._level_changes(var) if with_own or c.entry != entry]
        changes.sort(key=lambda change: change.time)
        variable = next(v for v in self.task.state if v.id == var)
        least = greatest = cast("Number", variable.start_value)
        for change in (c for c in changes if c.time < entry.start):
            least = greatest = change.amount if change.sets else least + change.amount
        for change in (c for c in changes if c.time == entry.start):
            if change.sets:
                least, greatest = min(least, change.amount), max(greatest, change.amount)
            else:
                least, greatest = least + min(0, change.amount), greatest + max(0, change.amount)
        low, high = limits
        return (low is None or greatest >= low) and (high is None or least <= high)

    def _level_changes(self, var: str) -> Iterator[_LevelChange]:
        """The changes of a number by what has begun, and by the world."""
        clock = self.task.clock
        for past in self.begun.values():
            action = self._carried_out(past)
            for effect in () if action is None else action.effects:
                at_end = effect.at == "end"
                if effect.var != var or (
                    at_end and (past.end > self.now or past.status == CANCELLED)
                ):
                    continue
                time = past.end if at_end else past.start
                amount = effect.add if effect.set is None else effect.set
                yield _LevelChange(time, amount or 0, effect.set is not None, past)
        for a in self.task.actions:
            if a.start is None or (a.id, 1) in self.begun:
                continue
            if is_world_change(a, clock) and a.effects[0].var == var:
                level = a.effects[0].set or 0
                yield _LevelChange(clock.number(a.start), level, True)
        for variable in self.task.state:
            for change in variable.changes if variable.id == var else ():
                yield _LevelChange(clock.number(change.at), cast("Number", change.value), True)

    def _values_at(self, var: str, entry: Entry, with_own: bool) -> set[object]:
        """The values that a variable can have when an entry starts."""
        before: tuple[Number, object] | None = None
        here: set[object] = set()
        changed: set[object] = set()
        for past in self.begun.values():
            if past == entry and not with_own:
                continue
            for time, name, value in self._effects(past):
                if name != var or time > entry.start:
                    continue
                if time == entry.start:
                    here.add(value)
                elif before is None or time >= before[0]:
                    before = time, value
        if with_own:
            own = self.actions[entry.id].in_mode(entry.mode).effects
            here |= {e.value for e in own if (e.var, e.at) == (var, "start")}
        for change, time, name, value in self.world_changes:
            if name != var or time > entry.start or (change, 1) in self.begun:
                continue
            if time == entry.start:
                changed.add(value)
            elif before is None or time >= before[0]:
                before = time, value
        if changed:
            return changed | (here if with_own else set())
        initial = next((v.start_value for v in self.task.state if v.id == var), None)
        return here | {initial if before is None else before[1]}

    def _effects(self, past: Entry) -> Iterable[tuple[Number, str, object]]:
        action = self._carried_out(past)
        for effect in () if action is None else action.effects:
            if effect.at == "start":
                yield past.start, effect.var, effect.value
            elif past.end <= self.now and past.status != CANCELLED:
                yield past.end, effect.var, effect.value

    def _stock_lasts(self, action: Action, entry: Entry) -> bool:
        for name in {change.resource for change in action.consumes if change.at != "end"}:
            resource = self.resources.get(name)
            if resource is None:
                continue
            level = resource.initial + self._taken(action, name, at_end=False)
            for past in self.begun.values():
                its = self._carried_out(past)
                if its is None or key_of(past) == key_of(entry):
                    continue
                for time, amount in (
                    (past.start, self._taken(its, name, at_end=False)),
                    (past.end, self._taken(its, name, at_end=True)),
                ):
                    stopped = past.status == CANCELLED and time == past.end
                    if not stopped and (time < entry.start or (time == entry.start and amount > 0)):
                        level += amount
            if level < resource.min:
                return False
        return True

    @staticmethod
    def _taken(action: Action, name: str, *, at_end: bool) -> int:
        """The net change of a stock by the start, or the end, of an action."""
        put = sum(
            c.amount for c in action.produces if c.resource == name and (c.at != "start") == at_end
        )
        took = sum(
            c.amount for c in action.consumes if c.resource == name and (c.at == "end") == at_end
        )
        return put - took
