"""Whether a placing of all occurrences is valid under some ranks, by trying all orders of ranks.

Written from docs/semantics.md: happenings and ranks, rules 3.1, 4.2, 4.6, 5, 6 and 7. Ranks are
only compared at one instant. So occurrences that share no instant with others have rank 0, and of
each set of others that are linked by instants every weak order is tried.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache
from itertools import permutations, product
from typing import TYPE_CHECKING, Any, NamedTuple

from irc.model import StateGoal
from irc.model.quantities import Number

if TYPE_CHECKING:
    from oracles.exhaustive import Judge, Placed

Point = tuple[int, Number]
"""A time and a rank."""


class _Change(NamedTuple):
    """A timed change of state."""

    var: str
    at: int
    value: Any


def some_ranks_do(judge: Judge) -> bool:
    """Whether some ranks satisfy all rules that ask for them."""
    task = judge.world.task
    if not task.state and not any(r.kind == "reservoir" for r in task.resources):
        return True  # With all ranks 0 nothing comes too early that its time allows.
    return any(_Ranked(judge, ranks).holds() for ranks in _ranks(judge))


def these_ranks_do(judge: Judge, given: Sequence[tuple[int, int]]) -> bool:
    """Whether the ranks of the start and end of each occurrence satisfy all rules.

    The timed changes may have any: between those given, and below and above them.
    """
    least = min((rank for pair in given for rank in pair), default=0)
    most = max((rank for pair in given for rank in pair), default=0)
    width = len(timed_changes(judge))
    for p, (a, b) in zip(judge.placed, given, strict=True):
        if a != b and not p.way.ends_freely:
            return False
    between = [
        Fraction(k, width + 1) for k in range((least - 1) * (width + 1), (most + 2) * (width + 1))
    ]
    return any(
        _Ranked(judge, _Nodes(tuple(given), changes)).holds()
        for changes in product(between, repeat=width)
    )


class _Nodes(NamedTuple):
    """The ranks of the start and end of each occurrence, and of each timed change."""

    occurrences: tuple[tuple[int, int], ...]
    changes: tuple[Number, ...]


def timed_changes(judge: Judge) -> list[_Change]:
    """The timed changes until the last end."""
    last = max((p.end for p in judge.placed), default=0)
    found = [
        _Change(v.id, judge.world.ticks(c.at), c.value)
        for v in judge.world.task.state
        for c in v.changes
    ]
    return [change for change in found if change.at <= last]


def _ranks(judge: Judge) -> Iterator[_Nodes]:
    """Every order of ranks that can make a difference."""
    own: list[tuple[int, int]] = []
    instants: list[set[int]] = []
    for p in judge.placed:
        own.append((len(instants), len(instants) + p.way.ends_freely))
        instants += [{p.start}, {p.end}] if p.way.ends_freely else [{p.start, p.end}]
    first = len(instants)
    instants += [{change.at} for change in timed_changes(judge)]
    linked = _linked(instants)
    for orders in product(*(_weak_orders(len(nodes)) for nodes in linked)):
        rank = dict.fromkeys(range(len(instants)), 0)
        for nodes, order in zip(linked, orders, strict=True):
            rank |= zip(nodes, order, strict=True)
        judge.world.spend()
        yield _Nodes(
            tuple((rank[a], rank[b]) for a, b in own),
            tuple(rank[k] for k in range(first, len(instants))),
        )


def _linked(instants: Sequence[set[int]]) -> list[list[int]]:
    """Nodes in sets that share instants; those that share none are left out."""
    parts: list[tuple[list[int], set[int]]] = []
    for node, own in enumerate(instants):
        touched = [part for part in parts if part[1] & own]
        nodes = [n for part in touched for n in part[0]] + [node]
        times = set(own).union(*(part[1] for part in touched))
        parts = [part for part in parts if part not in touched] + [(nodes, times)]
    return [nodes for nodes, _ in parts if len(nodes) > 1]


@cache
def _weak_orders(count: int) -> list[tuple[int, ...]]:
    """Every way to rank some things, several of which may have one rank."""
    return [
        ranks
        for ranks in product(range(count), repeat=count)
        if set(ranks) == set(range(max(ranks) + 1))
    ]


class _Span(NamedTuple):
    placed: Placed
    start: Point
    end: Point


class _Ranked:
    """A placing with ranks."""

    def __init__(self, judge: Judge, ranks: _Nodes) -> None:
        self.judge, self.world = judge, judge.world
        self.spans = [
            _Span(p, (p.start, a), (p.end, b))
            for p, (a, b) in zip(judge.placed, ranks.occurrences, strict=True)
        ]
        self.changes = list(zip(timed_changes(judge), ranks.changes, strict=True))

    def holds(self) -> bool:
        """Whether every rule that asks for ranks holds."""
        return (
            self._durations()
            and self._lags()
            and self._timed()
            and self._capacity()
            and self._loads()
            and self._stock()
            and self._state()
        )

    def _durations(self) -> bool:
        """(least, 0) ≤ (end, end rank) − (start, rank) ≤ (most, 0); a pause has no greatest."""
        for p, start, end in self.spans:
            if p.way.ends_freely:
                lasts, ranks = end[0] - start[0], end[1] - start[1]
                if (lasts, ranks) < (p.way.least, 0):
                    return False
                if not p.way.pauses and (lasts, ranks) > (p.way.most, 0):
                    return False
        return True

    def _lags(self) -> bool:
        spans = {s.placed.name: s for s in self.spans}
        for arc, least, _ in self.world.lags:
            if arc.before in spans and arc.after in spans:
                time, rank = getattr(spans[arc.before], _END[arc.type.split("-")[0]])
                if getattr(spans[arc.after], _END[arc.type.split("-")[1]]) < (time + least, rank):
                    return False
        return True

    def _timed(self) -> bool:
        """What starts at the time of a change and has to do with its variable comes after it."""
        for change, rank in self.changes:
            for p, start, _ in self.spans:
                named = {x.var for x in (*p.way.parts("conditions"), *p.way.parts("effects"))}
                if start[0] == change.at and change.var in named and start[1] < rank:
                    return False
        return True

    def _capacity(self) -> bool:
        """Rule 4.2: among the happenings of an instant the larger capacity counts."""
        points = {point for s in self.spans for point in (s.start, s.end)}
        for name in self.world.capacity:
            for point in points:
                capacity = max(self.world.capacity_at(name, point[0] - k) for k in (0, 1))
                used = 0
                for p, start, end in self.spans:
                    if p.start < p.end and start <= point < end and (capacity or not p.way.pauses):
                        used += sum(h.amount for h in p.way.held if h.resource == name)
                if used > capacity:
                    return False
        return True

    def _loads(self) -> bool:
        """Rule 4.6, for what touches in time."""
        for name, resource in self.world.resources.items():
            if resource.kind != "batch":
                continue
            own = [
                s
                for s in self.spans
                if s.placed.start < s.placed.end
                and any(h.resource == name for h in s.placed.way.held)
            ]
            for one, two in permutations(own, 2):
                apart = one.start[0] != two.start[0] or one.end[0] != two.end[0]
                if apart and one.start < two.end and two.start < one.end:
                    return False
        return True

    def _stock(self) -> bool:
        """Rule 5: some order of the happenings keeps every level after each of them."""
        bounds = {r.id: r for r in self.world.task.resources if r.kind == "reservoir"}
        levels = {name: r.initial for name, r in bounds.items()}
        happenings: dict[Point, dict[int, dict[str, int]]] = {}
        for k, (p, start, end) in enumerate(self.spans):
            for field, sign, usual in (("consumes", -1, "start"), ("produces", 1, "end")):
                for change in p.way.parts(field):
                    at_start = (change.at or usual) == "start"
                    own = happenings.setdefault(start if at_start else end, {}).setdefault(k, {})
                    own[change.resource] = own.get(change.resource, 0) + sign * change.amount
        for point in sorted(happenings):
            changes = list(happenings[point].values())
            if not any(_keeps(bounds, levels, order) for order in permutations(changes)):
                return False
            for change in changes:
                levels = {name: level + change.get(name, 0) for name, level in levels.items()}
        return True

    def _state(self) -> bool:
        """Rules 6.2 to 6.4 and 7.1: one instant and rank after another."""
        world: dict[str, Any] = {v.id: v.start_value for v in self.world.task.state}
        happenings = self._happenings()
        running: list[tuple[Point, Point, Any]] = []
        for p, start, end in self.spans:
            if start != end:
                held = [c for c in p.way.parts("conditions") if c.at == "all"]
                running += [(start, end, c) for c in held]
        for point in sorted(happenings):
            for start, end, condition in running:
                if start < point <= end and not _suits(world, condition):
                    return False
            own = list(happenings[point].values())
            if any(not _suits(world, c) for conditions, _ in own for c in conditions):
                return False
            if any(_interfere(one, two) for one, two in permutations(own, 2)):
                return False
            for _, effects in own:
                given = _given(world, effects)
                if given is None:
                    return False
                world |= given
            if not self._within(world):
                return False
        goals = [g for g in self.world.task.goals if isinstance(g, StateGoal)]
        return all(_suits(world, goal) for goal in goals)

    def _happenings(self) -> dict[Point, dict[object, tuple[list[Any], list[Any]]]]:
        """At each point the happenings there: what each reads just before, and its effects."""
        found: dict[Point, dict[object, tuple[list[Any], list[Any]]]] = {}
        for k, (p, start, end) in enumerate(self.spans):
            conditions, effects = p.way.parts("conditions"), p.way.parts("effects")
            if start == end:
                found.setdefault(start, {})[k] = conditions, effects
                continue
            for point, at in ((start, "start"), (end, "end")):
                found.setdefault(point, {})[k] = (
                    [c for c in conditions if c.at == at],
                    [e for e in effects if e.at == at],
                )
        for change, rank in self.changes:
            found.setdefault((change.at, rank), {})[change] = [], [change]
        return found

    def _within(self, world: Mapping[str, Any]) -> bool:
        for variable in self.world.task.state:
            if variable.is_number:
                low, high, level = variable.min, variable.max, world[variable.id]
                if (low is not None and level < low) or (high is not None and level > high):
                    return False
        return True


_END = {"start": "start", "finish": "end"}


def _keeps(bounds: Mapping[str, Any], before: Mapping[str, int], order: Sequence[Any]) -> bool:
    levels = dict(before)
    for change in order:
        for name, amount in change.items():
            levels[name] += amount
            most = bounds[name].max
            if levels[name] < bounds[name].min or (most is not None and levels[name] > most):
                return False
    return True


def _interfere(one: tuple[list[Any], list[Any]], two: tuple[list[Any], list[Any]]) -> bool:
    changed = {effect.var for effect in one[1]}
    return any(x.var in changed for part in two for x in part)


def _suits(world: Mapping[str, Any], wanted: Any) -> bool:
    level = world[wanted.var]
    if not wanted.asks_for_a_level:
        return bool(
            level == wanted.value and isinstance(level, bool) == isinstance(wanted.value, bool)
        )
    if wanted.equals is not None and level != wanted.equals:
        return False
    if wanted.at_least is not None and level < wanted.at_least:
        return False
    return wanted.at_most is None or level <= wanted.at_most


def _given(world: Mapping[str, Any], effects: Sequence[Any]) -> dict[str, Any] | None:
    """The values that one happening gives; None where it gives a variable two."""
    values: dict[str, Any] = {}
    sums: dict[str, Number] = {}
    for effect in effects:
        if isinstance(effect, _Change) or not effect.changes_a_level:
            value = effect.value
        elif effect.add is not None:
            sums[effect.var] = sums.get(effect.var, 0) + effect.add
            continue
        else:
            value = effect.set
        if values.setdefault(effect.var, value) != value:
            return None
    if sums.keys() & values.keys():
        return None
    return values | {var: world[var] + amount for var, amount in sums.items()}
