"""Selections of optional items: their value, and upper bounds on it.

An item is an optional group, an optional activity with a reward or cost of its own, or one more
occurrence of a repeated activity that has some. The value of
a selection is the sum of its items' values. The stock that it needs, and the time of resources
until the deadline, bound that sum: each such limit is a knapsack, and the fractional knapsack
(Dantzig, "Discrete-variable extremum problems", 1957) an upper bound.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from irc.passes import resource_bounds
from irc.passes.contention import drop_uncontended
from irc.passes.critical_path import (
    TimesContradictError,
    bounded_mandatory_part,
    heads_and_tails,
)
from irc.passes.energy import energy_bound, loads
from irc.passes.mandatory import mandatory_part
from irc.passes.restrict import drop_ample_stock, restrict
from irc.problem import Activity, Problem
from irc.problem import Selection as TaskSelection
from irc_pddl21.encoding.selections import is_certain
from irc_pddl21.search.reachability import is_out_of_reach

THRESHOLDS = 4
"""The number of heads, and of tails, of a resource's users that delimit the intervals."""

SELECTIVE = frozenset(["reward", "cost"])
"""Objectives that only depend on which activities are present."""

Selection = frozenset[int]
"""The items (by index) that are present."""


LIMITED_ITEMS = 400
"""With more items the limits of resources are left out, since each asks for a look at all."""

MOST_ITEMS = 2_000
"""At most this many items are further occurrences."""

MOST_FURTHER = 32
"""At most this many further occurrences of one action are items of their own."""


class Item(NamedTuple):
    """Activities (by index) that are present together or not at all, and their value.

    `further`: the item is one more occurrence of its single member.
    """

    members: tuple[int, ...]
    value: int
    further: bool = False


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


class OptionalItems(NamedTuple):
    """The items with a value, and the objectives that they add to.

    `all_there`: no schedule has more occurrences of an action than there are items for.
    """

    items: list[Item]
    weights: ObjectiveWeights
    all_there: bool


def optional_items(problem: Problem, names: tuple[str, ...]) -> OptionalItems:
    """The items with a value in these objectives."""
    groups = [g for g in problem.groups if not g.required]
    grouped = {i for g in groups for i in g.members}
    sets = [Item(g.members, g.reward) for g in groups]
    all_there = True
    for i, activity in enumerate(problem.activities):
        if activity.details.optional and i not in grouped:
            sets.append(Item((i,), 0))
        elif activity.details.repeats is not None and _has_value(activity, names):
            most = _most_further(problem, i)
            all_there = all_there and most is not None and most <= MOST_FURTHER
            count = MOST_FURTHER if most is None else min(most, MOST_FURTHER)
            all_there = all_there and len(sets) + count <= MOST_ITEMS
            count = max(0, min(count, MOST_ITEMS - len(sets)))
            sets += [Item((i,), 0, further=True)] * count
    totals = {
        name: [_value(problem, item.members, item.value, name) for item in sets] for name in names
    }
    scales: list[int] = []
    scale = 1
    for name in reversed(names):
        scales.insert(0, scale)
        scale *= 1 + sum(abs(value) for value in totals[name])
    weights = ObjectiveWeights(names, tuple(scales))
    items = [
        item._replace(
            value=sum(s * totals[n][k] for n, s in zip(names, weights.scales, strict=True))
        )
        for k, item in enumerate(sets)
    ]
    return OptionalItems([item for item in items if item.value], weights, all_there)


def _has_value(activity: Activity, names: tuple[str, ...]) -> bool:
    return any(getattr(activity.details, name) for name in names)


def _most_further(problem: Problem, i: int) -> int | None:
    """The greatest number of occurrences beyond the least; None where nothing is known to limit it.

    Occurrences do not overlap, so that as many fit as their shortest duration allows.
    """
    activity = problem.activities[i]
    least, greatest = activity.details.repeats or (0, 1)
    limits = [] if greatest is None else [greatest]
    deadline, latest = problem.effective_deadline(i), activity.latest_start
    duration = activity.duration_min
    if duration > 0 and deadline is not None:
        limits.append((deadline - activity.release) // duration)
    if duration > 0 and latest is not None:
        limits.append(1 + (latest - activity.release) // duration)
    return max(0, min(limits) - least) if limits else None


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

    def canonical(self, chosen: Selection) -> Selection:
        """The selection of the same occurrences in which the first items of each action are."""
        further = {k for k in chosen if self.items[k].further}
        if not further:
            return chosen
        counts = Counter(self.items[k].members for k in further)
        kept = set(chosen - further)
        for k, item in enumerate(self.items):
            if item.further and counts[item.members]:
                counts[item.members] -= 1
                kept.add(k)
        return frozenset(kept)

    def value(self, chosen: Iterable[int]) -> int:
        """The value of a selection."""
        return sum(self.items[k].value for k in chosen)

    def restricted(self, chosen: Selection, undecided: Selection = frozenset()) -> Problem | None:
        """The problem of a selection, with heads, tails and a quick bound.

        Items that are `undecided` may be present. None where the times of its activities contradict
        each other.
        """
        try:
            problem = heads_and_tails(self.projected(chosen, undecided))
        except TimesContradictError:
            return None
        core = bounded_mandatory_part(problem)  # Only mandatory activities take time for certain.
        bound = energy_bound(core).bounds.makespan
        return problem.with_bound(bound.value, bound.reason)

    def projected(self, chosen: Selection, undecided: Selection = frozenset()) -> Problem:
        """The problem of a selection, without heads and tails."""
        present: set[int] = set()
        absent: set[int] = set()
        further: dict[int, tuple[int, int]] = {}
        for k, item in enumerate(self.items):
            there, may_be = k in chosen, k in chosen or k in undecided
            if item.further:
                least, most = further.get(item.members[0], (0, 0))
                further[item.members[0]] = least + there, most + may_be
            elif there:
                present |= set(item.members)
            elif not may_be:
                absent |= set(item.members)
        problem, never = _with_occurrences(self.problem, further)
        problem = drop_ample_stock(restrict(problem, present, absent | never))
        open_groups = tuple(group for group in problem.groups if not group.required)
        problem = replace(problem, objectives=("makespan",), groups=open_groups)
        return drop_uncontended(problem)

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


def _with_occurrences(
    problem: Problem, further: Mapping[int, tuple[int, int]]
) -> tuple[Problem, set[int]]:
    """The problem with these numbers of occurrences beyond the least, and the activities without.

    The numbers are the least and the greatest one.
    """
    never: set[int] = set()
    activities = list(problem.activities)
    for i, (more, most) in further.items():
        details = activities[i].details
        base = (details.repeats or (0, 1))[0]
        least, greatest = base + more, base + most
        if not greatest:
            never.add(i)
        repeats = (least, greatest) if greatest > 1 else None
        details = replace(details, repeats=repeats, optional=repeats is None and not least)
        activities[i] = replace(activities[i], details=details)
    return replace(problem, activities=tuple(activities)), never


def _energy_limits(space: SelectionSpace, is_over: Callable[[], bool]) -> list[Limit]:
    """The limits on the work of a resource after some head and before some tail."""
    deadline, items = space.problem.deadline, space.items
    if deadline is None or not items or len(items) > LIMITED_ITEMS:
        return []
    everything, _ = mandatory_part(space.projected(frozenset(range(len(items)))))
    heads: dict[str, int] = {}
    tails: dict[str, int] = {}
    for chosen in (frozenset[int](), *(frozenset([k]) for k in range(len(items)))):
        if is_over():
            return []
        alone = space.restricted(chosen)
        if alone is not None:  # Otherwise its items have no time at all: they limit nothing.
            found = _ends(alone)
            heads, tails = {**found[0], **heads}, {**found[1], **tails}
    owners: dict[str, list[int]] = {}
    for k, item in enumerate(items):
        for i in item.members:
            owners.setdefault(space.problem.activities[i].id, []).append(k)
    limits: list[Limit] = []
    for load in loads(everything):
        users = [
            _ResourceUser(name, heads[name], tails[name], activity.duration_min * amount)
            for i, amount in zip(load.activities, load.amounts, strict=True)
            for activity in (everything.activities[i],)
            for name in (activity.id,)
            if name in heads
        ]
        for head in _thinned({user.head for user in users}):
            for tail in _thinned({user.tail for user in users}):
                inside = [u for u in users if u.head >= head and u.tail >= tail]
                room = load.capacity * max(0, deadline - head - tail)
                limits.append(_limit(room, inside, owners, len(items)))
    return [limit for limit in limits if limit.room < sum(limit.weights)]


class _ResourceUser(NamedTuple):
    """An activity that needs a resource for `work` between its head and its tail."""

    name: str
    head: int
    tail: int
    work: int


def _limit(
    room: int, inside: list[_ResourceUser], owners: Mapping[str, list[int]], count: int
) -> Limit:
    """The limit on the items: users that belong to no item are present in any case."""
    weights = [0] * count
    # Of a repeated action, those beyond the number of its items are present in any case.
    certain = Counter(user.name for user in inside)
    certain.subtract({name: len(items) for name, items in owners.items()})
    seen: Counter[str] = Counter()
    for user in inside:
        own = seen[user.name] - max(0, certain[user.name])
        seen[user.name] += 1
        if own < 0:
            room -= user.work
        else:
            weights[owners[user.name][own]] += user.work
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
    in_items = {i for item in items for i in item.members if not item.further}
    for k, reservoir in enumerate(problem.reservoirs):
        changes = [
            _certain_change(problem, i, k, optional=i in in_items)
            for i in range(len(problem.activities))
        ]
        room = reservoir.initial - reservoir.least
        for change in changes:
            room += change or 0
        weights = tuple(sum(max(0, -_net(problem, i, k)) for i in item.members) for item in items)
        if None not in changes and room < sum(weights):
            limits.append(Limit(room, weights))
    return limits


def _certain_change(problem: Problem, i: int, reservoir: int, *, optional: bool) -> int | None:
    """The most by which an activity can raise a level, items that lower it left out; None: endless.

    (An action that takes may happen its least number of times; each more is an item, or no matter.)
    """
    details, net = problem.activities[i].details, _net(problem, i, reservoir)
    if details.repeats is None:
        return net if net > 0 or not (optional or details.optional) else 0
    least, greatest = details.repeats
    if net <= 0:
        return least * net
    return None if greatest is None else greatest * net


def _net(problem: Problem, i: int, reservoir: int) -> int:
    """The change of a level by an activity, in the mode that leaves most."""
    return max(
        sum(change.amount for change in way.stock if change.reservoir == reservoir)
        for way in problem.activities[i].details.ways
    )


def _density(value: int, weight: int) -> float:
    """The sort key for falling value by weight."""
    return -value / weight if weight else float("-inf")


def is_refuted(problem: Problem | None, *, thoroughly: bool) -> bool:
    """Whether bounds, or reachable values of state, show that a problem has no schedule.

    There is none of a selection whose times contradict each other (None).
    """
    if problem is None:
        return True
    for i, activity in enumerate(problem.activities):
        head, latest = problem.bounds.heads[i], activity.latest_start
        deadline = problem.effective_deadline(i)
        too_late = (latest is not None and head > latest) or (
            deadline is not None and head + activity.duration_min > deadline
        )
        if too_late and not activity.details.optional and activity.details.repeats is None:
            return True
    if breaks_selections(problem) or is_out_of_reach(problem):
        return True
    latest = problem.deadline
    if latest is None:
        return False
    if thoroughly and problem.bounds.makespan.value <= latest:
        problem = resource_bounds(problem)
    return problem.bounds.makespan.value > latest


def breaks_selections(problem: Problem) -> bool:
    """Whether some selection of the task has too many items already, or can get too few."""
    return any(_is_broken(problem, selection) for selection in problem.selections)


def _is_broken(problem: Problem, selection: TaskSelection) -> bool:
    if selection.condition is not None and not is_certain(problem, selection.condition):
        return False
    there = sum(is_certain(problem, item) for item in selection.items)
    if selection.all_or_none:
        return False  # What cannot be there has made a range of it.
    most = len(selection.items) if selection.most is None else selection.most
    return there > most or len(selection.items) < selection.least
