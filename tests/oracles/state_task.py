"""A task in whole ticks, plain enough to reason about: what the state oracles read.

The tick is the greatest number that divides all times of the task (docs/semantics.md). Nothing is
dropped: events and `minimize_changes` are refused with `ValueError`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any, NamedTuple, TypeVar

from irc.model import Action, DurationRange, Group, Mode, Resource, StateGoal, Task, Use
from irc.model.base import StateValue
from irc.model.quantities import Number, exact

Value = StateValue | Number | None


class Range(NamedTuple):
    """The levels that a condition on a number allows, both ends included; None: no limit."""

    least: Number | None
    most: Number | None


class Shift(NamedTuple):
    """A change of a number by an amount."""

    amount: Number


Wanted = StateValue | Range
"""What a condition asks of a variable."""

Given = StateValue | Number | Shift
"""What an effect gives a variable."""

Fact = tuple[str, Wanted]
Held = tuple[tuple[str, int], ...]
"""Resources with the amounts held of each, by name."""

_OBJECTIVES = ("minimize_makespan", "minimize_tardiness", "maximize_reward", "minimize_cost")

_Part = TypeVar("_Part", Action, Resource, Group)


@dataclass(frozen=True, eq=False)
class Option:
    """One way to carry out an action: its mode, the bounds of its duration, and what it holds.

    Compared by identity: a job has each of its options once.
    """

    mode: str | None
    least: int
    most: int
    held: Held

    @property
    def ends_freely(self) -> bool:
        """Whether the duration is a range, so that the end has a rank of its own."""
        return self.least < self.most


@dataclass(frozen=True)
class Job:
    """An action. `deadline` is the earliest of its own, its groups' and the task's."""

    id: str
    options: tuple[Option, ...]
    least: int
    most: int | None
    release: int
    deadline: int | None
    start: int | None
    latest_start: int | None
    earliest_end: int | None
    due: int | None
    weight: int
    reward: int
    cost: int
    conditions: tuple[tuple[str, str, Wanted], ...]
    effects: tuple[tuple[str, str, Given], ...]
    stock: tuple[tuple[str, int, bool], ...]
    """(reservoir, change of its level, whether at the end)."""

    @property
    def touches_state(self) -> bool:
        """Whether it reads or changes a variable."""
        return bool(self.conditions or self.effects)

    @property
    def shares(self) -> bool:
        """Whether it holds a resource or changes stock."""
        return bool(self.stock) or any(option.held for option in self.options)


@dataclass(frozen=True)
class Arc:
    """least ≤ (point of `after`) − (point of `before`) ≤ most, in ticks; jobs by index."""

    before: int
    from_end: bool
    after: int
    to_end: bool
    least: int
    most: int | None


@dataclass(frozen=True)
class Renewable:
    """Its capacity, and the windows [from, to) in which it has another."""

    capacity: int
    windows: tuple[tuple[int, int, int], ...]

    def at(self, instant: int) -> int:
        """The capacity at an instant."""
        return next((c for a, b, c in self.windows if a <= instant < b), self.capacity)


@dataclass(frozen=True)
class Stock:
    """A reservoir; `most` is None where nothing bounds it."""

    initial: int
    least: int
    most: int | None

    def holds(self, level: int) -> bool:
        """Whether a level is within its bounds."""
        return self.least <= level and (self.most is None or level <= self.most)


@dataclass(frozen=True)
class Party:
    """A group: its members by index."""

    members: tuple[int, ...]
    required: bool
    reward: int
    due: int | None
    weight: int


@dataclass(frozen=True)
class Plain:
    """A task in ticks of `tick` units."""

    tick: Fraction
    jobs: tuple[Job, ...]
    arcs: tuple[Arc, ...]
    renewables: dict[str, Renewable]
    stocks: dict[str, Stock]
    initial: dict[str, Value]
    bounds: tuple[Fact, ...]
    """What every number keeps at all times."""
    parties: tuple[Party, ...]
    value_goals: tuple[Fact, ...]
    action_goals: frozenset[int]
    objective: tuple[str, ...]

    def time(self, ticks: int) -> Number:
        """Ticks in the task's unit."""
        return exact(self.tick * ticks)

    @property
    def last_constant(self) -> int:
        """The last instant at which the task itself changes: from then on all times are alike."""
        instants = [0, *(job.release for job in self.jobs)]
        instants += [job.start for job in self.jobs if job.start is not None]
        instants += [job.earliest_end for job in self.jobs if job.earliest_end is not None]
        instants += [w[1] for r in self.renewables.values() for w in r.windows]
        return max(instants)

    def is_selection(self, counts: Sequence[int]) -> bool:
        """Whether these numbers of occurrences keep rule 1 and the goals that name actions."""
        decided = {m for party in self.parties if not party.required for m in party.members}
        for j, (job, count) in enumerate(zip(self.jobs, counts, strict=True)):
            if count < job.least and j not in decided:
                return False
            if job.most is not None and count > job.most:
                return False
        for party in self.parties:
            present = sum(counts[m] > 0 for m in party.members)
            if present != len(party.members) and (present or party.required):
                return False
        return all(counts[j] for j in self.action_goals)

    def reward(self, counts: Sequence[int]) -> int:
        """What a selection earns, whenever it happens."""
        own = sum(job.reward * n for job, n in zip(self.jobs, counts, strict=True))
        return own + sum(p.reward for p in self.parties if p.members and counts[p.members[0]])

    def cost(self, counts: Sequence[int]) -> int:
        """What a selection costs, whenever it happens."""
        return sum(job.cost * n for job, n in zip(self.jobs, counts, strict=True))


def read(task: Task) -> Plain:
    """The task in ticks. Raises `ValueError` for what the state oracles do not know."""
    if task.events:
        raise ValueError("this oracle does not know events")
    if any(variable.changes for variable in task.state):
        raise ValueError("this oracle does not know timed changes of state")
    if task.calendars or any(a.calendar or a.breaks != "avoid" for a in task.actions):
        raise ValueError("this oracle does not know calendars or pauses")
    if any(resource.setups for resource in task.resources):
        raise ValueError("this oracle does not know set-ups")
    if task.sequences or any(r.kind == "batch" or r.no_idle for r in task.resources):
        raise ValueError("this oracle does not know orders of uses, loads or idle time")
    if task.couplings or task.select:
        raise ValueError("this oracle does not know couplings or selections")
    for objective in task.objective:
        if objective not in _OBJECTIVES:
            raise ValueError(f"this oracle does not know {objective!r}")
    return _Reader(task).read()


class _Reader:
    def __init__(self, task: Task) -> None:
        self.task = task
        self.actions = _by_id(task.actions)
        self.resources = _by_id(task.resources)
        self.groups = _by_id(task.groups)
        self.index = {name: j for j, name in enumerate(self.actions)}
        stated = [value for value in self._times() if value is not None]
        self.tick = _gcd(Fraction(task.number(value)) for value in stated)

    def read(self) -> Plain:
        task = self.task
        stocks = [r for r in self.resources.values() if r.kind == "reservoir"]
        renewables = [r for r in self.resources.values() if r.kind == "renewable"]
        return Plain(
            tick=self.tick,
            jobs=tuple(self._job(action) for action in self.actions.values()),
            arcs=tuple(self._arc(arc) for arc in dict.fromkeys(task.precedence)),
            renewables={r.id: self._renewable(r) for r in renewables},
            stocks={r.id: Stock(r.initial, r.min, r.max) for r in stocks},
            initial={v.id: v.start_value for v in task.state},
            bounds=tuple((v.id, Range(v.min, v.max)) for v in task.state if v.kind == "number"),
            parties=tuple(self._party(group) for group in self.groups.values()),
            value_goals=tuple((g.var, _wanted(g)) for g in task.goals if isinstance(g, StateGoal)),
            action_goals=frozenset(
                self.index[g] for g in task.goals if not isinstance(g, StateGoal)
            ),
            objective=task.objective,
        )

    def _times(self) -> Iterator[Any]:
        """All times of the task, as they were written."""
        for action in self.actions.values():
            yield from (action.release, action.deadline, action.due, action.start)
            yield action.latest_start
            yield action.earliest_end
            for duration in (action.duration, *(mode.duration for mode in action.modes)):
                if isinstance(duration, DurationRange):
                    yield from (duration.min, duration.max)
                else:
                    yield duration
        for arc in self.task.precedence:
            yield from (arc.min_lag, arc.max_lag)
        for group in self.groups.values():
            yield from (group.deadline, group.due)
        for resource in self.resources.values():
            for window in resource.availability:
                yield from (window.from_, window.to)
        yield self.task.deadline

    def _ticks(self, value: Any) -> int:
        ticks = Fraction(self.task.number(value)) / self.tick
        return int(ticks)

    def _maybe(self, value: Any) -> int | None:
        return None if value is None else self._ticks(value)

    def _job(self, action: Action) -> Job:
        groups = [g for g in self.groups.values() if action.id in g.actions]
        limits = [action.deadline, self.task.deadline, *(g.deadline for g in groups)]
        stated = [self._ticks(limit) for limit in limits if limit is not None]
        least, most = action.occurrence_bounds
        stock = [(c.resource, -c.amount, c.at == "end") for c in action.consumes]
        stock += [(c.resource, c.amount, c.at != "start") for c in action.produces]
        return Job(
            id=action.id,
            options=tuple({(o.mode, o.held): o for o in self._options(action)}.values()),
            least=least,
            most=most,
            release=max(0, self._ticks(action.release)),
            deadline=min(stated, default=None),
            start=self._maybe(action.start),
            latest_start=self._maybe(action.latest_start),
            earliest_end=self._maybe(action.earliest_end),
            due=self._maybe(action.due),
            weight=1 if action.weight is None else action.weight,
            reward=action.reward or 0,
            cost=action.cost or 0,
            conditions=tuple((c.at, c.var, _wanted(c)) for c in action.conditions),
            effects=tuple((e.at, e.var, _given(e)) for e in action.effects),
            stock=tuple(stock),
        )

    def _options(self, action: Action) -> Iterator[Option]:
        ways: list[Mode | None] = list(action.modes) or [None]
        for mode in ways:
            duration = action.duration if mode is None else mode.duration
            if isinstance(duration, DurationRange):
                least, most = self._ticks(duration.min), self._ticks(duration.max)
            else:
                least = most = self._ticks(duration)
            uses = action.uses if mode is None else action.uses + mode.uses
            for held in _holdings(uses):
                yield Option(None if mode is None else mode.id, least, most, held)

    def _arc(self, arc: Any) -> Arc:
        before, after = arc.type.split("-")
        return Arc(
            self.index[arc.before],
            before == "finish",
            self.index[arc.after],
            after == "finish",
            self._ticks(arc.min_lag),
            self._maybe(arc.max_lag),
        )

    def _renewable(self, resource: Resource) -> Renewable:
        windows = [
            (self._ticks(w.from_), self._ticks(w.to), w.capacity) for w in resource.availability
        ]
        return Renewable(resource.capacity, tuple(windows))

    def _party(self, group: Group) -> Party:
        return Party(
            tuple(self.index[name] for name in dict.fromkeys(group.actions)),
            group.required,
            group.reward or 0,
            self._maybe(group.due),
            1 if group.weight is None else group.weight,
        )


def suits(value: Value, wanted: Wanted) -> bool:
    """Whether a variable's value is what is wanted."""
    if not isinstance(wanted, Range):
        return value == wanted
    assert value is not None
    assert not isinstance(value, str)
    low = wanted.least is None or value >= wanted.least
    return low and (wanted.most is None or value <= wanted.most)


def become(value: Value, given: Given) -> Value:
    """The value after an effect."""
    if not isinstance(given, Shift):
        return given
    assert value is not None
    assert not isinstance(value, str)
    return value + given.amount


def together(effects: Iterable[tuple[str, Given]]) -> frozenset[tuple[str, Given]]:
    """The effects of one happening: what it adds to a number counts once, as a sum."""
    sums: dict[str, Number] = {}
    found: set[tuple[str, Given]] = set()
    for var, given in effects:
        if isinstance(given, Shift):
            sums[var] = sums.get(var, 0) + given.amount
        else:
            found.add((var, given))
    return frozenset(found | {(var, Shift(amount)) for var, amount in sums.items()})


def _wanted(fact: Any) -> Wanted:
    if fact.equals is not None:
        return Range(fact.equals, fact.equals)
    if fact.at_least is None and fact.at_most is None:
        value: StateValue = fact.value
        return value
    return Range(fact.at_least, fact.at_most)


def _given(effect: Any) -> Given:
    if effect.add is not None:
        return Shift(effect.add)
    given: Given = effect.value if effect.set is None else effect.set
    return given


def _holdings(uses: Sequence[Use]) -> Iterator[Held]:
    """What is held, for every way to choose."""
    for chosen in product(*(use.alternatives for use in uses)):
        held: dict[str, int] = {}
        for use, resource in zip(uses, chosen, strict=True):
            held[resource] = held.get(resource, 0) + use.amount
        yield tuple(sorted(held.items()))


def _gcd(times: Iterable[Fraction]) -> Fraction:
    tick = Fraction(0)
    for time in times:
        common = tick.denominator * time.denominator // math.gcd(tick.denominator, time.denominator)
        tick = Fraction(math.gcd(int(tick * common), int(time * common)), common)
    return tick or Fraction(1)


def _by_id(parts: Sequence[_Part]) -> dict[str, _Part]:
    """Parts by id; an exact repetition counts once (docs/ir.md, "Names")."""
    known: dict[str, _Part] = {}
    for part in parts:
        if known.setdefault(part.id, part) != part:
            raise ValueError(f"{part.id!r} is given twice with different contents")
    return known
