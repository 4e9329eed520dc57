"""Selections of optional items: their value, and upper bounds on it.

An item is an optional group, or an optional activity with a reward or cost of its own. The value of
a selection is the sum of its items' values. The stock that it needs, and the time of resources
until the deadline, bound that sum: each such limit is a knapsack, and the fractional knapsack
(Dantzig, "Discrete-variable extremum problems", 1957) an upper bound.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from irc.passes import resource_bounds
from irc.passes.contention import drop_uncontended
from irc.passes.critical_path import bounded_mandatory_part, heads_and_tails
from irc.passes.energy import energy_bound, loads
from irc.passes.mandatory import mandatory_part
from irc.passes.restrict import drop_ample_stock, restrict
from irc.problem import Problem
from irc_pddl21.search.reachability import is_out_of_reach

THRESHOLDS = 4
"""The number of heads, and of tails, of a resource's users that delimit the intervals."""

SELECTIVE = frozenset(["reward", "cost"])
"""Objectives that only depend on which activities are present."""

Selection = frozenset[int]
"""The items (by index) that are present."""


class Item(NamedTuple):
    """Activities (by index) that are present together or not at all, and their value."""

    members: tuple[int, ...]
    value: int


class Limit(NamedTuple):
    """The items take at most `room` together; item k takes `weights[k]`, at least 0."""

    room: int
    weights: tuple[int, ...]


@dataclass(frozen=True)
class ObjectiveWeights:
    """The values of items in the objectives of a level, in order, as one number.

    An objective counts `scale` times the one behind it, which is more than that can vary.
    """

    names: tuple[str, ...]
    scales: tuple[int, ...]

    def first_bound(self, value: int) -> int:
        """The greatest value of the first objective that a sum of at most `value` can have."""
        spread = sum(self.scales[1:]) and self.scales[0] - 1
        return (value + spread) // self.scales[0]


def optional_items(
    problem: Problem, names: tuple[str, ...]
) -> tuple[list[Item], ObjectiveWeights] | None:
    """The items with a value in these objectives.

    None where an activity with a value may happen several times: it is not an item.
    """
    groups = [g for g in problem.groups if not g.required]
    grouped = {i for g in groups for i in g.members}
    sets = [(g.members, g.reward) for g in groups]
    sets += [
        ((i,), 0)
        for i, a in enumerate(problem.activities)
        if a.details.optional and i not in grouped
    ]
    for activity in problem.activities:
        details = activity.details
        repeated = details.repeats is not None and details.repeats[0] != details.repeats[1]
        if repeated and any(getattr(details, name) for name in names):
            return None
    totals = {
        name: [_value(problem, members, reward, name) for members, reward in sets] for name in names
    }
    scales: list[int] = []
    scale = 1
    for name in reversed(names):
        scales.insert(0, scale)
        scale *= 1 + sum(abs(value) for value in totals[name])
    weights = ObjectiveWeights(names, tuple(scales))
    items = [
        Item(members, sum(s * totals[n][k] for n, s in zip(names, weights.scales, strict=True)))
        for k, (members, _) in enumerate(sets)
    ]
    return [item for item in items if item.value], weights


def _value(problem: Problem, members: Iterable[int], reward: int, name: str) -> int:
    details = [problem.activities[i].details for i in members]
    if name == "reward":
        return reward + sum(d.reward for d in details)
    return -sum(d.cost for d in details)


class SelectionSpace:
    """The selections among some items of a problem, with their values and bounds."""

    def __init__(
        self, problem: Problem, items: list[Item], is_over: Callable[[], bool] = lambda: False
    ) -> None:
        """Prepares the bounds; with no time left without those by the work of resources."""
        self.problem = problem
        self.items = sorted(items, key=lambda item: (-item.value, item.members))
        self.limits = [*_stock_limits(problem, self.items), *_energy_limits(self, is_over)]
        count = len(self.items)
        self._orders = [
            sorted(range(count), key=lambda k: _density(self.items[k].value, limit.weights[k]))
            for limit in self.limits
        ]

    def value(self, chosen: Iterable[int]) -> int:
        """The value of a selection."""
        return sum(self.items[k].value for k in chosen)

    def restricted(self, chosen: Selection) -> Problem:
        """The problem of a selection, with heads, tails and a quick bound."""
        present = {i for k in chosen for i in self.items[k].members}
        absent = {i for k, item in enumerate(self.items) if k not in chosen for i in item.members}
        problem = drop_ample_stock(restrict(self.problem, present, absent))
        open_groups = tuple(group for group in problem.groups if not group.required)
        problem = replace(problem, objectives=("makespan",), groups=open_groups)
        problem = heads_and_tails(drop_uncontended(problem))
        core = bounded_mandatory_part(problem)  # Only mandatory activities take time for certain.
        bound = energy_bound(core).bounds.makespan
        return problem.with_bound(bound.value, bound.reason)

    def upper_bound(self, chosen: Selection, undecided: Selection) -> int | None:
        """The greatest value with these items and some undecided ones; None if there is none."""
        base = self.value(chosen)
        gain = sum(max(0, self.items[k].value) for k in undecided)
        for limit, order in zip(self.limits, self._orders, strict=True):
            room = limit.room - sum(limit.weights[k] for k in chosen)
            if room < 0:
                return None
            gain = min(gain, self._fill(limit, order, undecided, room))
        return base + gain

    def _fill(self, limit: Limit, order: list[int], undecided: Selection, room: int) -> int:
        """The fractional knapsack: the densest items first, the last one in part."""
        gain = 0
        for k in order:
            value, weight = self.items[k].value, limit.weights[k]
            if k not in undecided or value <= 0:
                continue
            if weight > room:
                return gain + value * room // weight
            gain += value
            room -= weight
        return gain


def _energy_limits(space: SelectionSpace, is_over: Callable[[], bool]) -> list[Limit]:
    """The limits on the work of a resource after some head and before some tail."""
    deadline, items = space.problem.deadline, space.items
    if deadline is None or not items:
        return []
    everything, _ = mandatory_part(space.restricted(frozenset(range(len(items)))))
    heads, tails = _ends(space.restricted(frozenset()))
    for k in range(len(items)):
        if is_over():
            return []
        alone = _ends(space.restricted(frozenset([k])))
        heads, tails = {**alone[0], **heads}, {**alone[1], **tails}
    owner = {
        space.problem.activities[i].id: k for k, item in enumerate(items) for i in item.members
    }
    limits: list[Limit] = []
    for load in loads(everything):
        users = [
            _ResourceUser(name, heads[name], tails[name], activity.duration_min * amount)
            for i, amount in zip(load.activities, load.amounts, strict=True)
            for activity in (everything.activities[i],)
            for name in (activity.id,)
        ]
        for head in _thinned({user.head for user in users}):
            for tail in _thinned({user.tail for user in users}):
                inside = [u for u in users if u.head >= head and u.tail >= tail]
                room = load.capacity * max(0, deadline - head - tail)
                limits.append(_limit(room, inside, owner, len(items)))
    return [limit for limit in limits if limit.room < sum(limit.weights)]


class _ResourceUser(NamedTuple):
    """An activity that needs a resource for `work` between its head and its tail."""

    name: str
    head: int
    tail: int
    work: int


def _limit(room: int, inside: list[_ResourceUser], owner: Mapping[str, int], count: int) -> Limit:
    """The limit on the items: users that belong to no item are present in any case."""
    weights = [0] * count
    for user in inside:
        if user.name in owner:
            weights[owner[user.name]] += user.work
        else:
            room -= user.work
    return Limit(max(0, room), tuple(weights))


def _ends(problem: Problem) -> tuple[dict[str, int], dict[str, int]]:
    """Heads and tails by name, the least of all occurrences."""
    core = bounded_mandatory_part(problem)
    heads: dict[str, int] = {}
    tails: dict[str, int] = {}
    for activity, head, tail in zip(
        core.activities, core.bounds.heads, core.bounds.tails, strict=True
    ):
        heads[activity.id] = min(head, heads.get(activity.id, head))
        tails[activity.id] = min(tail, tails.get(activity.id, tail))
    return heads, tails


def _thinned(times: set[int]) -> list[int]:
    ordered = sorted(times)
    step = max(1, len(ordered) // THRESHOLDS)
    return ordered[::step]


def _stock_limits(problem: Problem, items: list[Item]) -> list[Limit]:
    """The limits on the stock that items take, by all that could ever be in a reservoir."""
    limits: list[Limit] = []
    in_items = {i for item in items for i in item.members}
    for k, reservoir in enumerate(problem.reservoirs):
        if any(
            a.details.repeats is not None and any(c.reservoir == k for c in a.details.stock)
            for a in problem.activities
        ):
            continue
        room = reservoir.initial - reservoir.least
        for i, activity in enumerate(problem.activities):
            net = _net(problem, i, k)
            if net > 0 or (i not in in_items and not activity.details.optional):
                room += net
        weights = tuple(sum(max(0, -_net(problem, i, k)) for i in item.members) for item in items)
        if room < sum(weights):
            limits.append(Limit(room, weights))
    return limits


def _net(problem: Problem, i: int, reservoir: int) -> int:
    stock = problem.activities[i].details.stock
    return sum(change.amount for change in stock if change.reservoir == reservoir)


def _density(value: int, weight: int) -> float:
    """The sort key for falling value by weight."""
    return -value / weight if weight else float("-inf")


def is_refuted(problem: Problem, *, thoroughly: bool) -> bool:
    """Whether bounds, or reachable values of state, show that a problem has no schedule."""
    for i, activity in enumerate(problem.activities):
        head, latest = problem.bounds.heads[i], activity.latest_start
        deadline = problem.effective_deadline(i)
        too_late = (latest is not None and head > latest) or (
            deadline is not None and head + activity.duration_min > deadline
        )
        if too_late and not activity.details.optional and activity.details.repeats is None:
            return True
    if is_out_of_reach(problem):
        return True
    latest = problem.deadline
    if latest is None:
        return False
    if thoroughly and problem.bounds.makespan.value <= latest:
        problem = resource_bounds(problem)
    return problem.bounds.makespan.value > latest
