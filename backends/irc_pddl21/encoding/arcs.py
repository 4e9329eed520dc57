"""A problem's arcs, sorted by their form in PDDL: conditions, waits and envelopes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from irc.problem import PLAIN, Problem
from irc.problem.temporal_network import Network, components, is_acyclic
from irc_pddl21.encoding.builder import Point


class MinLag(NamedTuple):
    """`time(after) >= time(before) + lag`."""

    before: Point
    after: Point
    lag: int


@dataclass
class SortedArcs:
    """All arcs as conditions on facts (lag 0), waits (lag > 0) and envelopes (lag < 0).

    `waits` maps (point, lag) to the points that must come that lag later. `meetings` are pairs of
    points that must coincide.
    """

    conditions: list[MinLag] = field(default_factory=list)
    waits: dict[tuple[Point, int], list[Point]] = field(default_factory=dict)
    envelopes: list[MinLag] = field(default_factory=list)
    meetings: list[tuple[Point, Point]] = field(default_factory=list)

    @property
    def awaited(self) -> set[int]:
        """The activities whose facts other activities, or waits, have as conditions."""
        return {c.before // 2 for c in self.conditions} | {point // 2 for point, _ in self.waits}

    def add(self, constraint: MinLag) -> None:
        """Adds a constraint to the list of its kind."""
        if constraint.lag > 0:
            followers = self.waits.setdefault((constraint.before, constraint.lag), [])
            followers.append(constraint.after)
        elif constraint.lag == 0:
            self.conditions.append(constraint)
        else:
            self.envelopes.append(constraint)


def sort_arcs(problem: Problem) -> SortedArcs:
    """All arcs of a problem by kind.

    Points that must coincide (a cycle of length 0) cannot wait for each other in PDDL, whose
    happenings are separated; arcs inside such a cycle become envelopes, and two of them one
    meeting. So do arcs from a start to an end: where the activity that ends gives the other what it
    needs, both are at one instant.
    """
    arcs = SortedArcs()
    for arc in problem.arcs:
        before, after = 2 * arc.before + arc.from_end, 2 * arc.after + arc.to_end
        arcs.add(MinLag(before, after, arc.min_lag))
        if arc.max_lag is not None:
            arcs.add(MinLag(after, before, -arc.max_lag))
    cycle_of = _cycles_of(problem, arcs)
    conditions, arcs.conditions = arcs.conditions, []
    for c in conditions:
        coincides = cycle_of.get(c.before) == cycle_of.get(c.after) is not None
        loose = coincides or _may_have_to_coincide(problem, c)
        (arcs.envelopes if loose else arcs.conditions).append(c)
    _join_meetings(arcs)
    return arcs


def _join_meetings(arcs: SortedArcs) -> None:
    """Makes one meeting of two envelopes that keep two points from coming after each other."""
    close = {(e.before, e.after) for e in arcs.envelopes if not e.lag}
    pairs = {(p, q) for p, q in close if p < q and (q, p) in close}
    arcs.meetings = sorted(pairs)
    arcs.envelopes = [
        e for e in arcs.envelopes if e.lag or not pairs & {(e.before, e.after), (e.after, e.before)}
    ]


def _may_have_to_coincide(problem: Problem, constraint: MinLag) -> bool:
    """Whether a start must not come after an end whose activity may give it what it needs."""
    starts, ends = not constraint.before % 2, bool(constraint.after % 2)
    both = (problem.activities[point // 2] for point in constraint[:2])
    return starts and ends and all(a.open_demands or a.details is not PLAIN for a in both)


def _cycles_of(problem: Problem, arcs: SortedArcs) -> dict[Point, int]:
    """For points on a common cycle of constraints that need facts: the number of the cycle."""
    count = len(problem.activities)
    plain = all(a.from_end and not a.to_end and a.max_lag is None for a in problem.arcs)
    if plain and is_acyclic(count, problem.arcs):
        return {}
    network = Network(2 * count)
    leaving: list[list[int]] = [[] for _ in range(2 * count)]

    def add(before: Point, after: Point) -> None:
        leaving[before].append(network.add(before, after, 0))

    for i in range(count):
        add(2 * i, 2 * i + 1)
    for i, activity in enumerate(problem.activities):
        if activity.duration_max == 0:
            add(2 * i + 1, 2 * i)
    for c in arcs.conditions:
        add(c.before, c.after)
    for (before, _), followers in arcs.waits.items():
        for after in followers:
            add(before, after)
    found: dict[Point, int] = {}
    for k, component in enumerate(components(network, leaving, range(2 * count))):
        if len({p // 2 for p in component}) > 1:
            found.update(dict.fromkeys(component, k))
    return found
