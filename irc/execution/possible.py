"""Whether what is only presumed to have begun can have begun, given what is known to have happened.

A plan is presumed to be carried out, but not where that cannot be: an action does not begin before
its predecessors are through, on a resource that others hold, in a world or with a stock that it
cannot begin with. In doubt it can. docs/semantics.md, "What is presumed", has the rules.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Collection, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple, cast

from irc.execution.state import Key, key_of
from irc.model import Action, Condition, DurationRange, Precedence, Resource, Task
from irc.model.quantities import Number
from irc.model.world_changes import is_world_change
from irc.schedule import CANCELLED, Entry

if TYPE_CHECKING:
    from irc.model.details import Limits


Reason = tuple[Hashable, ...]
"""A reason against a start: the kind of rule, and the precedence, resource or condition."""


def precedence_reason(edge: Precedence) -> Reason:
    """The reason that a precedence forbids a start."""
    return "precedence", edge.before, edge.after, edge.type, str(edge.min_lag)


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
    order: Mapping[Key, int] = field(default_factory=dict)
    """The places of those in `begun` that are presumed: an earlier one has what two compete for."""
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
        return not self.reasons(entry)

    def reasons(self, entry: Entry) -> set[Reason]:
        """The reasons against a start: release, predecessors, resources, conditions and stock."""
        action = self._carried_out(entry)
        return set() if action is None else set(self._reasons(action, entry))

    def _reasons(self, action: Action, entry: Entry) -> Iterator[Reason]:
        if not self._in_window(action, entry):
            yield ("release",)
        for edge in self.before.get(entry.id, ()):
            if not self._has_passed(edge, entry):
                yield precedence_reason(edge)
        for name in entry.resources:
            if not self._has_room(name, entry):
                yield "resource", name
        for condition in action.conditions:
            if condition.at != "end" and not self._may_hold(condition, entry):
                yield "condition", condition.var, condition.at
        for name in {change.resource for change in action.consumes if change.at != "end"}:
            if not self._stock_lasts(action, name, entry):
                yield "stock", name

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
    def after(self) -> Mapping[str, list[str]]:
        """The actions whose start each action binds."""
        found: dict[str, list[str]] = {}
        for name, edges in self.before.items():
            for edge in edges:
                found.setdefault(edge.before, []).append(name)
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

    def _comes_first(self, other: Entry, entry: Entry) -> bool:
        """Whether another has what both compete for: it was observed, or is earlier in order."""
        place, own = self.order.get(key_of(other)), self.order.get(key_of(entry))
        return place is None or own is None or place < own

    @cached_property
    def of_the_world(self) -> frozenset[str]:
        """The ids of changes of the world."""
        return frozenset(change for change, *_ in self.world_changes)

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
            ended = edge.type == "finish-start"
            point = self.now + (self._least_duration(edge.before) if ended else 0)
        else:
            return True
        return entry.start >= point + lag

    def _least_duration(self, name: str) -> Number:
        """The least duration of an action, in whatever mode."""
        action, clock = self.actions[name], self.task.clock
        given = (action.duration, *(mode.duration for mode in action.modes))
        return min(
            clock.number(d.min if isinstance(d, DurationRange) else d)
            for d in given
            if d is not None
        )

    def _has_room(self, name: str, entry: Entry) -> bool:
        """Whether the resource has room for it when it starts, and when others are known to."""
        resource = self.resources.get(name)
        if resource is None or entry.start == entry.end:
            return True
        own, holders = entry.resources[name], self.holders.get(name, _NOBODY)
        beside = (e for e in holders.during(entry.start, entry.end) if key_of(e) != key_of(entry))
        others = [e for e in beside if self._comes_first(e, entry)]
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
        before, after = (self._families(resource, e) for e in (last, entry))
        needed = min(
            (self.task.clock.number(setup_between(resource, a, b)) for a in before for b in after),
            default=0,
        )
        return last.end + needed <= entry.start

    def _families(self, resource: Resource, entry: Entry) -> set[str | None]:
        """The families with which an occurrence, in its mode, may use a resource."""
        action = self.actions[entry.id]
        own = (use for mode in action.modes if mode.id == entry.mode for use in mode.uses)
        uses = (*action.uses, *own)
        return {use.family for use in uses if resource.id in use.alternatives}

    def _capacity(self, resource: Resource, time: Number) -> int:
        clock = self.task.clock
        for window in resource.availability:
            if clock.number(window.from_) <= time < clock.number(window.to):
                return window.capacity
        return resource.capacity

    def _may_hold(self, condition: Condition, entry: Entry) -> bool:
        """Whether a condition can hold when an entry starts."""
        with_own = condition.at == "all"
        if condition.asks_for_a_level:
            return self._level_may_be(condition.var, entry, condition.limits, with_own=with_own)
        return condition.value in self._values_at(condition.var, entry, with_own)

    def _level_may_be(self, var: str, entry: Entry, limits: Limits, *, with_own: bool) -> bool:
        """Whether a number can be within limits when an entry starts, in some order of the changes
        of that instant."""
        changes = [c for c in self._level_changes(var) if with_own or c.entry != entry]
        changes.sort(key=lambda change: change.time)
        variable = next(v for v in self.task.state if v.id == var)
        least = greatest = cast("Number", variable.start_value)
        for time, at_once in groupby(changes, key=lambda change: change.time):
            if time > entry.start:
                break
            group = list(at_once)
            levels = [c.amount for c in group if c.sets]
            added = [c.amount for c in group if not c.sets]
            if time == entry.start:  # (Some of them come later.)
                levels += [least, greatest]
            elif not levels:
                least, greatest = least + sum(added), greatest + sum(added)
                continue
            least = min(levels) + sum(amount for amount in added if amount < 0)
            greatest = max(levels) + sum(amount for amount in added if amount > 0)
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
        """The values that a variable can have when an entry starts.

        Those that the last change before brings, or all of that instant, and those of its own
        instant. Where the world changes it just then, what starts comes after that.
        """
        variable = next((v for v in self.task.state if v.id == var), None)
        initial: object = None if variable is None else variable.start_value
        before: tuple[Number, set[object]] = -1, {initial}
        here: set[object] = set()
        for past in self.begun.values():
            if (past == entry and not with_own) or past.id in self.of_the_world:
                continue
            for time, name, value in self._effects(past):
                if name == var:
                    before = _latest(before, here, time, value, entry.start)
        if with_own:
            own = self.actions[entry.id].in_mode(entry.mode).effects
            here |= {e.value for e in own if (e.var, e.at) == (var, "start")}
        changed: set[object] = set()
        for time, value in self._changes_by_the_world(var):
            before = _latest(before, changed, time, value, entry.start)
        if changed:
            return changed | (here if with_own else set())
        return here | before[1]

    def _changes_by_the_world(self, var: str) -> Iterator[tuple[Number, object]]:
        """(time, value) of each timed change of a variable, and each that events have reported."""
        for _, time, name, value in self.world_changes:
            if name == var:
                yield time, value
        for variable in self.task.state:
            for timed in variable.changes if variable.id == var else ():
                yield self.task.clock.number(timed.at), timed.value

    def _effects(self, past: Entry) -> Iterable[tuple[Number, str, object]]:
        action = self._carried_out(past)
        for effect in () if action is None else action.effects:
            if effect.at == "start":
                yield past.start, effect.var, effect.value
            elif past.end <= self.now and past.status != CANCELLED:
                yield past.end, effect.var, effect.value

    def _stock_lasts(self, action: Action, name: str, entry: Entry) -> bool:
        resource = self.resources.get(name)
        if resource is None:
            return True
        level = resource.initial + self._taken(action, name, at_end=False)
        if (entry.end, entry.last_rank) == (entry.start, entry.rank):  # It is one happening.
            level += self._taken(action, name, at_end=True)
        for past in self.begun.values():
            its = self._carried_out(past)
            if its is None or key_of(past) == key_of(entry):
                continue
            for time, at_end in ((past.start, False), (past.end, True)):
                amount = self._taken(its, name, at_end=at_end)
                stopped = at_end and past.status == CANCELLED
                here = time == entry.start and (amount > 0 or self._comes_first(past, entry))
                if not stopped and (time < entry.start or here):
                    level += amount
        return level >= resource.min

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


def _latest(
    before: tuple[Number, set[object]], here: set[object], time: Number, value: object, now: Number
) -> tuple[Number, set[object]]:
    """The last time before `now` with a change and all values of it; one of `now` joins `here`."""
    if time == now:
        here.add(value)
    elif time == before[0]:
        before[1].add(value)
    elif before[0] < time < now:
        return time, {value}
    return before
