"""Rule 4: renewable capacity at every instant, and at every rank of it.

A sweep over the moments at which something changes: O(n log n).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain, groupby, pairwise
from operator import itemgetter
from typing import NamedTuple

from irc.model import Resource
from irc.model.quantities import Number
from irc.validation.bound_schedule import BoundSchedule, Occurrence, UncheckedTaskError
from irc.validation.verdict import Violations, listed

RankPairs = Sequence[tuple[int, int]]
"""The ranks of each occurrence's start and end."""

_Step = tuple[int, int, int]
"""The place of a moment in the order of (time, rank), the amount of the change, and the number of
the occurrence that causes it (-1: none). Places are whole numbers, which sort far faster than
times."""


def given_rank_pairs(bound: BoundSchedule) -> RankPairs:
    """The ranks that the entries state."""
    return [(occurrence.rank, occurrence.end_rank) for occurrence in bound.occurrences]


class _Moments:
    """The moments of changes, in order: `width` places for each instant, one for each rank.

    Where ranks differ, the last place of an instant comes after all its ranks.
    """

    def __init__(self, times: Iterable[Number], last_rank: int) -> None:
        self.times = sorted(set(times))
        self.width = last_rank + 2 if last_rank else 1
        self.place = {time: number * self.width for number, time in enumerate(self.times)}

    def at(self, time: Number, rank: int) -> int:
        return self.place[time] + rank

    def behind(self, time: Number) -> int:
        return self.place[time] + self.width - 1


def check_capacity(
    bound: BoundSchedule, violations: Violations, ranks: RankPairs | None = None
) -> None:
    """Checks rule 4: a use holds over [(start, rank), (end, end_rank)), and not for zero duration.

    So units that a happening frees can be taken at the same rank of that instant, or a later one.
    A capacity falls after all ranks of its instant, and rises before them.
    """
    ranks = given_rank_pairs(bound) if ranks is None else ranks
    holders = [o for o in bound.occurrences if o.entry.resources and o.start < o.end]
    capacities = {
        resource.id: capacity_changes(bound, resource)
        for resource in bound.resources.values()
        if resource.kind != "reservoir"
    }
    moments = _Moments(
        chain(
            (occurrence.start for occurrence in holders),
            (occurrence.end for occurrence in holders),
            *capacities.values(),
        ),
        max((max(ranks[o.number]) for o in holders), default=0),
    )
    steps: dict[str, list[_Step]] = {}
    for occurrence in holders:
        rank, end_rank = ranks[occurrence.number]
        start, end = moments.at(occurrence.start, rank), moments.at(occurrence.end, end_rank)
        for name, amount in occurrence.entry.resources.items():
            if amount > 0 and name in capacities:
                steps.setdefault(name, []).append((start, amount, occurrence.number))
                steps[name].append((end, -amount, occurrence.number))
    for name, own in steps.items():
        _check_renewable(bound, name, own, capacities[name], moments, violations)


def _check_renewable(
    bound: BoundSchedule,
    name: str,
    steps: list[_Step],
    capacities: Mapping[Number, int],
    moments: _Moments,
    violations: Violations,
) -> None:
    capacity, in_use, paused = bound.resources[name].capacity, 0, 0
    holding: dict[int, int] = {}
    changes: dict[int, int] = {}
    level = capacity
    for time in sorted(capacities):
        place = moments.behind(time) if capacities[time] < level else moments.at(time, 0)
        level = changes[place] = capacities[time]
    steps += [(place, 0, -1) for place in changes]
    for place, group in groupby(sorted(steps), key=itemgetter(0)):
        tighter = False
        for _, amount, number in group:
            if number < 0:
                tighter = tighter or changes[place] < capacity
                capacity = changes[place]
                continue
            in_use += amount
            if bound.occurrences[number].paused is not None:
                paused += amount
            tighter = tighter or amount > 0
            if amount > 0:
                holding[number] = amount
            else:
                holding.pop(number, None)
        # (What pauses keeps its units while there is no capacity.)
        if tighter and in_use - (0 if capacity else paused) > capacity:
            time = moments.times[place // moments.width]
            _add_overload(bound, name, time, in_use, capacity, holding, violations)


def capacity_changes(bound: BoundSchedule, resource: Resource) -> dict[Number, int]:
    """The capacity at each instant at which it may change, and after it."""
    number = bound.clock.number
    windows = sorted(
        (number(w.from_), number(w.to), w.capacity)
        for w in dict.fromkeys(resource.availability)
        if number(w.from_) < number(w.to)
    )
    if any(start < end for (_, end, _), (start, _, _) in pairwise(windows)):
        raise UncheckedTaskError(f"the availability windows of {resource.id!r} overlap")
    if resource.calendar is not None and bound.calendars is not None:
        return dict(bound.calendars.levels(resource))
    capacities: dict[Number, int] = {}
    for start, end, capacity in windows:
        capacities[start] = capacity
        capacities[end] = resource.capacity
    return capacities


def _add_overload(
    bound: BoundSchedule,
    name: str,
    time: Number,
    in_use: int,
    capacity: int,
    holding: Mapping[int, int],
    violations: Violations,
) -> None:
    users = [bound.occurrences[number] for number in holding]
    named = listed((user.entry.id for user in users), len(holding))
    in_order = ""
    if any(user.end == time for user in users):
        in_order = ", in the order of ranks,"
    violations.add(
        "capacity",
        f"{in_use} of {name!r} are in use at {violations.time(time)}{in_order or ','} "
        f"its capacity then is {capacity} (used by {named})",
        (user.entry.id for user in users),
        (time,),
        carried=all(user.past for user in users),
    )


class ContendedInstant(NamedTuple):
    """An instant at which some occurrences free a resource, others take it, and not all fit.

    `room` is the capacity that all others leave before the units are freed.
    """

    resource: str
    time: Number
    room: int
    ending: tuple[tuple[Occurrence, int], ...]
    starting: tuple[tuple[Occurrence, int], ...]


def hand_overs(bound: BoundSchedule) -> Iterator[ContendedInstant]:
    """The instants at which the order of ranks decides whether a resource suffices."""
    for resource in bound.resources.values():
        if resource.kind != "reservoir":
            yield from _hand_overs(bound, resource)


def _hand_overs(bound: BoundSchedule, resource: Resource) -> Iterator[ContendedInstant]:
    ending: dict[Number, list[tuple[Occurrence, int]]] = {}
    starting: dict[Number, list[tuple[Occurrence, int]]] = {}
    for occurrence in bound.occurrences:
        amount = occurrence.entry.resources.get(resource.id, 0)
        if amount > 0 and occurrence.start < occurrence.end:
            starting.setdefault(occurrence.start, []).append((occurrence, amount))
            ending.setdefault(occurrence.end, []).append((occurrence, amount))
    changes = capacity_changes(bound, resource)
    capacity = before = resource.capacity
    in_use = 0
    for time in sorted({*ending, *starting, *changes}):
        before, capacity = capacity, changes.get(time, capacity)
        freed = sum(amount for _, amount in ending.get(time, ()))
        taken = sum(amount for _, amount in starting.get(time, ()))
        room = max(before, capacity) - (in_use - freed)
        if freed and taken and freed + taken > room:
            yield ContendedInstant(
                resource.id, time, room, tuple(ending[time]), tuple(starting[time])
            )
        in_use += taken - freed
