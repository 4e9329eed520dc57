"""`Problem` → PDDL2.1: once-only parameterless actions, positive conditions only.

Every activity has a fact `todo` that its start takes away and a fact `done` that its end gives.
A precedence is a condition on such facts; a minimum lag is a planner-only *wait* between them; a
maximum lag (or a negative minimum) is a planner-only *envelope*: it must have begun before the
one point and must still run at the other, and it is no longer than the lag. Windows are timed
initial literals. Capacity is one token fact for each unit (measured: numeric counters let a
planner take and give back at one instant, which validators reject); only where tokens would
multiply beyond a budget a counter takes their place, and the re-timed plan is validated anyway.

Planners separate dependent happenings by an epsilon, so a chain of k of them ends k epsilons
late. What bounds time from above therefore gets `slack`, and one tick is `scale` planner units,
so that all slack together stays below one tick: then an exact integer schedule with the same
choices and order exists (a relaxed cycle of the temporal network is short of 0 by less than 1,
and weights are whole).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations, product
from math import ceil, comb
from typing import Any, NamedTuple

from irc.backend import Refusal
from irc.network import Network, components, is_acyclic
from irc.problem import Activity, Problem
from irc_pddl21.domain import Encoding, Operator, TimedLiteral
from irc_pddl21.names import NameTable

DOMAIN_FILE, PROBLEM_FILE = "domain.pddl", "problem.pddl"

EPSILON = Fraction(1, 1000)
"""The separation of dependent happenings in OPTIC and kairos, in planner time."""

MAX_VARIANTS = 256
"""An activity with more ground variants gets counters in place of tokens, or is refused."""

_GREATEST_SCALE = 10_000


Point = int
"""The start (2i) or the end (2i + 1) of activity i."""


class AtLeast(NamedTuple):
    """`time(to) >= time(frm) + lag`."""

    frm: Point
    to: Point
    lag: int


@dataclass(frozen=True, slots=True)
class Variant:
    """One way to ground an activity: the shared resource of each claim, and the tokens it takes."""

    resources: tuple[int, ...]
    tokens: tuple[str, ...]
    takes: tuple[tuple[str, int], ...]


_ONLY_ONE = Variant((), (), ())


@dataclass
class Grounded:
    """An encoding with the meaning of its names.

    `actions` maps an operator's name to (activity index, shared resource of each claim).
    """

    encoding: Encoding
    scale: int
    slack: int
    actions: dict[str, tuple[int, tuple[int, ...]]] = field(default_factory=dict)
    waits: dict[str, str] = field(default_factory=dict)
    tokens: dict[str, str] = field(default_factory=dict)


def encode(problem: Problem, epsilon: Fraction = EPSILON) -> Grounded:
    """The problem as operators and facts, for planners with the given epsilon.

    Raises `Refusal` where an activity has too many ways to be carried out.
    """
    return _Encoder(problem, epsilon).run()


def encode_files(problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
    """The two PDDL files, and the meaning of their names and numbers for the manifest."""
    grounded = encode(problem)
    files = {
        DOMAIN_FILE: grounded.encoding.domain_text(),
        PROBLEM_FILE: grounded.encoding.problem_text(),
    }
    return files, names_of(problem, grounded)


def names_of(problem: Problem, grounded: Grounded) -> dict[str, Any]:
    """What stands in the manifest, and all that decoding needs."""
    actions: dict[str, dict[str, Any]] = {}
    for name, (i, resources) in grounded.actions.items():
        activity = problem.activities[i]
        actions[name] = {"action": activity.id}
        if resources:
            actions[name]["uses"] = {
                str(claim.use): problem.shared[r].id
                for claim, r in zip(activity.claims, resources, strict=True)
            }
    return {
        "planner_units_per_tick": grounded.scale,
        "slack": grounded.slack,
        "actions": actions,
        "planner_only": grounded.waits,
        "tokens": grounded.tokens,
        "facts": {
            "todo_*": "the action has not started",
            "begun_*": "the action has started",
            "done_*": "the action has ended",
            "lag_*": "the minimum lag after that point is over",
            "after_*, during_*": "the envelope of a maximum lag has begun, still runs",
            "free_*": "this unit of the resource is free",
            "open_*, released_*": "the time window is not closed yet, has opened",
        },
    }


class _Encoder:
    def __init__(self, problem: Problem, epsilon: Fraction) -> None:
        self.problem = problem
        self.names = NameTable()
        self.encoding = Encoding()
        order = sorted(
            range(len(problem.activities)),
            key=lambda i: (-(problem.activities[i].duration_min + problem.tails[i]), i),
        )
        self.order = order
        self.base = {i: self.names.new(problem.activities[i].id) for i in range(len(order))}
        facts, waits, envelopes = _sort_constraints(problem)
        self.fact_arcs, self.envelopes = facts, envelopes
        self.waits: dict[tuple[Point, int], list[Point]] = {}
        for arc in waits:
            self.waits.setdefault((arc.frm, arc.lag), []).append(arc.to)
        self.scale, self.slack = self._scale(epsilon)
        self.out = Grounded(self.encoding, self.scale, self.slack)
        self.begun: set[int] = set()
        self.conditions: list[list[str]] = [[] for _ in range(2 * len(order))]

    def _scale(self, epsilon: Fraction) -> tuple[int, int]:
        """Planner units per tick, and the slack of each constraint that bounds from above."""
        closings = len(self.envelopes) + sum(
            self.problem.effective_deadline(i) is not None or a.start is not None
            for i, a in enumerate(self.problem.activities)
        )
        if not closings:
            return 1, 0
        happenings = 2 * (len(self.problem.activities) + len(self.waits) + len(self.envelopes) + 1)
        slack = ceil(epsilon * happenings)
        scale = 10
        while scale <= slack * (closings + 1) and scale < _GREATEST_SCALE:
            scale *= 10
        while scale <= 2 * slack:
            scale *= 10
        return scale, slack

    def run(self) -> Grounded:
        self._precedence()
        self._lags()
        self._envelopes()
        self._windows()
        counters = self._resources()
        for i in self.order:
            self._activity(i, counters)
        return self.out

    def _fact(self, name: str, *, initially: bool = False) -> str:
        self.encoding.facts.append(name)
        if initially:
            self.encoding.initial.append(name)
        return name

    def _require(self, point: Point, fact: str) -> None:
        """Makes a fact a condition of the happening at a point."""
        self.conditions[point].append(fact)

    def _reached(self, point: Point) -> str:
        """The fact that says a point has passed."""
        i, is_end = divmod(point, 2)
        if is_end:
            return f"done_{self.base[i]}"
        self.begun.add(i)
        return f"begun_{self.base[i]}"

    def _label(self, point: Point) -> str:
        return self.base[point // 2] + ("" if point % 2 else "_start")

    def _describe(self, point: Point) -> str:
        end = "end" if point % 2 else "start"
        return f"the {end} of {self.problem.activities[point // 2].id!r}"

    def _precedence(self) -> None:
        for arc in self.fact_arcs:
            self._require(arc.to, self._reached(arc.frm))

    def _lags(self) -> None:
        for (frm, lag), followers in self.waits.items():
            name = self.names.new(f"wait_{lag}_after_{self._label(frm)}")
            todo = self._fact(f"todo_{name}", initially=True)
            over = self._fact(f"lag_{name}")
            duration = lag * self.scale
            self.encoding.operators.append(
                Operator(
                    name,
                    (duration, duration),
                    at_start=[todo, self._reached(frm)],
                    start_deletes=[todo],
                    end_adds=[over],
                )
            )
            self.out.waits[name] = f"{lag} ticks after {self._describe(frm)}"
            for point in followers:
                self._require(point, over)

    def _envelopes(self) -> None:
        """`time(frm) <= time(to) - lag` with lag <= 0, as an envelope around both points."""
        for frm, to, lag in self.envelopes:
            name = self.names.new(f"keep_{self._label(frm)}_by_{self._label(to)}")
            todo = self._fact(f"todo_{name}", initially=True)
            begun, running = self._fact(f"after_{name}"), self._fact(f"during_{name}")
            self.encoding.operators.append(
                Operator(
                    name,
                    (0, -lag * self.scale + self.slack),
                    at_start=[todo],
                    start_deletes=[todo],
                    start_adds=[begun, running],
                    end_deletes=[running],
                )
            )
            self.out.waits[name] = (
                f"{self._describe(frm)} is at most {-lag} ticks after {self._describe(to)}"
            )
            self._require(to, begun)
            self._require(frm, running)

    def _windows(self) -> None:
        self.over_all: dict[int, str] = {}
        opened: dict[int, str] = {}
        closed: dict[int, str] = {}
        for i, activity in enumerate(self.problem.activities):
            release = max(activity.release, activity.start or 0)
            if release:
                self._require(2 * i, self._released(release, opened))
            if activity.start is not None:
                self._require(2 * i, self._open_until(activity.start, closed))
            deadline = self.problem.effective_deadline(i)
            if deadline is not None:
                self.over_all[i] = self._open_until(deadline, closed)

    def _released(self, release: int, opened: dict[int, str]) -> str:
        if release not in opened:
            opened[release] = self._fact(f"released_{release}")
            literal = TimedLiteral(release * self.scale, opened[release], True)
            self.encoding.timed.append(literal)
        return opened[release]

    def _open_until(self, time: int, closed: dict[int, str]) -> str:
        if time not in closed:
            closed[time] = self._fact(f"open_{time}", initially=True)
            literal = TimedLiteral(time * self.scale + self.slack, closed[time], False)
            self.encoding.timed.append(literal)
        return closed[time]

    def _resources(self) -> dict[int, str]:
        """Token facts for each contended resource; counters (returned) where tokens multiply."""
        self.tokens: dict[int, list[str]] = {}
        counters: dict[int, str] = {}
        for r in self._by_counter():
            name = self.names.new(f"left_of_{self.problem.shared[r].id}")
            counters[r] = name
            self.encoding.counters[name] = self.problem.shared[r].capacity
            self.out.tokens[name] = f"units of {self.problem.shared[r].id!r} left"
        for r in sorted(
            {r for a in self.problem.activities for c in a.claims for r in c.alternatives}
        ):
            if r in counters:
                continue
            shared = self.problem.shared[r]
            self.tokens[r] = [
                self._fact(self.names.new(f"free_{shared.id}_{k + 1}"), initially=True)
                for k in range(shared.capacity)
            ]
            for token in self.tokens[r]:
                self.out.tokens[token] = f"a unit of {shared.id!r}"
        return counters

    def _by_counter(self) -> list[int]:
        """The resources whose tokens would multiply beyond the budget."""
        by_counter: set[int] = set()
        for activity in self.problem.activities:
            while _variant_count(self.problem, activity, by_counter) > MAX_VARIANTS:
                candidates = {
                    r
                    for claim in activity.claims
                    for r in claim.alternatives
                    if r not in by_counter and self.problem.shared[r].capacity > 1
                }
                if not candidates:
                    raise Refusal(
                        f"action {activity.id!r} has more than {MAX_VARIANTS} ways to choose its "
                        "resources, more than target 'pddl21' writes out",
                        (*activity.origin, "uses"),
                        "use fewer alternatives, or target 'cpsat'",
                    )
                by_counter.add(max(candidates, key=lambda r: (self.problem.shared[r].capacity, r)))
        return sorted(by_counter)

    def _activity(self, i: int, counters: dict[int, str]) -> None:
        activity, base = self.problem.activities[i], self.base[i]
        todo = self._fact(f"todo_{base}", initially=True)
        done = self._fact(f"done_{base}")
        self.encoding.goal.append(done)
        begun = [self._fact(f"begun_{base}")] if i in self.begun else []
        variants = list(self._variants(activity, counters))
        for variant in variants:
            name = base
            if len(variants) > 1:
                name = self.names.new(f"{base}__{'__'.join(t[5:] for t in variant.tokens)}")
            self.encoding.operators.append(
                Operator(
                    name,
                    self._duration(activity),
                    at_start=[todo, *self.conditions[2 * i], *variant.tokens],
                    over_all=self._holding(i),
                    at_end=self.conditions[2 * i + 1],
                    start_deletes=[todo, *variant.tokens],
                    start_adds=begun,
                    end_adds=[done, *variant.tokens],
                    takes=dict(variant.takes),
                )
            )
            if activity.duration_max == 0 and i in self.over_all:
                self.encoding.operators[-1].at_end = [
                    *self.conditions[2 * i + 1],
                    self.over_all[i],
                ]
            self.out.actions[name] = (i, variant.resources)

    def _holding(self, i: int) -> list[str]:
        return [self.over_all[i]] if i in self.over_all else []

    def _duration(self, activity: Activity) -> tuple[int, int] | None:
        if activity.duration_max == 0:
            return None
        return activity.duration_min * self.scale, activity.duration_max * self.scale

    def _variants(self, activity: Activity, counters: dict[int, str]) -> Iterator[Variant]:
        """Every choice of resources, and of each the tokens; claims on one resource add up."""
        claims = activity.claims
        if not claims:
            yield _ONLY_ONE
            return
        for resources in product(*(claim.alternatives for claim in claims)):
            amounts: dict[int, int] = {}
            for claim, r in zip(claims, resources, strict=True):
                amounts[r] = amounts.get(r, 0) + claim.amount
            if any(amount > self.problem.shared[r].capacity for r, amount in amounts.items()):
                continue
            takes = tuple((counters[r], n) for r, n in amounts.items() if r in counters)
            token_sets = (
                combinations(self.tokens[r], n) for r, n in amounts.items() if r not in counters
            )
            for chosen in product(*token_sets):
                yield Variant(resources, tuple(t for tokens in chosen for t in tokens), takes)


def _variant_count(problem: Problem, activity: Activity, by_counter: set[int]) -> int:
    """An upper bound on the ground variants of an activity."""
    count = 1
    for claim in activity.claims:
        count *= sum(
            1 if r in by_counter else _token_sets(problem.shared[r].capacity, claim.amount)
            for r in claim.alternatives
        )
    return count


def _token_sets(capacity: int, amount: int) -> int:
    """How many sets of `amount` tokens there are; just "too many" where that would be huge."""
    if amount >= capacity:
        return 1
    return MAX_VARIANTS + 1 if capacity > MAX_VARIANTS else comb(capacity, amount)


def _sort_constraints(
    problem: Problem,
) -> tuple[list[AtLeast], list[AtLeast], list[AtLeast]]:
    """All arcs as facts (lag 0), waits (lag > 0) and envelopes (lag < 0).

    Points that must coincide (a cycle of length 0) cannot wait for each other in PDDL, whose
    happenings are separated; arcs inside such a cycle become envelopes.
    """
    facts, waits, envelopes = [], [], []
    for arc in problem.arcs:
        frm, to = 2 * arc.before + arc.from_end, 2 * arc.after + arc.to_end
        directions = [AtLeast(frm, to, arc.min_lag)]
        if arc.max_lag is not None:
            directions.append(AtLeast(to, frm, -arc.max_lag))
        for constraint in directions:
            if constraint.lag > 0:
                waits.append(constraint)
            elif constraint.lag == 0:
                facts.append(constraint)
            else:
                envelopes.append(constraint)
    together = _coinciding(problem, facts, waits)
    if together:
        envelopes += [c for c in facts if together.get(c.frm) == together.get(c.to) is not None]
        facts = [c for c in facts if not together.get(c.frm) == together.get(c.to) is not None]
    return facts, waits, envelopes


def _coinciding(problem: Problem, facts: list[AtLeast], waits: list[AtLeast]) -> dict[Point, int]:
    """Which points lie on a common cycle of constraints that need facts, by component."""
    count = len(problem.activities)
    plain = all(a.from_end and not a.to_end and a.max_lag is None for a in problem.arcs)
    if plain and is_acyclic(count, problem.arcs):
        return {}
    network = Network(2 * count)
    leaving: list[list[int]] = [[] for _ in range(2 * count)]

    def add(frm: Point, to: Point) -> None:
        leaving[frm].append(network.add(frm, to, 0))

    for i in range(count):
        add(2 * i, 2 * i + 1)
    for i, activity in enumerate(problem.activities):
        if activity.duration_max == 0:
            add(2 * i + 1, 2 * i)
    for c in (*facts, *waits):
        add(c.frm, c.to)
    found: dict[Point, int] = {}
    for k, component in enumerate(components(network, leaving, range(2 * count))):
        if len({p // 2 for p in component}) > 1:
            found.update(dict.fromkeys(component, k))
    return found
