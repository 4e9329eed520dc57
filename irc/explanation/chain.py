"""The critical chain of a schedule: links from t = 0 to the makespan, one after another.

A link is a statement about time that the schedule meets exactly, or a hand-over: an action takes at
once what another has just freed. The lengths of the links add up to the makespan. Of several chains
this finds one with the fewest hand-overs, and of those one with the fewest links. A chain without
hand-overs proves that no schedule is shorter.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from typing import NamedTuple

from irc.problem import Problem
from irc.problem.decisions import Decision
from irc.problem.setups import setup_links
from irc.problem.statements import (
    KINDS,
    ORIGIN,
    Difference,
    Side,
    Statement,
    all_statements,
    differences_of,
    end_point,
    how_time_is,
    start_point,
)
from irc.retiming.resources import resource_orders
from irc.retiming.slack import uses_taken
from irc.schedule import Schedule


@dataclass(frozen=True, slots=True)
class HandOver:
    """`after` starts when `before` frees the resource (all indexes), or is set up after it.

    `needed` is whether `after` had to wait for the resource; otherwise the order of the two is
    only that of the schedule. With a set-up of the initial family `before` is None.
    """

    before: int | None
    after: int
    resource: int
    needed: bool
    setup: int = 0
    """The time of the set-up between the two, in ticks."""
    back: bool = False
    """Whether `before` waits for `after`, because the resource is never idle between the two."""


@dataclass(frozen=True, slots=True)
class Link:
    """One step of the chain, from one time (ticks) to another, with its reason.

    Without a statement and a hand-over, the reason is that nothing is before t = 0 or ends before
    it starts.
    """

    start: int
    end: int
    difference: Difference
    hand_over: HandOver | None = None

    @property
    def length(self) -> int:
        """The length in ticks; it is negative for a maximum lag, which leads back in time."""
        return self.end - self.start


class _Edge(NamedTuple):
    difference: Difference
    hand_over: HandOver | None


_Cost = tuple[int, int, int]
"""(orders that are not needed, hand-overs, links)."""


def critical_chain(
    problem: Problem, schedule: Schedule, last: Iterable[int] | None = None
) -> tuple[Link, ...] | None:
    """The links in order of time; None for a schedule that could end earlier in the same order.

    With `last` (indexes of activities) the chain leads to the latest end of these. Use it only for
    problems without state and stock, where ranks decide nothing (see `irc.retiming.slack.slacks`).
    `schedule` must be a valid one of exactly the problem's activities.
    """
    if not schedule.entries:
        return ()
    times = _times(problem, schedule)
    if times is None:
        return None
    leaving: dict[int, list[_Edge]] = {}
    for tight in _tight_edges(problem, schedule, times):
        leaving.setdefault(tight.difference.src, []).append(tight)
    ends = {end_point(i) for i in (range(len(problem.activities)) if last is None else last)}
    latest = max(times[point] for point in ends)
    reached: dict[int, _Edge | None] = {}
    heap: list[tuple[_Cost, int, int, _Edge | None]] = [((0, 0, 0), 0, ORIGIN, None)]
    pushed = 0
    while heap:
        cost, _, point, edge = heappop(heap)
        if point in reached:
            continue
        reached[point] = edge
        if point in ends and times[point] == latest:
            return _links(reached, point, times)
        for onward in leaving.get(point, ()):
            if onward.difference.dst not in reached:
                pushed += 1
                heappush(heap, (_plus(cost, onward), pushed, onward.difference.dst, onward))
    return None


def _plus(cost: _Cost, edge: _Edge) -> _Cost:
    kept, handed, links = cost
    if edge.hand_over is None:
        return kept, handed, links + 1
    return kept + (not edge.hand_over.needed), handed + 1, links + 1


def _links(reached: dict[int, _Edge | None], point: int, times: Sequence[int]) -> tuple[Link, ...]:
    links = []
    while (last := reached[point]) is not None:
        src = last.difference.src
        links.append(Link(times[src], times[point], last.difference, last.hand_over))
        point = src
    return tuple(links[::-1])


def _times(problem: Problem, schedule: Schedule) -> list[int] | None:
    """The time of each point; None if some are not whole: those wait for nothing."""
    by_id = {entry.id: entry for entry in schedule.entries}
    times = [0]
    for activity in problem.activities:
        entry = by_id[activity.id]
        for moment in (problem.to_ticks(entry.start), problem.to_ticks(entry.end)):
            if not isinstance(moment, int):
                return None
            times.append(moment)
    return times


def _tight_edges(problem: Problem, schedule: Schedule, times: Sequence[int]) -> Iterator[_Edge]:
    stated = differences_of(problem, _one_sided(problem))
    for d in (*stated, *how_time_is(range(len(problem.activities)))):
        if times[d.dst] - times[d.src] == d.weight and d.dst != ORIGIN:
            yield _Edge(d, None)
    for hand_over in (*_hand_overs(problem, schedule, times), *_setups(problem, schedule, times)):
        src = ORIGIN if hand_over.before is None else end_point(hand_over.before)
        dst = start_point(hand_over.after)
        if hand_over.back:
            yield _Edge(Difference(dst, src, -hand_over.setup), hand_over)
        else:
            yield _Edge(Difference(src, dst, hand_over.setup), hand_over)


def _setups(problem: Problem, schedule: Schedule, times: Sequence[int]) -> Iterator[HandOver]:
    """The set-ups that end when the next use begins."""
    if not problem.has_setups:
        return
    decisions = _decisions(problem, times)
    chosen = uses_taken(problem, schedule)
    for link in setup_links(problem.resources, problem.activities, decisions, chosen):
        since = 0 if link.before is None else times[end_point(link.before)]
        if link.setup.time and since + link.setup.time == times[start_point(link.after)]:
            yield HandOver(link.before, link.after, link.resource, True, link.setup.time)
        setups = problem.resources[link.resource].setups
        if setups is not None and setups.tight and link.before is not None:
            yield HandOver(link.before, link.after, link.resource, True, link.setup.time, back=True)


def _decisions(problem: Problem, times: Sequence[int]) -> list[Decision]:
    return [
        Decision(times[start_point(i)], times[end_point(i)]) for i in range(len(problem.activities))
    ]


def _one_sided(problem: Problem) -> Iterator[Statement]:
    """All statements, with one item for each limit of a statement that has two."""
    for statement in all_statements(problem):
        if KINDS[statement.kind].has_two_sides(problem, statement):
            yield statement._replace(side=Side.LEAST)
            yield statement._replace(side=Side.MOST)
        else:
            yield statement


def _hand_overs(problem: Problem, schedule: Schedule, times: Sequence[int]) -> Iterator[HandOver]:
    held = _held(problem, schedule)
    decisions = _decisions(problem, times)
    chosen = [tuple(amounts) for amounts in held]
    usage = _Usage(problem, held, decisions)
    for before, after in sorted(resource_orders(problem, decisions, chosen, 0)):
        if decisions[before].end != decisions[after].start:
            continue
        common = sorted(held[before].keys() & held[after].keys())
        if common:
            short = [r for r in common if usage.is_short(r, after, held[after][r])]
            yield HandOver(before, after, (short or common)[0], bool(short))


def _held(problem: Problem, schedule: Schedule) -> list[dict[int, int]]:
    index = {resource.id: r for r, resource in enumerate(problem.resources)}
    by_id = {entry.id: entry for entry in schedule.entries}
    return [
        {index[name]: amount for name, amount in by_id[a.id].resources.items()}
        for a in problem.activities
    ]


class _Usage:
    """The amount of each resource that is in use just before an activity starts."""

    def __init__(
        self, problem: Problem, held: Sequence[dict[int, int]], decisions: Sequence[Decision]
    ) -> None:
        self.problem = problem
        self.decisions = decisions
        changes: dict[int, Counter[int]] = {}
        for amounts, decision in zip(held, decisions, strict=True):
            for r, amount in amounts.items():
                changes.setdefault(r, Counter())[int(decision.start)] += amount
                changes[r][int(decision.end)] -= amount
        self.before = {r: dict(_levels_before(of)) for r, of in changes.items()}

    def is_short(self, resource: int, activity: int, amount: int) -> bool:
        """Whether `amount` more would exceed the capacity just before the activity starts."""
        level = self.before[resource][int(self.decisions[activity].start)]
        return level + amount > self.problem.resources[resource].capacity


def _levels_before(changes: Counter[int]) -> Iterable[tuple[int, int]]:
    level = 0
    for time in sorted(changes):
        yield time, level
        level += changes[time]
