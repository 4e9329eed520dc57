"""The best values of any small task, by trying everything (docs/semantics.md, rules 1 to 7).

Known is the whole IR but events, `minimize_changes`, calendars by days of the week, and occurrences
without a maximum. Times are counted in ticks: the greatest number that divides all times.

**Method.** Every choice of occurrences, modes and resources is listed. For each, every start and
end of every occurrence is tried, one occurrence after another; a branch ends where two occurrences
already break a rule, or where the values cannot be better than the best so far. What is left is
judged as a whole: set-ups, orders, and every order of ranks (`oracles.exhaustive_ranks`).

**Why the horizon is enough.** Take a best schedule and keep its decisions and orders. As early as
these allow, what ends after the last date of the task waits for a chain of durations, lags and
set-ups behind a date, and in a cycle of a calendar at least one tick of that is done.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise, product
from typing import Any, NamedTuple

from irc.model import Action, Calendar, ClosedTime, DurationRange, Mode, Resource, StateGoal, Task
from irc.model.quantities import Number, exact
from irc.schedule import Entry
from oracles.exhaustive_ranks import some_ranks_do, these_ranks_do

Vector = tuple[Number, ...]


class TooHardError(Exception):
    """More steps than the caller allows."""


class Hold(NamedTuple):
    """A use that a way of carrying out an action makes of one resource."""

    place: tuple[str | None, int]
    """The mode that the use is written in (None: the action itself), and its number there."""
    resource: str
    amount: int
    family: str | None


@dataclass(frozen=True, eq=False)
class Way:
    """A way to carry out an action; `least` and `most` bound its (working) time in ticks."""

    action: Action
    mode: Mode | None
    held: tuple[Hold, ...]
    least: int
    most: int

    @property
    def pauses(self) -> bool:
        """Whether its work stops at closed times."""
        return self.action.breaks == "pause"

    @property
    def ends_freely(self) -> bool:
        """Whether its end has a rank of its own."""
        return self.pauses or self.least < self.most

    def parts(self, name: str) -> list[Any]:
        """What the action and its mode have of some field."""
        own = [*getattr(self.action, name)]
        return own if self.mode is None else [*own, *getattr(self.mode, name)]

    @property
    def holds(self) -> dict[str, int]:
        """The amount that it holds of each resource."""
        found: dict[str, int] = {}
        for hold in self.held:
            found[hold.resource] = found.get(hold.resource, 0) + hold.amount
        return found

    @property
    def cost(self) -> int:
        """The cost of the action and of its mode."""
        return (self.action.cost or 0) + ((self.mode and self.mode.cost) or 0)


class Past(NamedTuple):
    """What has begun of a schedule that is carried out, and the time in ticks.

    An entry that has begun keeps its start, mode and resources; one that is over its end, too.
    """

    now: Number
    entries: Sequence[Entry]


class Placed(NamedTuple):
    """An occurrence in time."""

    way: Way
    number: int
    start: int
    end: int

    @property
    def name(self) -> str:
        """The action."""
        return self.way.action.id


def best_of(task: Task, most_steps: int = 100_000, past: Past | None = None) -> Vector | None:
    """The best values of the objectives in their order and the task's unit; None: nothing is valid.

    With a `past`, of the schedules that continue it. (Of ranks of the past nothing is asked.)
    Raises `ValueError` for what this oracle does not know, `TooHardError` where it would take more
    than `most_steps` placings of one occurrence and orders of ranks.
    """
    world = World(task, most_steps, past=past)
    search = _Search(world)
    choices = list(world.choices())
    bounds = [search.values(c, []) for c in choices]
    for k in sorted(range(len(choices)), key=lambda k: bounds[k]):
        if search.best is not None and bounds[k] >= search.best:
            break
        search.run(choices[k])
    return None if search.best is None else world.shown(search.best)


class World:
    """What a task says, in ticks."""

    def __init__(
        self,
        task: Task,
        most_steps: int,
        moments: Sequence[Number] = (),
        past: Past | None = None,
    ) -> None:
        """With `moments`, the times of a schedule, which is to be judged; or with a `past`."""
        self.left = most_steps
        begun = () if past is None else past.entries
        self.begun = {(e.id, e.occurrence): e for e in begun}
        if task.events or any("changes" in str(o) for o in task.objective):
            raise ValueError("this oracle does not know events or changes of plan")
        self.task = task
        self._known: dict[Any, int] = {}
        stated = [*_times(task), *moments, *(t for e in begun for t in (e.start, e.end))]
        stated += [] if past is None else [past.now]
        self.tick = _common(Fraction(task.number(t)) for t in stated)
        self.resources = {r.id: r for r in task.resources}
        self.calendars = {c.id: c for c in task.calendars}
        self.now = 0 if past is None else self.ticks(past.now)
        self.lags = [
            (p, self.ticks(p.min_lag), None if p.max_lag is None else self.ticks(p.max_lag))
            for p in task.precedence
        ]
        self.horizon = self._horizon()
        if moments:
            self.horizon = max(self.ticks(moment) for moment in moments)
        self.open = {
            c.id: [self._is_open(c, t) for t in range(self.horizon + 2)] for c in task.calendars
        }
        self.capacity = {
            r.id: [self._capacity(r, t) for t in range(-1, self.horizon + 2)]
            for r in task.resources
            if r.kind != "reservoir"
        }
        self.levels = [_terms(objective) for objective in task.objective]
        self._places: dict[tuple[int, int], list[tuple[int, int]]] = {}

    def ticks(self, time: Any) -> int:
        """A time of the task as a number of ticks."""
        if time not in self._known:
            found = Fraction(self.task.number(time)) / self.tick
            assert found.denominator == 1
            self._known[time] = int(found)
        return self._known[time]

    def spend(self) -> None:
        """Counts a step."""
        self.left -= 1
        if self.left < 0:
            raise TooHardError("too many placings or orders of ranks")

    def shown(self, values: Vector) -> Vector:
        """The values as they are reported: a reward counts as it is, unless it is in a sum."""
        return tuple(
            -v if o == "maximize_reward" else v
            for v, o in zip(values, self.task.objective, strict=True)
        )

    def capacity_at(self, resource: str, tick: int) -> int:
        """The capacity in [tick, tick + 1)."""
        return self.capacity[resource][tick + 1]

    def _horizon(self) -> int:
        """A time by which some best schedule ends (see the module)."""
        task = self.task
        dates = [self.now, *(self.ticks(e.end) for e in self.begun.values())]
        for action in task.actions:
            given = (action.release, action.start, action.earliest_end, action.due)
            dates += [self.ticks(t) for t in given if t is not None]
        dates += [self.ticks(g.due) for g in task.groups if g.due is not None]
        dates += [self.ticks(w.to) for r in task.resources for w in r.availability]
        dates += [self.ticks(c.at) for v in task.state for c in v.changes]
        dates += [
            self.ticks(p.to) for c in task.calendars for p in c.closed if isinstance(p, ClosedTime)
        ]
        work = sum(abs(least) + (most or 0) for _, least, most in self.lags)
        for action in task.actions:
            times = _occurrences(action)
            longest = max(most for _, _, most in self._durations(action))
            work += times * longest
            uses = len(action.uses) + max((len(m.uses) for m in action.modes), default=0)
            rows = [row for r in task.resources if r.setups for row in r.setups.times]
            work += times * uses * max((self.ticks(row.time) for row in rows), default=0)
        cycle = max((self.ticks(c.every) for c in task.calendars if c.every), default=1)
        found = max(dates) + max(1, work) * cycle
        return found if task.deadline is None else min(found, self.ticks(task.deadline))

    def _durations(self, action: Action) -> Iterator[tuple[Mode | None, int, int]]:
        for mode in action.modes or (None,):
            duration = action.duration if mode is None else mode.duration
            if isinstance(duration, DurationRange):
                yield mode, self.ticks(duration.min), self.ticks(duration.max)
            else:
                yield mode, self.ticks(duration), self.ticks(duration)

    def _is_open(self, calendar: Calendar, tick: int) -> bool:
        """Whether a calendar is open in [tick, tick + 1)."""
        if calendar.every is None:
            raise ValueError("this oracle does not know calendars by days of the week")
        for part in calendar.closed:
            if not isinstance(part, ClosedTime):
                raise ValueError("this oracle does not know dates")
            if self.ticks(part.from_) <= tick < self.ticks(part.to):
                return False
        every = self.ticks(calendar.every)
        for span in calendar.open:
            start, end = self.ticks(span.from_), self.ticks(span.to)
            end = end if end > start else end + every
            if (tick - start) % every < end - start:
                return True
        return False

    def _capacity(self, resource: Resource, tick: int) -> int:
        for window in resource.availability:
            if self.ticks(window.from_) <= tick < self.ticks(window.to):
                return window.capacity
        if resource.calendar is not None and tick >= 0:
            return resource.capacity if self.open[resource.calendar][tick] else 0
        return resource.capacity

    # Choices.

    def choices(self) -> Iterator[list[tuple[Way, int]]]:
        """Every list of occurrences (way, number) that keeps rules 1, 2.10 and 4.1."""
        per_action = []
        for action in self.task.actions:
            ways = list(self.ways(action))
            least, most = self.counts(action)
            own: list[tuple[Way, ...]] = []
            for count in range(least, most + 1):
                own += product(ways, repeat=count)
            per_action.append(own)
        size = math.prod(map(len, per_action))
        if size > 20_000:
            raise TooHardError(f"{size} choices")
        for taken in product(*per_action):
            by_name = {
                a.id: list(ways) for a, ways in zip(self.task.actions, taken, strict=True) if ways
            }
            if self.presence_holds(by_name) and self.couplings_hold(by_name):
                found = [(w, n) for ways in by_name.values() for n, w in enumerate(ways, 1)]
                if self._continues(found):
                    yield found

    def _continues(self, choice: Sequence[tuple[Way, int]]) -> bool:
        """Whether a choice has all that has begun, as it was begun."""
        chosen = {(way.action.id, number): way for way, number in choice}
        for key, entry in self.begun.items():
            way = chosen.get(key)
            if way is None or (way.mode and way.mode.id) != entry.mode:
                return False
            if way.holds != dict(entry.resources):
                return False
        return True

    def counts(self, action: Action) -> tuple[int, int]:
        least, most = action.occurrence_bounds
        if most is None:
            raise ValueError("this oracle does not know occurrences without a maximum")
        soft = any(action.id in g.actions and not g.required for g in self.task.groups)
        return (0 if soft else least), most

    def ways(self, action: Action) -> Iterator[Way]:
        for mode, least, most in self._durations(action):
            uses = [((None, n), use) for n, use in enumerate(action.uses)]
            if mode is not None:
                uses += [((mode.id, n), use) for n, use in enumerate(mode.uses)]
            for taken in product(*(use.alternatives for _, use in uses)):
                held = tuple(
                    Hold(place, resource, use.amount, use.family)
                    for (place, use), resource in zip(uses, taken, strict=True)
                )
                yield Way(action, mode, held, least, most)

    def presence_holds(self, there: Mapping[str, object]) -> bool:
        present = set(there)
        for group in self.task.groups:
            count = sum(name in present for name in group.actions)
            if count != len(group.actions) and (count or group.required):
                return False
        present |= {g.id for g in self.task.groups if set(g.actions) <= present}
        for rule in self.task.select:
            if rule.if_ is not None and rule.if_ not in present:
                continue
            count = sum(name in present for name in rule.actions)
            if rule.all_or_none and count not in (0, len(rule.actions)):
                return False
            if count < rule.min or (rule.max is not None and count > rule.max):
                return False
        return all(isinstance(g, StateGoal) or g in present for g in self.task.goals)

    def couplings_hold(self, there: Mapping[str, Sequence[Way]]) -> bool:
        for rule in self.task.couplings:
            if rule.if_ is not None and rule.then is not None:
                if rule.if_.action in there and rule.then.action in there:
                    (one,), (other,) = there[rule.if_.action], there[rule.then.action]
                    if _is_as(one, rule.if_) and not _is_as(other, rule.then):
                        return False
                continue
            values = []
            for named in rule.actions:
                for way in there.get(named.action, ()):
                    if "mode" in (rule.same, rule.different):
                        values.append({way.mode.id if way.mode else None})
                    else:
                        values.append(
                            {h.resource for h in way.held if named.use in (None, _own(h))}
                        )
            for one_value, other_value in combinations(values, 2):
                if rule.same and one_value != other_value:
                    return False
                if rule.different and one_value & other_value:
                    return False
        return True

    # Times of one occurrence.

    def places(self, way: Way, number: int) -> list[tuple[int, int]]:
        """Every (start, end) that keeps the rules about one occurrence alone."""
        key = id(way), number
        if key not in self._places:
            spans = (s for s in self._spans(way) if self._may_be(way.action.id, number, *s))
            self._places[key] = sorted(spans, key=lambda s: (s[1], s[0]))
        return self._places[key]

    def _may_be(self, name: str, number: int, start: int, end: int) -> bool:
        """Whether these times are those of what has begun, or not before the present."""
        entry = self.begun.get((name, number))
        if entry is None:
            return start >= self.now
        over = self.ticks(entry.end) <= self.now
        ended = end == self.ticks(entry.end) if over else end >= self.now
        return start == self.ticks(entry.start) and ended

    def _spans(self, way: Way) -> Iterator[tuple[int, int]]:
        for start in range(self.horizon + 1):
            for end in range(start, self.horizon + 1):
                if self.allows(way, start, end):
                    yield start, end

    def allows(self, way: Way, start: int, end: int) -> bool:
        """Whether one occurrence alone keeps rules 2 and 4.2 at these times."""
        action, number = way.action, self.ticks
        if start < max(0, number(action.release)) or end < start:
            return False
        if action.start is not None and start != number(action.start):
            return False
        if action.latest_start is not None and start > number(action.latest_start):
            return False
        if action.earliest_end is not None and end < number(action.earliest_end):
            return False
        limits = [self.task.deadline, action.deadline]
        limits += [g.deadline for g in self.task.groups if action.id in g.actions]
        if any(limit is not None and end > number(limit) for limit in limits):
            return False
        return self._lasts_right(way, start, end) and self._has_room(way, start, end)

    def _closed(self, way: Way, start: int, end: int, tick: int) -> bool:
        """Whether [tick, tick + 1) is closed for what lasts from start to end."""
        name = way.action.calendar
        if name is not None and not self.open[name][tick]:
            return True
        holds = way.held if way.pauses and start < end else ()
        return any(self.capacity_at(h.resource, tick) == 0 for h in holds)

    def closed_time(self, way: Way, start: int, end: int) -> int:
        """The closed ticks between start and end."""
        return sum(self._closed(way, start, end, tick) for tick in range(start, end))

    def _lasts_right(self, way: Way, start: int, end: int) -> bool:
        """Rules 2.2, 2.7 and 2.8."""
        shut = self.closed_time(way, start, end)
        if self._closed(way, start, end, start):
            return False
        if start < end and self._closed(way, start, end, end - 1):
            return False
        if not way.pauses:
            return shut == 0 and way.least <= end - start <= way.most
        longest = way.action.max_pause
        if longest is not None and shut > self.ticks(longest):
            return False
        return way.least <= end - start - shut <= way.most

    def _has_room(self, way: Way, start: int, end: int) -> bool:
        return all(
            self.room(name, [(way, start, end)], tick)
            for name in {h.resource for h in way.held}
            for tick in range(start, end)
        )

    def room(self, name: str, holders: Iterable[tuple[Way, int, int]], tick: int) -> bool:
        """Whether a resource has what is held of it in [tick, tick + 1) (rule 4.2)."""
        capacity, used = self.capacity_at(name, tick), 0
        for way, start, end in holders:
            if start <= tick < end and (capacity or not way.pauses):
                used += sum(h.amount for h in way.held if h.resource == name)
        return used <= capacity


class _Search:
    """Tries every placing of a choice."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.best: Vector | None = None

    def run(self, choice: list[tuple[Way, int]]) -> None:
        """Improves the best values by the best of one choice."""
        self.choice = choice
        self._visit(choice, [])

    def _visit(self, left: Sequence[tuple[Way, int]], placed: list[Placed]) -> None:
        values = self.values(self.choice, placed)
        if self.best is not None and values >= self.best:
            return
        if not left:
            if Judge(self.world, placed).accepts():
                self.best = values
            return
        (way, number), *rest = left
        for start, end in self.world.places(way, number):
            self.world.spend()
            new = Placed(way, number, start, end)
            if fits(self.world, new, placed):
                self._visit(rest, [*placed, new])

    # Objectives.

    def values(self, choice: Sequence[tuple[Way, int]], placed: Sequence[Placed]) -> Vector:
        """The values of a choice with some of it placed: no more than with all of it."""
        whole = len(placed) == len(choice)
        return tuple(
            sum(weight * self._value(name, choice, placed, whole) for weight, name in level)
            for level in self.world.levels
        )

    def _value(
        self, name: str, choice: Sequence[tuple[Way, int]], placed: Sequence[Placed], whole: bool
    ) -> Number:
        world, task = self.world, self.world.task
        if name == "minimize_cost":
            return sum(way.cost for way, _ in choice)
        if name == "maximize_reward":
            there = {way.action.id for way, _ in choice}
            own = sum(way.action.reward or 0 for way, _ in choice)
            return -own - sum(g.reward or 0 for g in task.groups if there >= set(g.actions))
        if name == "minimize_makespan":
            return exact(max((p.end for p in placed), default=0) * world.tick)
        if name in ("minimize_setup_time", "minimize_setup_cost"):
            done = setups(world, placed) if whole else []
            if name == "minimize_setup_cost":
                return sum(setup.cost for setup in done)
            return exact(sum(setup.time for setup in done) * world.tick)
        return self._dated(name, placed)

    def _dated(self, name: str, placed: Sequence[Placed]) -> Number:
        """The objectives on due dates and releases."""
        world, task = self.world, self.world.task
        items: list[tuple[int, int, Any, int]] = []
        grouped = {n for g in task.groups for n in g.actions}
        ends = {p.name: p.end for p in placed}
        for p in placed:
            release = max(0, world.ticks(p.way.action.release))
            alone = 0 if p.name in grouped else 1
            items.append(
                (_weight(p.way.action), p.end, p.way.action.due, alone * (p.end - release))
            )
        for group in task.groups:
            if group.actions and set(group.actions) <= set(ends):
                end = max(ends[n] for n in group.actions)
                members = [a for a in task.actions if a.id in group.actions]
                first = min(max(0, world.ticks(a.release)) for a in members)
                items.append((_weight(group), end, group.due, end - first))
        if name == "minimize_flow_time":
            return exact(sum(w * flow for w, _, _, flow in items) * world.tick)
        late = [(w, end - world.ticks(due)) for w, end, due, _ in items if due is not None]
        if name == "minimize_tardy":
            return sum(w for w, x in late if x > 0)
        found = {
            "minimize_tardiness": sum(w * max(0, x) for w, x in late),
            "minimize_max_tardiness": max((w * max(0, x) for w, x in late), default=0),
            "minimize_earliness": sum(w * max(0, -x) for w, x in late),
        }
        return exact(found[name] * world.tick)


def fits(world: World, new: Placed, placed: Sequence[Placed]) -> bool:
    """Whether one more occurrence keeps what it and the others placed decide."""
    both = [*placed, new]
    return (
        _numbered(new, placed)
        and _lags_hold(world, new, both)
        and all(_one_load(world, new, other) for other in placed)
        and all(
            world.room(name, [(p.way, p.start, p.end) for p in both], tick)
            for name in {h.resource for h in new.way.held}
            for tick in range(new.start, new.end)
        )
    )


def _numbered(new: Placed, placed: Sequence[Placed]) -> bool:
    """Rule 1.3; the occurrences of an action are placed in the order of their numbers."""
    for other in placed:
        if other.name == new.name:
            if new.start < other.start:
                return False
            if new.start < other.end and other.start < new.end:
                return False
    return True


def _lags_hold(world: World, new: Placed, placed: Sequence[Placed]) -> bool:
    """Rule 3.1, by times alone."""
    by_name = {p.name: p for p in placed}
    for arc, least, most in world.lags:
        if new.name in (arc.before, arc.after) and {arc.before, arc.after} <= set(by_name):
            of_before, of_after = arc.type.split("-")
            lag = _point(by_name[arc.after], of_after) - _point(by_name[arc.before], of_before)
            if lag < least or (most is not None and lag > most):
                return False
    return True


class Setup(NamedTuple):
    """The set-up of a resource between two consecutive uses, or before the first."""

    resource: str
    before: Placed | None
    after: Placed
    time: int
    cost: int


def setups(world: World, placed: Sequence[Placed]) -> list[Setup]:
    """Every set-up of resources that have some, or must not be idle (rule 4.3)."""
    found = []
    for resource in world.task.resources:
        if resource.kind == "reservoir" or (resource.setups is None and not resource.no_idle):
            continue
        held = users(placed, resource.id)
        if held and resource.setups is not None and resource.setups.initial is not None:
            first = held[0]
            said = _setup(world, resource, resource.setups.initial, _family(first, resource.id))
            found.append(Setup(resource.id, None, first, *said))
        for one, two in pairwise(held):
            said = _setup(world, resource, _family(one, resource.id), _family(two, resource.id))
            found.append(Setup(resource.id, one, two, *said))
    return found


def _setup(
    world: World, resource: Resource, before: str | None, after: str | None
) -> tuple[int, int]:
    """Time and cost of the most specific row that fits two families."""
    best: tuple[int, int, int] = (-1, 0, 0)
    for row in () if resource.setups is None else resource.setups.times:
        if before == after:
            fits = before is not None and row.from_ == row.to == before
        else:
            fits = row.from_ in ("*", before) and row.to in ("*", after)
        how = 2 * (row.from_ != "*") + (row.to != "*")
        if fits and how > best[0]:
            best = how, world.ticks(row.time), row.cost
    return best[1:]


def users(placed: Sequence[Placed], resource: str) -> list[Placed]:
    """What holds a resource for some time, in order."""
    held = [
        p for p in placed if p.start < p.end and any(h.resource == resource for h in p.way.held)
    ]
    return sorted(held, key=lambda p: (p.start, p.end))


@dataclass
class Judge:
    """Judges a whole placing; what two occurrences alone decide holds already."""

    world: World
    placed: Sequence[Placed]

    def accepts(self, ranks: Sequence[tuple[int, int]] | None = None) -> bool:
        """Whether set-ups and orders hold, and the rest under some ranks, or under given ones."""
        if not self._setups_hold() or not self._orders_hold():
            return False
        return some_ranks_do(self) if ranks is None else these_ranks_do(self, ranks)

    def _setups_hold(self) -> bool:
        for setup in setups(self.world, self.placed):
            ready = setup.time + (0 if setup.before is None else setup.before.end)
            if setup.after.start < ready:
                return False
            stays = setup.before is not None and self.world.resources[setup.resource].no_idle
            if stays and setup.after.start > max(ready, self.world.now):
                return False
        return True

    def _orders_hold(self) -> bool:
        for rule in self.world.task.sequences:
            if rule.consecutive is not None:
                first, second = rule.consecutive
                for name in self.world.resources if rule.resource is None else [rule.resource]:
                    held = [p.name for p in users(self.placed, name)]
                    pairs = list(pairwise(held))
                    if first in held and second in held and (first, second) not in pairs:
                        return False
            elif rule.same_order is not None and not self._same_order(
                rule.same_order, [list(row) for row in rule.jobs] or self._jobs(rule.same_order)
            ):
                return False
        return True

    def _same_order(self, names: Sequence[str], rows: Sequence[Sequence[str | None]]) -> bool:
        for k, n in combinations(range(len(names)), 2):
            one = [p.name for p in users(self.placed, names[k])]
            two = [p.name for p in users(self.placed, names[n])]
            places = [
                (one.index(r[k]), two.index(r[n])) for r in rows if r[k] in one and r[n] in two
            ]
            if any((a - c) * (b - d) < 0 for (a, b), (c, d) in combinations(places, 2)):
                return False
        return True

    def _jobs(self, names: Sequence[str]) -> list[list[str | None]]:
        """A row for each group, and for each action in no group: who may hold each resource."""
        task = self.world.task
        jobs = [list(g.actions) for g in task.groups]
        jobs += [[a.id] for a in task.actions if not any(a.id in job for job in jobs)]
        may = {
            a.id: {
                r for u in (*a.uses, *(u for m in a.modes for u in m.uses)) for r in u.alternatives
            }
            for a in task.actions
        }
        return [[next((a for a in job if r in may[a]), None) for r in names] for job in jobs]


def _one_load(world: World, one: Placed, other: Placed) -> bool:
    """Rule 4.6, by times alone: what overlaps has one start, one end and one family."""
    if not (one.start < other.end and other.start < one.end):
        return True
    if one.start == one.end or other.start == other.end:
        return True
    both = {h.resource for h in one.way.held} & {h.resource for h in other.way.held}
    return all(
        (one.start, one.end) == (other.start, other.end) and _family(one, r) == _family(other, r)
        for r in both
        if world.resources[r].kind == "batch"
    )


def _family(placed: Placed, resource: str) -> str | None:
    return next((h.family for h in placed.way.held if h.resource == resource), None)


def _point(placed: Placed, which: str) -> int:
    return placed.start if which == "start" else placed.end


def _weight(part: Any) -> int:
    return 1 if part.weight is None else int(part.weight)


def _own(hold: Hold) -> int | None:
    """The number of a use among the action's own; -1 for one of a mode."""
    return hold.place[1] if hold.place[0] is None else -1


def _is_as(way: Way, said: Any) -> bool:
    if said.resource is not None:
        return any(h.resource == said.resource for h in way.held if said.use in (None, _own(h)))
    return way.mode is not None and way.mode.id in (said.modes or (said.mode,))


def _terms(objective: Any) -> list[tuple[int, str]]:
    if isinstance(objective, str):
        return [(1, objective)]
    return [(term.weight, term.objective) for term in objective.sum]


def _occurrences(action: Action) -> int:
    most = action.occurrence_bounds[1]
    if most is None:
        raise ValueError("this oracle does not know occurrences without a maximum")
    return most


def _times(task: Task) -> Iterator[Any]:
    """All times of a task, as they were written."""
    found: list[Any] = [task.deadline]
    for action in task.actions:
        found += [action.release, action.deadline, action.due, action.start, action.latest_start]
        found += [action.earliest_end, action.max_pause]
        for duration in (action.duration, *(mode.duration for mode in action.modes)):
            if isinstance(duration, DurationRange):
                found += [duration.min, duration.max]
            else:
                found.append(duration)
    for arc in task.precedence:
        found += [arc.min_lag, arc.max_lag]
    for group in task.groups:
        found += [group.deadline, group.due]
    for resource in task.resources:
        found += [t for w in resource.availability for t in (w.from_, w.to)]
        found += [row.time for row in resource.setups.times] if resource.setups else []
    found += [change.at for variable in task.state for change in variable.changes]
    for calendar in task.calendars:
        found += [calendar.every]
        if calendar.every is not None:
            found += [t for span in calendar.open for t in (span.from_, span.to)]
        spans = [part for part in calendar.closed if isinstance(part, ClosedTime)]
        found += [t for part in spans for t in (part.from_, part.to)]
    yield from (time for time in found if time is not None)


def _common(times: Iterable[Fraction]) -> Fraction:
    """The greatest number that divides all times; 1 where there are none but 0."""
    listed = list(times)
    below = math.lcm(*(t.denominator for t in listed))
    return Fraction(math.gcd(*(int(t * below) for t in listed)) or below, below)
