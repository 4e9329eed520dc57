"""A problem's arcs, sorted by what each becomes in PDDL: a fact, a wait or an envelope."""

from __future__ import annotations

from typing import NamedTuple

from irc.problem import Problem
from irc.problem.temporal_network import Network, components, is_acyclic

Point = int
"""The start (2i) or the end (2i + 1) of activity i."""


class AtLeast(NamedTuple):
    """`time(to) >= time(frm) + lag`."""

    frm: Point
    to: Point
    lag: int


def sort_constraints(
    problem: Problem,
) -> tuple[list[AtLeast], list[AtLeast], list[AtLeast]]:
    """All arcs as facts (lag 0), waits (lag > 0) and envelopes (lag < 0).

    Points that must coincide (a cycle of length 0) cannot wait for each other in PDDL, whose
    happenings are separated; arcs inside such a cycle become envelopes.
    """
    facts, waits, envelopes = [], [], []
    for arc in problem.arcs:
        frm, to = 2 * arc.before + arc.from_end, 2 * arc.after + arc.to_end
        if arc.min_lag == 0 and arc.max_lag is None:
            facts.append(AtLeast(frm, to, 0))
            continue
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
