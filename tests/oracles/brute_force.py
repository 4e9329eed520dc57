"""Exact optima of small tasks, from the meaning of a valid schedule (docs/semantics.md) alone.

Known here: actions that occur once, durations fixed or in a range, the four precedence types with
both lags, releases, deadlines, fixed and latest starts, renewable resources, `one_of`. Whatever
else a task says is refused with `ValueError`, never ignored, except due dates, rewards, costs and
the objective: they do not bear on the least makespan.

**Method.** Each `one_of` is decided first, in every way. Then a task is a system of lower bounds
on the differences of time points: t = 0, each start, each end, and the makespan. Its transitive
closure (longest paths, Floyd–Warshall) either has a positive cycle, and nothing satisfies it, or
yields the earliest value of every point, and these values satisfy it. Where that earliest schedule
asks a resource for too much, a set of actions is too large to hold it together. Intervals that
overlap in pairs have a common instant; so in each valid schedule one of the set ends before
another starts, or one of them has length 0. Each of these is one more lower bound, a branch
(forbidden sets: Bartusch, Möhring, Radermacher 1988). A branch is left when its bound reaches the
best makespan found so far.

The earliest schedule violates each bound that is added, so the search ends; and it needs no
horizon, because a positive cycle speaks for all schedules, however late.

**Whole numbers suffice.** Rounding all points of a valid schedule down keeps every bound that is a
whole number, and gives no common instant to intervals that had none. So the optimum over integers
is the optimum over all times.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise, product
from typing import TypeVar

import networkx as nx

from irc.model import Action, DurationRange, Precedence, Resource, Task
from irc.model.base import Node
from irc.model.quantities import Number, exact
from irc.model.times import Instant

Bounds = list[list[float]]
"""`bounds[u][v]`: what point v is at least behind point u; -inf where nothing is known."""

Held = dict[str, dict[int, int]]
"""For each resource, the amount that each action (by index) holds of it."""

_Part = TypeVar("_Part", Action, Resource)

_TASK_FIELDS = frozenset(
    [
        *("irc", "name", "description", "time_unit", "days_per_month", "deadline", "origin"),
        "resolution",
        "lapsed",
        *("metadata", "resources", "actions", "precedence", "objective"),
    ]
)
_ACTION_FIELDS = frozenset(
    [
        *("id", "label", "description", "duration", "uses", "release", "deadline", "start"),
        *("latest_start", "earliest_end", "due", "weight", "reward", "cost", "on_failure"),
    ]
)
_RESOURCE_FIELDS = frozenset(["id", "label", "description", "capacity"])


@dataclass(frozen=True)
class Optimum:
    """A schedule with the least makespan; times in the task's unit, resources with amounts."""

    makespan: int
    starts: dict[str, int]
    ends: dict[str, int]
    resources: dict[str, dict[str, int]]


@dataclass(frozen=True)
class _Point:
    """Indices of the time points of a task with `size` actions."""

    size: int
    origin: int = 0

    def start(self, action: int) -> int:
        return 1 + 2 * action

    def end(self, action: int) -> int:
        return 2 + 2 * action

    @property
    def makespan(self) -> int:
        return 1 + 2 * self.size


@dataclass(frozen=True)
class _Choice:
    """One `uses` of one action."""

    action: int
    alternatives: tuple[str, ...]
    amount: int


@dataclass(frozen=True)
class _Facts:
    """A task as indices and integers. `edges`: (u, v, w) means that v is at least w behind u."""

    names: tuple[str, ...]
    durations: tuple[tuple[int, int], ...]
    edges: tuple[tuple[int, int, int], ...]
    choices: tuple[_Choice, ...]
    capacities: dict[str, int]
    point: _Point


def optimal_makespan(task: Task, horizon: int | None = None) -> int | None:
    """The least makespan over all valid schedules of `task`; None if there is none.

    With a `horizon`, only schedules that end by then are considered. Raises `ValueError` for
    features outside the module's subset and for times that are not whole in the task's unit.
    """
    best = optimal_schedule(task, horizon)
    return None if best is None else best.makespan


def optimal_schedule(task: Task, horizon: int | None = None) -> Optimum | None:
    """A schedule that `optimal_makespan` stands for; the same one on every call."""
    facts = _facts(task)
    edges = [*facts.edges, *_twin_edges(task, facts.point)]
    if horizon is not None:
        edges.append((facts.point.makespan, facts.point.origin, -horizon))
    bounds = _closure(2 * facts.point.size + 2, edges)
    if bounds is None:
        return None
    search = _Search(facts)
    head = bounds[facts.point.origin]
    choices = sorted(
        facts.choices, key=lambda c: (len(c.alternatives) > 1, head[facts.point.start(c.action)])
    )
    search.visit(bounds, {r: {} for r in facts.capacities}, tuple(choices))
    return search.best


@dataclass
class _Search:
    facts: _Facts
    best: Optimum | None = field(default=None, init=False)

    def visit(self, bounds: Bounds, held: Held, open_choices: tuple[_Choice, ...]) -> None:
        """Sets `best` to the optimum under `bounds`, where that is better."""
        if self.best is not None and self._lower_bound(bounds, held) >= self.best.makespan:
            return
        if open_choices:
            for more in self._chosen(open_choices[0], held):
                self.visit(bounds, more, open_choices[1:])
            return
        too_many = self._overload(bounds, held)
        if too_many is None:
            self.best = self._optimum(bounds, held)
            return
        for branch in self._resolutions(bounds, too_many):
            self.visit(branch, held, ())

    def _chosen(self, choice: _Choice, held: Held) -> list[Held]:
        """One for each resource that `choice` may hold, but one only for resources alike."""
        alternatives = {
            self._twin_key(resource, held): resource for resource in choice.alternatives
        }
        return [
            {**held, resource: _held_more(held[resource], choice)}
            for resource in alternatives.values()
        ]

    def _twin_key(self, resource: str, held: Held) -> object:
        """Equal for two resources that nothing told apart yet."""
        if held[resource]:
            return resource
        named = tuple(resource in choice.alternatives for choice in self.facts.choices)
        return self.facts.capacities[resource], named

    def _earliest(self, bounds: Bounds, action: int) -> tuple[float, float]:
        first, point = bounds[self.facts.point.origin], self.facts.point
        return first[point.start(action)], first[point.end(action)]

    def _overload(self, bounds: Bounds, held: Held) -> tuple[int, ...] | None:
        """A smallest set of actions that the earliest schedule lets hold too much at once."""
        found = set()
        for resource, amounts in held.items():
            capacity = self.facts.capacities[resource]
            spans = {i: self._earliest(bounds, i) for i in amounts}
            for instant in {start for start, end in spans.values() if start < end}:
                running = [i for i, (start, end) in spans.items() if start <= instant < end]
                if sum(amounts[i] for i in running) > capacity:
                    found.add(_minimal(running, amounts, capacity))
        return min(found, key=lambda actions: (len(actions), actions), default=None)

    def _resolutions(self, bounds: Bounds, too_many: tuple[int, ...]) -> list[Bounds]:
        """One of `too_many` ends before another starts (before itself: it has length 0).

        Each branch also denies what the branches before it say, so that they share no schedule.
        """
        point = self.facts.point
        branches: list[Bounds] = []
        rest: Bounds | None = bounds
        for i, j in product(too_many, repeat=2):
            if rest is None:
                break
            branch = _with_edge(rest, point.end(i), point.start(j), 0)
            if branch is not None:
                branches.append(branch)
            rest = _with_edge(rest, point.start(j), point.end(i), 1)
        return sorted(branches, key=lambda branch: branch[point.origin][point.makespan])

    def _lower_bound(self, bounds: Bounds, held: Held) -> float:
        """Critical path, and for each resource: earliest head + work / capacity + least tail."""
        point = self.facts.point
        bound = bounds[point.origin][point.makespan]
        for resource, amounts in held.items():
            work = {i: bounds[point.start(i)][point.end(i)] for i in amounts}
            users = [i for i in amounts if work[i] > 0]
            if not users:
                continue
            needed = sum(amounts[i] * work[i] for i in users)
            head = min(bounds[point.origin][point.start(i)] for i in users)
            tail = min(bounds[point.end(i)][point.makespan] for i in users)
            capacity = self.facts.capacities[resource]
            if not capacity:
                return math.inf
            bound = max(bound, head + -(-needed // capacity) + tail)
        return bound

    def _optimum(self, bounds: Bounds, held: Held) -> Optimum:
        spans = [self._earliest(bounds, i) for i in range(self.facts.point.size)]
        names = self.facts.names
        return Optimum(
            int(bounds[self.facts.point.origin][self.facts.point.makespan]),
            {name: int(start) for name, (start, _) in zip(names, spans, strict=True)},
            {name: int(end) for name, (_, end) in zip(names, spans, strict=True)},
            {
                name: {r: amounts[i] for r, amounts in held.items() if i in amounts}
                for i, name in enumerate(names)
            },
        )


def _held_more(amounts: dict[int, int], choice: _Choice) -> dict[int, int]:
    return {**amounts, choice.action: amounts.get(choice.action, 0) + choice.amount}


def _minimal(running: list[int], amounts: dict[int, int], capacity: int) -> tuple[int, ...]:
    """`running` without those who are not needed to exceed `capacity`, small amounts first."""
    excess = sum(amounts[i] for i in running) - capacity
    kept = []
    for i in sorted(running, key=lambda i: (amounts[i], i)):
        if amounts[i] < excess:
            excess -= amounts[i]
        else:
            kept.append(i)
    return tuple(kept)


def _closure(size: int, edges: Iterable[tuple[int, int, int]]) -> Bounds | None:
    """All bounds that follow from `edges`; None where they contradict each other."""
    bounds = [[0 if u == v else -math.inf for v in range(size)] for u in range(size)]
    for u, v, weight in edges:
        bounds[u][v] = max(bounds[u][v], weight)
    for via, u, v in product(range(size), repeat=3):
        bounds[u][v] = max(bounds[u][v], bounds[u][via] + bounds[via][v])
    return None if any(bounds[u][u] > 0 for u in range(size)) else bounds


def _with_edge(bounds: Bounds, u: int, v: int, weight: int) -> Bounds | None:
    """The closure of `bounds` and one more edge; None where that contradicts them."""
    if bounds[v][u] + weight > 0:
        return None
    return [
        row
        if row[v] >= row[u] + weight
        else [max(old, row[u] + weight + on) for old, on in zip(row, bounds[v], strict=True)]
        for row in bounds
    ]


def _twin_edges(task: Task, point: _Point) -> list[tuple[int, int, int]]:
    """Puts actions that only their names tell apart in order of start: they could be exchanged."""
    bound = {name for arc in task.precedence for name in (arc.before, arc.after)}
    twins: dict[str, list[int]] = {}
    for i, action in enumerate(_by_id(task.actions, "action").values()):
        if action.id not in bound:
            rest = action.model_dump_json(exclude={"id", "label", "description"})
            twins.setdefault(rest, []).append(i)
    return [
        (point.start(i), point.start(j), 0) for alike in twins.values() for i, j in pairwise(alike)
    ]


def enough_time(task: Task) -> int:
    """A time by which some optimal schedule of `task` has ended, if there is a valid one.

    Take a valid schedule; keep its choices, its lengths 0, and for every two occurrences that
    share a resource without overlapping their order. That adds edges of weight 0 only, and the
    earliest schedule under all edges is valid and nowhere later. Each of its times is the length
    of a simple path from t = 0, so at most the sum of the positive weights: the least durations,
    the positive minimum lags, the negated negative maximum lags; and of the edges that leave
    t = 0 (releases, fixed starts) a simple path has only one.
    """
    facts = _facts(task)
    leaving = [w for u, _, w in facts.edges if u == facts.point.origin]
    return max([0, *leaving]) + sum(max(0, w) for u, _, w in facts.edges if u != facts.point.origin)


def longest_path(task: Task) -> Number:
    """The makespan of a task of fixed durations, releases and finish-start minimum lags only.

    By networkx's longest path through the graph of actions; exact for fractions too. Raises
    `ValueError` for any other feature, or for a cycle.
    """
    _refuse(task, _TASK_FIELDS - {"deadline", "resources"}, "the task")
    graph = nx.DiGraph()
    for action in _by_id(task.actions, "action").values():
        unknown_here = {"uses", "deadline", "start", "latest_start", "earliest_end"}
        _refuse(action, _ACTION_FIELDS - unknown_here, f"action {action.id!r}")
        if action.duration is None or isinstance(action.duration, DurationRange):
            raise ValueError(f"action {action.id!r} has no fixed duration")
        duration = task.number(action.duration)
        if duration < 0:
            raise ValueError(f"action {action.id!r} has a negative duration")
        graph.add_edge(("t = 0",), (action.id, "start"), weight=task.number(action.release))
        graph.add_edge((action.id, "start"), (action.id, "end"), weight=duration)
    for arc in task.precedence:
        _refuse(arc, frozenset(["before", "after", "min_lag"]), "a precedence")
        _widen(graph, (arc.before, "end"), (arc.after, "start"), task.number(arc.min_lag))
    if not nx.is_directed_acyclic_graph(graph):
        raise ValueError("the precedences have a cycle")
    # A path may begin anywhere at length 0, which is to say that no action starts before t = 0.
    return exact(Fraction(nx.dag_longest_path_length(graph)))


def _widen(graph: nx.DiGraph, u: object, v: object, weight: Number) -> None:
    if u not in graph or v not in graph:
        raise ValueError("a precedence names an unknown action")
    if not graph.has_edge(u, v) or graph.edges[u, v]["weight"] < weight:
        graph.add_edge(u, v, weight=weight)


def _facts(task: Task) -> _Facts:
    _refuse(task, _TASK_FIELDS, "the task")
    actions = _by_id(task.actions, "action")
    resources = _by_id(task.resources, "resource")
    for resource in resources.values():
        _refuse(resource, _RESOURCE_FIELDS, f"resource {resource.id!r}")
    for action in actions.values():
        _refuse(action, _ACTION_FIELDS, f"action {action.id!r}")
    point = _Point(len(actions))
    durations = tuple(_duration(task, action) for action in actions.values())
    edges = [(point.origin, point.makespan, 0), *_deadline(task, point.makespan, task.deadline)]
    for i, action in enumerate(actions.values()):
        edges += _action_edges(task, action, durations[i], point.start(i), point.end(i))
        edges.append((point.end(i), point.makespan, 0))
    index = {name: i for i, name in enumerate(actions)}
    for arc in task.precedence:
        edges += _precedence_edges(task, arc, index, point)
    choices = tuple(
        _Choice(i, use.alternatives, use.amount)
        for i, action in enumerate(actions.values())
        for use in action.uses
    )
    for choice in choices:
        if not choice.alternatives or not resources.keys() >= set(choice.alternatives):
            raise ValueError(f"no such resource among {choice.alternatives!r}")
    capacities = {name: resource.capacity for name, resource in resources.items()}
    return _Facts(tuple(actions), durations, tuple(edges), choices, capacities, point)


def _action_edges(
    task: Task, action: Action, duration: tuple[int, int], start: int, end: int
) -> list[tuple[int, int, int]]:
    least, most = duration
    edges = [(start, end, least), (end, start, -most)]
    edges.append((_Point.origin, start, max(0, _whole(task, action.release))))
    if action.start is not None:
        fixed = _whole(task, action.start)
        edges += [(_Point.origin, start, fixed), (start, _Point.origin, -fixed)]
    edges += _deadline(task, start, action.latest_start)
    if action.earliest_end is not None:
        edges.append((_Point.origin, end, _whole(task, action.earliest_end)))
    return edges + _deadline(task, end, action.deadline)


def _deadline(task: Task, point: int, deadline: Instant | None) -> list[tuple[int, int, int]]:
    return [] if deadline is None else [(point, _Point.origin, -_whole(task, deadline))]


def _precedence_edges(
    task: Task, arc: Precedence, index: dict[str, int], point: _Point
) -> list[tuple[int, int, int]]:
    if arc.before not in index or arc.after not in index:
        raise ValueError(f"a precedence names an unknown action: {arc.before!r}, {arc.after!r}")
    of_before, of_after = arc.type.split("-")
    u = (point.start if of_before == "start" else point.end)(index[arc.before])
    v = (point.start if of_after == "start" else point.end)(index[arc.after])
    edges = [(u, v, _whole(task, arc.min_lag))]
    if arc.max_lag is not None:
        edges.append((v, u, -_whole(task, arc.max_lag)))
    return edges


def _duration(task: Task, action: Action) -> tuple[int, int]:
    if action.duration is None:
        raise ValueError(f"action {action.id!r} has no duration")
    if isinstance(action.duration, DurationRange):
        least, most = _whole(task, action.duration.min), _whole(task, action.duration.max)
    else:
        least = most = _whole(task, action.duration)
    if least < 0:
        raise ValueError(f"action {action.id!r} has a negative duration")
    return least, most


def _whole(task: Task, value: Instant) -> int:
    number = task.number(value)
    if not isinstance(number, int):
        raise ValueError(f"{number} is not a whole number of the task's time unit")
    return number


def _by_id(parts: Sequence[_Part], kind: str) -> dict[str, _Part]:
    """Parts by id; an exact repetition counts once (docs/ir.md, "Names")."""
    known: dict[str, _Part] = {}
    for part in parts:
        if known.setdefault(part.id, part) != part:
            raise ValueError(f"{kind} {part.id!r} is given twice with different contents")
    return known


def _refuse(node: Node, known: frozenset[str], what: str) -> None:
    """Raises `ValueError` where a field outside `known` says anything but its default."""
    for name, info in type(node).model_fields.items():
        if name not in known and getattr(node, name) != info.get_default():
            raise ValueError(f"{what}: this oracle does not know {name!r}")
