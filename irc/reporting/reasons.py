"""Why each occurrence starts when it does: what it waits for, read off the schedule.

A reason is something that the schedule meets exactly: a release, a lag, a resource that another
occurrence has just freed, a set-up, stock or state that another has just provided, the end of a
closed time. Reasons are about one schedule; whether another order is better they do not say.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain, islice

from irc.model import Action, Precedence, Task
from irc.model.quantities import Number, exact
from irc.model.times import Instant, format_number
from irc.reporting.closed import ClosedTimes, Levels
from irc.reporting.levels import Happening, stocks
from irc.reporting.rows import Key, Reason, SetupRow
from irc.schedule import Entry

MOST_REASONS = 8
"""An occurrence has at most this many reasons, the first ones in the order of this module."""


class Reasons:
    """The reasons of the occurrences of one schedule; each is found in a few look-ups."""

    def __init__(
        self,
        task: Task,
        entries: Sequence[Entry],
        actions: Mapping[Key, Action],
        *,
        closed: ClosedTimes,
        loads: Mapping[str, Levels],
        setups: Iterable[SetupRow],
        stock: Mapping[str, list[Happening]],
        state: Mapping[str, list[Happening]],
    ) -> None:
        self.task, self.unit, self.number = task, task.time_unit, task.clock.number
        self.entries = {(e.id, e.occurrence): e for e in entries}
        self.actions, self.closed, self.loads = actions, closed, loads
        self.stock, self.state = _by_time(stock), _by_time(state)
        self.stock_levels = {level.resource: level.levels for level in stocks(task, stock)}
        self.resources = {resource.id: resource for resource in task.resources}
        self.holders = _holders(entries)
        self.holder_ends = {name: [e.end for e in held] for name, held in self.holders.items()}
        self.setups = _by_key(setups)
        self.into: dict[str, list[Precedence]] = {}
        self.out_of: dict[str, list[Precedence]] = {}
        for precedence in task.precedence:
            self.into.setdefault(precedence.after, []).append(precedence)
            if precedence.max_lag is not None:
                self.out_of.setdefault(precedence.before, []).append(precedence)
        self.readers = _readers(entries, actions)

    def of(self, entry: Entry) -> tuple[Reason, ...]:
        """The reasons of an occurrence: tight ones; and, where it waits for an open time, the
        latest of those before.
        """
        action = self.actions.get((entry.id, entry.occurrence))
        if action is None:
            return ()
        opening = list(self._openings(entry, action))
        bounds = [*self._own_bounds(entry, action), *self._precedences(entry)]
        bounds += [*self._resources(entry), *self._setups(entry), *self._previous(entry)]
        found = [reason for time, reason in bounds if time == entry.start]
        found += islice(chain(self._stock(entry, action), self._state(entry, action)), MOST_REASONS)
        if len(found) > 1:
            found = [reason for reason in found if reason.kind != "origin"]
        if opening and not found:
            earlier = [b for b in bounds if b[0] < entry.start and b[1].kind not in _BACKWARD]
            latest = max((time for time, _ in earlier), default=None)
            found = [
                Reason(r.kind, r.text, r.after, r.resource, tight=False)
                for time, r in earlier
                if time == latest and r.kind != "origin"
            ]
        return tuple(_distinct([*opening, *found]))[:MOST_REASONS]

    def _own_bounds(self, entry: Entry, action: Action) -> Iterator[tuple[Number, Reason]]:
        number = self.number
        yield 0, Reason("origin", "nothing is before t = 0")
        if action.release and (release := number(action.release)) > 0:
            yield release, Reason("release", f"released at {self._time(release)}")
        if action.start is not None:
            yield number(action.start), Reason("start", "its start is fixed")
        if action.earliest_end is not None and entry.end == number(action.earliest_end):
            text = f"it must not end before {self._time(entry.end)}"
            yield entry.start, Reason("earliest_end", text)

    def _precedences(self, entry: Entry) -> Iterator[tuple[Number, Reason]]:
        for p in self.into.get(entry.id, ()):
            before = self.entries.get((p.before, 1))
            if before is not None:
                first = before.end if p.type.startswith("finish") else before.start
                least = first + self.number(p.min_lag)
                time = least - (entry.end - entry.start if p.type.endswith("finish") else 0)
                yield (
                    time,
                    Reason("precedence", _lag(p, before, self._lag(p.min_lag)), _key(before)),
                )
        for p in self.out_of.get(entry.id, ()):
            after = self.entries.get((p.after, 1))
            if after is not None and p.max_lag is not None:
                last = after.end if p.type.endswith("finish") else after.start
                time = last - self.number(p.max_lag)
                time -= entry.end - entry.start if p.type.startswith("finish") else 0
                text = f"at most {self._lag(p.max_lag)} before {after.id!r}"
                yield time, Reason("max_lag", text, _key(after))

    def _resources(self, entry: Entry) -> Iterator[tuple[Number, Reason]]:
        """The latest instant before which a resource has no room for the occurrence."""
        if entry.start == entry.end:
            return
        for name, amount in entry.resources.items():
            if name not in self.resources:
                continue
            ends, holders = self.holder_ends.get(name, []), self.holders.get(name, [])
            capacity = self.closed.capacity(self.resources[name])
            k = bisect_left(ends, entry.start)
            time = entry.start if k < len(ends) and ends[k] == entry.start else None
            if time is None and k:
                time = ends[k - 1]
            if time is None:
                continue
            room = level_before(capacity, time) - level_before(self.loads[name], time)
            if room >= amount or not level_before(capacity, time):
                continue
            for before in _ended_at(holders, ends, time):
                if _key(before) != _key(entry):
                    text = f"resource {name!r} is held by {_named(before)} until then"
                    yield time, Reason("resource", text, _key(before), name)

    def _setups(self, entry: Entry) -> Iterator[tuple[Number, Reason]]:
        for setup in self.setups.get((entry.id, entry.occurrence), ()):
            length = self._time(exact_of(setup.end - setup.start))
            before = None if setup.before is None else self.entries[setup.before]
            since = 0 if before is None else before.end
            what = "" if before is None else f" after {_named(before)}"
            text = f"set-up of {setup.resource!r}{what} takes {length}"
            after = None if before is None else _key(before)
            yield (
                since + setup.end - setup.start,
                Reason("setup", text, after, setup.resource),
            )

    def _previous(self, entry: Entry) -> Iterator[tuple[Number, Reason]]:
        before = self.entries.get((entry.id, entry.occurrence - 1))
        if before is not None:
            yield before.end, Reason("occurrence", f"after {_named(before)}", _key(before))

    def _openings(self, entry: Entry, action: Action) -> Iterator[Reason]:
        """The closed times that end when it starts."""
        if action.calendar is not None:
            spans = self.closed.of_calendar(action.calendar)
            if _ends_at(spans, entry.start):
                text = f"calendar {action.calendar!r} is closed until then"
                yield Reason("closed", text, None, action.calendar)
        for name in entry.resources if entry.start < entry.end else ():
            resource = self.resources.get(name)
            if resource is None:
                continue
            if _ends_at(self.closed.of_resource(resource), entry.start):
                yield Reason("closed", f"resource {name!r} is closed until then", None, name)
            elif self._has_more(name, entry):
                yield Reason(
                    "capacity", f"resource {name!r} has more capacity from then on", None, name
                )

    def _has_more(self, name: str, entry: Entry) -> bool:
        capacity = self.closed.capacity(self.resources[name])
        if not entry.start:
            return False
        before, now = level_before(capacity, entry.start), level_at(capacity, entry.start)
        load = level_before(self.loads[name], entry.start)
        return before < now and load + entry.resources[name] > before

    def _stock(self, entry: Entry, action: Action) -> Iterator[Reason]:
        """The occurrences that give at this instant what it takes, or make room for it."""
        taken: dict[str, int] = {}
        for change, sign in (
            *((c, -1) for c in action.consumes),
            *((c, 1) for c in action.produces),
        ):
            if (change.at or ("start" if sign < 0 else "end")) == "start":
                taken[change.resource] = taken.get(change.resource, 0) + sign * change.amount
        for name, amount in taken.items():
            resource = self.resources[name]
            level = level_before(self.stock_levels.get(name, ((0, resource.initial),)), entry.start)
            level = level if entry.start else resource.initial
            low = level + amount < resource.min
            if not low and (resource.max is None or level + amount <= resource.max):
                continue
            for h in self.stock.get((name, entry.start), ()):
                if h.by is not None and h.by != _key(entry) and (h.change > 0) == low:
                    what = "has enough" if low else "has room"
                    text = f"stock {name!r} {what} by {_named(self.entries[h.by])}"
                    yield Reason("stock", text, h.by, name)

    def _state(self, entry: Entry, action: Action) -> Iterator[Reason]:
        """The changes of this instant that it relies on, and the conditions that have just ended
        which it must not break.
        """
        for condition in action.conditions:
            if condition.at == "end":
                continue
            for h in self.state.get((condition.var, entry.start), ()):
                if h.by != _key(entry):
                    by = "the world" if h.by is None else _named(self.entries[h.by])
                    kind = "world" if h.by is None else "state"
                    yield Reason(
                        kind, f"state {condition.var!r} changes then by {by}", h.by, condition.var
                    )
        for effect in action.effects:
            if effect.at == "start":
                for other in self.readers.get((effect.var, entry.start), ()):
                    if other != _key(entry):
                        by = _named(self.entries[other])
                        text = f"state {effect.var!r} is needed by {by} until then"
                        yield Reason("state", text, other, effect.var)

    def _time(self, value: Number) -> str:
        return f"{format_number(value)} {self.unit}"

    def _lag(self, lag: Instant) -> str:
        number = self.number(lag)
        return self._time(number) if number else ""


_BACKWARD = ("max_lag", "earliest_end")


def exact_of(value: Number) -> Number:
    """A number in its usual form: whole ones as integers."""
    return value if isinstance(value, int) else exact(value)


def level_at(levels: Levels, time: Number) -> int:
    """The level of a step function at a time; 0 before its first step."""
    k = bisect_left(levels, time, key=lambda step: step[0])
    if k < len(levels) and levels[k][0] == time:
        return levels[k][1]
    return levels[k - 1][1] if k else 0


def level_before(levels: Levels, time: Number) -> int:
    """The level of a step function just before a time; 0 before its first step."""
    k = bisect_left(levels, time, key=lambda step: step[0])
    return levels[k - 1][1] if k else 0


def _key(entry: Entry) -> Key:
    return entry.id, entry.occurrence


def _named(entry: Entry) -> str:
    return repr(entry.id) if entry.occurrence == 1 else f"{entry.id!r} ({entry.occurrence})"


def _lag(precedence: Precedence, before: Entry, lag: str) -> str:
    """The text of a precedence: "2 h after 'a' ends"."""
    happening = "ends" if precedence.type.startswith("finish") else "starts"
    whose = "" if precedence.type.endswith("start") else "it ends "
    apart = f"{lag} after" if lag else ("when" if whose else "after")
    return f"{whose}{apart} {before.id!r} {happening}"


def _holders(entries: Iterable[Entry]) -> dict[str, list[Entry]]:
    """The occurrences that hold each resource for some time, by their ends."""
    held: dict[str, list[Entry]] = {}
    for entry in sorted(entries, key=lambda e: (e.end, e.id, e.occurrence)):
        if entry.start < entry.end:
            for name in entry.resources:
                held.setdefault(name, []).append(entry)
    return held


def _ended_at(holders: Sequence[Entry], ends: Sequence[Number], time: Number) -> Iterator[Entry]:
    k = bisect_left(ends, time)
    while k < len(ends) and ends[k] == time:
        yield holders[k]
        k += 1


def _ends_at(spans: Sequence[tuple[Number, Number]], time: Number) -> bool:
    k = bisect_left(spans, time, key=lambda span: span[1])
    return k < len(spans) and spans[k][1] == time


def _by_key(setups: Iterable[SetupRow]) -> dict[Key, list[SetupRow]]:
    found: dict[Key, list[SetupRow]] = {}
    for setup in setups:
        found.setdefault(setup.after, []).append(setup)
    return found


def _readers(
    entries: Iterable[Entry], actions: Mapping[Key, Action]
) -> dict[tuple[str, Number], list[Key]]:
    """By variable and time, the occurrences that need it throughout and end then."""
    found: dict[tuple[str, Number], list[Key]] = {}
    for entry in entries:
        action = actions.get(_key(entry))
        for condition in () if action is None else action.conditions:
            if condition.at == "all":
                found.setdefault((condition.var, entry.end), []).append(_key(entry))
    return found


def _by_time(
    happenings: Mapping[str, list[Happening]],
) -> dict[tuple[str, Number], list[Happening]]:
    """The happenings of each stock or variable at each time."""
    found: dict[tuple[str, Number], list[Happening]] = {}
    for name, of in happenings.items():
        for happening in of:
            found.setdefault((name, happening.time), []).append(happening)
    return found


def _distinct(reasons: Iterable[Reason]) -> Iterator[Reason]:
    seen: set[tuple[str, str]] = set()
    for reason in reasons:
        if (reason.kind, reason.text) not in seen:
            seen.add((reason.kind, reason.text))
            yield reason
