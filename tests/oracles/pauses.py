"""Exact optima of small tasks with calendars and work that pauses, from docs/semantics.md alone.

Known here: actions that occur once, with modes, durations fixed or in a range, uses and `one_of`,
releases, deadlines, fixed and latest starts, due dates; all precedences; capacity over time;
calendars of resources and actions; `breaks` and `max_pause`. All else is refused with `ValueError`.
Times are whole in the task's unit, and so are the boundaries of calendars.

**Method.** Whether a calendar is open is asked of every single tick: its date and time of day, or
its place in the cycle. Then every way to place every action is listed, and all combinations are
tried, one action after another, leaving those that are no better than the best so far.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from fractions import Fraction
from functools import cache
from itertools import product
from zoneinfo import ZoneInfo

from irc.model import Action, Calendar, ClosedTime, DurationRange, Precedence, Task, Use
from irc.model.quantities import Number
from irc.schedule import Entry, Schedule

_DAYS = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")
_KNOWN = {
    "task": {
        *("irc", "name", "time_unit", "origin", "deadline", "calendars", "resources", "actions"),
        *("precedence", "objective"),
    },
    "action": {
        *("id", "duration", "modes", "uses", "release", "deadline", "due", "weight", "start"),
        *("latest_start", "calendar", "breaks", "max_pause"),
    },
    "resource": {"id", "capacity", "availability", "calendar"},
}


@dataclass(frozen=True)
class Place:
    """One way to carry out an action: when, in which mode, holding what."""

    action: int
    start: int
    end: int
    mode: str | None
    held: tuple[tuple[str, int], ...]
    pauses: bool
    paused: int


@dataclass(frozen=True)
class Best:
    """The least values of the objectives, in their order, and a schedule with them."""

    values: tuple[int, ...]
    schedule: Schedule


def optimum(task: Task, horizon: int) -> Best | None:
    """The best schedule that ends by a horizon; None if there is none."""
    _refuse_others(task)
    world = _World(task, horizon)
    places = [list(world.places(i)) for i in range(len(task.actions))]
    order = sorted(range(len(places)), key=lambda i: len(places[i]))
    search = _Search(task, world, [places[i] for i in order])
    search.visit([])
    if search.best is None:
        return None
    entries = tuple(
        Entry(task.actions[p.action].id, p.start, p.end, dict(p.held), p.mode, paused=p.paused)
        for p in search.best[1]
    )
    return Best(search.best[0], Schedule(entries))


class _World:
    def __init__(self, task: Task, horizon: int) -> None:
        self.task, self.horizon = task, horizon
        self.calendars = {c.id: c for c in task.calendars}
        self.resources = {r.id: r for r in task.resources}
        self.is_open = cache(self._is_open)
        self.capacity = cache(self._capacity)

    def _is_open(self, name: str, tick: int) -> bool:
        calendar = self.calendars[name]
        if any(self._shuts(part, calendar, tick) for part in calendar.closed):
            return False
        if calendar.every is not None:
            every = whole(self.task.number(calendar.every))
            place = tick % every
            return any(
                _within(place, whole(self.task.number(p.from_)), whole(self.task.number(p.to)))
                for p in calendar.open
                if not isinstance(p.from_, str) and not isinstance(p.to, str)
            )
        shown = self._clock(calendar, tick)
        seconds = shown.hour * 3600 + shown.minute * 60 + shown.second
        today, before = _DAYS[shown.weekday()], _DAYS[(shown.weekday() - 1) % 7]
        for part in calendar.open:
            start, end = _of_day(part.from_), _of_day(part.to)
            if end <= start:
                opened = (seconds >= start and _on(part.days, today)) or (
                    seconds < end and _on(part.days, before)
                )
            else:
                opened = start <= seconds < end and _on(part.days, today)
            if opened:
                return True
        return False

    def _shuts(self, part: object, calendar: Calendar, tick: int) -> bool:
        if isinstance(part, ClosedTime):
            if isinstance(part.from_, datetime) and isinstance(part.to, datetime):
                return part.from_ <= self._clock(calendar, tick).replace(tzinfo=None) < part.to
            return self.task.number(part.from_) <= tick < self.task.number(part.to)
        assert isinstance(part, datetime)
        return self._clock(calendar, tick).date() == part.date()

    def _clock(self, calendar: Calendar, tick: int) -> datetime:
        origin = self.task.origin
        assert origin is not None
        zone = ZoneInfo(calendar.time_zone) if calendar.time_zone else origin.tzinfo or UTC
        if origin.tzinfo is None:
            origin = origin.replace(tzinfo=zone)
        seconds = Fraction(tick) * self.task.clock.unit
        moment = origin.astimezone(UTC) + timedelta(microseconds=int(seconds * 1_000_000))
        return moment.astimezone(zone)

    def _capacity(self, name: str, tick: int) -> int:
        resource = self.resources[name]
        for window in resource.availability:
            if self.task.number(window.from_) <= tick < self.task.number(window.to):
                return window.capacity
        if resource.calendar is not None and not self.is_open(resource.calendar, tick):
            return 0
        return resource.capacity

    def places(self, index: int) -> Iterator[Place]:
        """Every way to place an action so that it keeps all rules about it alone."""
        action = self.task.actions[index]
        for mode in action.modes or (None,):
            duration = action.duration if mode is None else mode.duration
            least, most = self._range(duration)
            uses = [*action.uses, *(() if mode is None else mode.uses)]
            for held in dict.fromkeys(_held(uses)):
                for start in range(self.horizon + 1):
                    for end, paused in self._ends(action, held, start, least, most):
                        name = None if mode is None else mode.id
                        pauses = action.breaks == "pause"
                        yield Place(index, start, end, name, held, pauses, paused)

    def _ends(
        self, action: Action, held: tuple[tuple[str, int], ...], start: int, least: int, most: int
    ) -> Iterator[tuple[int, int]]:
        number = self.task.number
        if start < number(action.release):
            return
        if action.start is not None and start != number(action.start):
            return
        if action.latest_start is not None and start > number(action.latest_start):
            return
        last = min(
            [
                self.horizon,
                *(number(d) for d in (action.deadline, self.task.deadline) if d is not None),
            ]
        )
        for end in range(start, last + 1):
            shut = [t for t in range(start, end + 1) if self._closed(action, held, t, end > start)]
            inside = [t for t in shut if t < end]
            paused = len(inside) if action.breaks == "pause" else 0
            worked = end - start - paused
            if worked > most:
                return
            if worked < least or start in shut or (end > start and end - 1 in shut):
                continue
            if inside and action.breaks != "pause":
                continue
            if action.max_pause is not None and paused > number(action.max_pause):
                continue
            if not self._room_alone(action, held, start, end):
                continue
            yield end, paused

    def _closed(
        self, action: Action, held: tuple[tuple[str, int], ...], tick: int, lasts: bool
    ) -> bool:
        if action.calendar is not None and not self.is_open(action.calendar, tick):
            return True
        if action.breaks != "pause" or not lasts:
            return False
        return any(self.capacity(name, tick) == 0 for name, _ in held)

    def _room_alone(
        self, action: Action, held: tuple[tuple[str, int], ...], start: int, end: int
    ) -> bool:
        pauses = action.breaks == "pause"
        return all(
            amount <= self.capacity(name, t) or (pauses and self.capacity(name, t) == 0)
            for name, amount in held
            for t in range(start, end)
        )

    def _range(self, duration: object) -> tuple[int, int]:
        if isinstance(duration, DurationRange):
            return whole(self.task.number(duration.min)), whole(self.task.number(duration.max))
        found = whole(self.task.number(duration))  # type: ignore[arg-type]
        return found, found


class _Search:
    def __init__(self, task: Task, world: _World, places: Sequence[Sequence[Place]]) -> None:
        self.task, self.world = task, world
        self.best: tuple[tuple[int, ...], list[Place]] | None = None
        self.places = [sorted(own, key=lambda p: (p.end, p.start)) for own in places]

    def visit(self, chosen: list[Place]) -> None:
        values = self._values(chosen)
        if self.best is not None and values >= self.best[0]:
            return
        if len(chosen) == len(self.places):
            self.best = values, list(chosen)
            return
        for place in self.places[len(chosen)]:
            if self._fits([*chosen, place]):
                self.visit([*chosen, place])

    def _values(self, chosen: Sequence[Place]) -> tuple[int, ...]:
        """The objectives of some of the actions: no more than those of all of them."""
        found = []
        for name in self.task.objective:
            if name == "minimize_makespan":
                found.append(max((p.end for p in chosen), default=0))
            else:
                found.append(sum(self._late(p) for p in chosen))
        return tuple(found)

    def _late(self, place: Place) -> int:
        action = self.task.actions[place.action]
        if action.due is None:
            return 0
        late = max(0, place.end - whole(self.task.number(action.due)))
        return late * (1 if action.weight is None else action.weight)

    def _fits(self, chosen: Sequence[Place]) -> bool:
        new = chosen[-1]
        by_id = {self.task.actions[p.action].id: p for p in chosen}
        for arc in self.task.precedence:
            if self.task.actions[new.action].id in (arc.before, arc.after) and not self._kept(
                arc, by_id
            ):
                return False
        for name, _ in new.held:
            for tick in range(new.start, new.end):
                holders = [p for p in chosen if p.start <= tick < p.end]
                capacity = self.world.capacity(name, tick)
                if capacity == 0:
                    holders = [p for p in holders if not p.pauses]
                if sum(dict(p.held).get(name, 0) for p in holders) > capacity:
                    return False
        return True

    def _kept(self, arc: Precedence, by_id: dict[str, Place]) -> bool:
        if arc.before not in by_id or arc.after not in by_id:
            return True
        of_before, of_after = arc.type.split("-")
        before, after = by_id[arc.before], by_id[arc.after]
        lag = (after.start if of_after == "start" else after.end) - (
            before.start if of_before == "start" else before.end
        )
        number = self.task.number
        return number(arc.min_lag) <= lag and (arc.max_lag is None or lag <= number(arc.max_lag))


def _held(uses: Sequence[Use]) -> Iterator[tuple[tuple[str, int], ...]]:
    for chosen in product(*(use.alternatives for use in uses)):
        held: dict[str, int] = {}
        for use, resource in zip(uses, chosen, strict=True):
            held[resource] = held.get(resource, 0) + use.amount
        yield tuple(sorted(held.items()))


def _within(place: int, start: int, end: int) -> bool:
    return start <= place < end if start < end else place >= start or place < end


def _on(days: Sequence[str], day: str) -> bool:
    return not days or day in days


def _of_day(text: object) -> int:
    hours, minutes = str(text).split(":")[:2]
    return int(hours) * 3600 + int(minutes) * 60


def whole(number: Number) -> int:
    """A time that is a whole number."""
    if number != int(number):
        raise ValueError(f"{number} is not a whole number of the task's time unit")
    return int(number)


def _refuse_others(task: Task) -> None:
    nodes = [("task", task), *(("action", a) for a in task.actions)]
    nodes += [("resource", r) for r in task.resources]
    for kind, node in nodes:
        for name, info in type(node).model_fields.items():
            if name not in _KNOWN[kind] and getattr(node, name) != info.get_default(
                call_default_factory=True
            ):
                raise ValueError(f"this oracle does not know {name!r} of a {kind}")
    if set(task.objective) - {"minimize_makespan", "minimize_tardiness"}:
        raise ValueError("this oracle knows only makespan and tardiness")
