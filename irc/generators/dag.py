"""Random task graphs with the statistics of AsyncPlan-XXL.

Nodes stand in a random order, their rank. An edge runs from a lower rank to a higher one: to the
next rank with a probability that falls with the size, to any other with 0.05. A node without an
edge gets one. Graphs are rejected where they fall into too many parts, where the longest path has
fewer than two nodes, and where all nodes are on it, so that nothing can run side by side.

The probabilities were fitted to the data's numbers of edges, joins (nodes with two predecessors or
more), sources, sinks and nodes on the longest path. For the sizes of the data, each graph has
targets of its own: numbers of edges, joins and nodes on the longest path, spread evenly over the
data's means and deviations (`spread`): so the means of 50 graphs differ little from those.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from irc.errors import OptionError
from irc.generators.dice import Dice, bell, spread, tail

LEAST_SIZE, MOST_SIZE = 3, 2000
FAR = 0.05
"""The probability of an edge between ranks that are not neighbours."""

CANDIDATES = 20
"""Graphs of which the nearest to the targets is taken."""

MOST_DEVIATIONS = 2.5
"""Targets are not further from the mean."""

_ATTEMPTS = 40
"""Graphs that are rejected before the number of edges comes one closer to the mean."""


class Measured(NamedTuple):
    """Statistics of graphs of one size: mean and deviation, and the probability that was fitted."""

    size: int
    near: float
    edges: tuple[float, float]
    longest: tuple[float, float]
    joins: tuple[float, float]
    parallelism: tuple[float, float]


TABLE = (
    Measured(5, 0.85, (3.66, 0.69), (3.26, 0.53), (0.34, 0.48), (1.29, 0.27)),
    Measured(10, 0.70, (8.82, 1.19), (5.74, 1.52), (1.24, 0.94), (1.53, 0.51)),
    Measured(15, 0.62, (14.82, 1.67), (6.62, 2.27), (2.84, 1.25), (1.58, 0.47)),
    Measured(20, 0.56, (19.78, 2.31), (7.04, 2.29), (3.96, 1.26), (2.02, 0.77)),
    Measured(30, 0.49, (35.88, 4.32), (8.58, 2.89), (9.18, 2.27), (2.14, 0.85)),
    Measured(40, 0.41, (54.78, 5.77), (9.08, 2.30), (15.10, 2.40), (2.05, 0.88)),
    Measured(50, 0.36, (78.48, 6.59), (9.56, 2.12), (21.78, 3.07), (2.87, 1.30)),
    Measured(60, 0.34, (104.66, 9.46), (10.82, 2.38), (28.84, 3.47), (3.34, 1.35)),
    Measured(70, 0.32, (142.44, 10.63), (12.00, 2.39), (38.48, 3.22), (3.16, 1.39)),
    Measured(80, 0.31, (179.56, 12.52), (13.40, 2.83), (46.44, 3.92), (3.17, 1.44)),
    Measured(90, 0.29, (222.00, 11.08), (14.34, 2.12), (56.32, 3.44), (3.28, 1.42)),
    Measured(100, 0.28, (271.10, 17.69), (15.62, 2.93), (66.18, 4.19), (3.01, 1.19)),
)
"""The statistics of AsyncPlan-XXL: 50 graphs of each size."""

Edge = tuple[int, int]


@dataclass(frozen=True)
class Dag:
    """A graph over nodes 0 to `size` - 1, which are in the order of their ranks."""

    size: int
    edges: tuple[Edge, ...]

    @property
    def longest(self) -> int:
        """The number of nodes on a longest path."""
        return max(self.finishes([1] * self.size), default=0)

    @property
    def joins(self) -> int:
        """The number of nodes with two predecessors or more."""
        return sum(len(before) > 1 for before in self.predecessors())

    @property
    def parts(self) -> int:
        """The number of parts without an edge between them."""
        part = list(range(self.size))

        def root(node: int) -> int:
            while part[node] != node:
                part[node] = part[part[node]]
                node = part[node]
            return node

        for a, b in self.edges:
            part[root(a)] = root(b)
        return sum(part[node] == node for node in range(self.size))

    def predecessors(self) -> list[list[int]]:
        """The predecessors of each node."""
        found: list[list[int]] = [[] for _ in range(self.size)]
        for a, b in self.edges:
            found[b].append(a)
        return found

    def finishes(self, durations: Sequence[int]) -> list[int]:
        """The earliest end of each node: the length of the longest path to it."""
        ends = [0] * self.size
        for node, before in enumerate(self.predecessors()):
            ends[node] = durations[node] + max((ends[a] for a in before), default=0)
        return ends


def statistics_of(size: int) -> Measured:
    """The statistics that graphs of a size should have, in proportion between two of the table."""
    for low, high in pairwise(TABLE):
        if low.size <= size <= high.size:
            share = (size - low.size) / (high.size - low.size)
            return _mixed(low, high, share, size)
    return (TABLE[0] if size < TABLE[0].size else TABLE[-1])._replace(size=size)


def _mixed(low: Measured, high: Measured, share: float, size: int) -> Measured:
    def one(a: float, b: float) -> float:
        return a + (b - a) * share

    def two(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
        return one(a[0], b[0]), one(a[1], b[1])

    return Measured(
        size,
        one(low.near, high.near),
        two(low.edges, high.edges),
        two(low.longest, high.longest),
        two(low.joins, high.joins),
        two(low.parallelism, high.parallelism),
    )


def has_targets(size: int) -> bool:
    """Whether the data has graphs of about this size, whose statistics are aimed at."""
    return TABLE[0].size <= size <= TABLE[-1].size


def require_size(size: int) -> None:
    """Raises `OptionError` for a size that no graph can have."""
    if not LEAST_SIZE <= size <= MOST_SIZE:
        raise OptionError(f"a graph has {LEAST_SIZE} to {MOST_SIZE:,} steps, not {size:,}")


def random_dag(size: int, dice: Dice, position: tuple[float, ...]) -> Dag:
    """A graph that is accepted; `position` are the numbers of `spread`. Raises `OptionError`."""
    require_size(size)
    wanted = statistics_of(size)
    if not has_targets(size):
        return _accepted(wanted, None, dice)
    least = (size + 1) // 2
    dense = _deviations(wanted.edges, position[0], least)
    edges = _target(wanted.edges, dense, least)
    # (Graphs with more edges have more joins, and longer paths.)
    longest = _target(wanted.longest, 0.6 * dense + 0.8 * bell(position[1]), 2)
    joins = _target(wanted.joins, 0.8 * dense + 0.6 * bell(position[2]), 0)
    found = [_accepted(wanted, edges, dice) for _ in range(CANDIDATES)]

    def distance(dag: Dag) -> float:
        too_long = abs(dag.longest - longest) / wanted.longest[1]
        return too_long + abs(dag.joins - joins) / wanted.joins[1]

    return min(found, key=distance)


def _deviations(statistic: tuple[float, float], share: float, least: int) -> float:
    """A quantile in deviations from the mean; skewed where the limit is close to the mean."""
    mean, deviation = statistic
    found = bell(share) if mean - 2 * deviation > least - 0.5 else tail(share) - 1
    return max(-MOST_DEVIATIONS, min(MOST_DEVIATIONS, found))


def _target(statistic: tuple[float, float], deviations: float, least: int) -> int:
    mean, deviation = statistic
    return max(least, int(mean + deviations * deviation + 0.5))


def _accepted(wanted: Measured, edges: int | None, dice: Dice) -> Dag:
    """A graph with a number of edges, if it is given, that is not rejected."""
    number = edges
    while True:
        for _ in range(_ATTEMPTS):
            dag = _candidate(wanted.size, wanted.near, number, dice)
            if dag is not None and _is_accepted(dag):
                return dag
        if number is not None:
            number += 1 if number < wanted.edges[0] else -1


def _is_accepted(dag: Dag) -> bool:
    return dag.parts <= 1 + max(1, min(4, dag.size // 5)) and 2 <= dag.longest < dag.size


def _candidate(size: int, near: float, edges: int | None, dice: Dice) -> Dag | None:
    found = {
        (a, b)
        for a in range(size)
        for b in range(a + 1, size)
        if dice.chance(near if b == a + 1 else FAR)
    }
    _connect(found, size, dice)
    if edges is not None and not _adjust(found, size, edges, dice):
        return None
    return Dag(size, tuple(sorted(found)))


def _degrees(edges: Iterable[Edge], size: int) -> list[int]:
    degrees = [0] * size
    for a, b in edges:
        degrees[a] += 1
        degrees[b] += 1
    return degrees


def _connect(edges: set[Edge], size: int, dice: Dice) -> None:
    """Gives each node without an edge one, to a random node before or after it."""
    degrees = _degrees(edges, size)
    for node in range(size):
        if degrees[node]:
            continue
        backwards = node == size - 1 or (node > 0 and dice.chance(0.5))
        other = dice.below(node) if backwards else dice.between(node + 1, size - 1)
        edges.add((min(node, other), max(node, other)))
        degrees[node] += 1
        degrees[other] += 1


def _adjust(edges: set[Edge], size: int, wanted: int, dice: Dice) -> bool:
    """Adds or removes random edges until there are as many as wanted; False if that fails.

    No node loses its last edge.
    """
    degrees = _degrees(edges, size)
    for a, b in dice.shuffled(sorted(edges)):
        if len(edges) <= wanted:
            break
        if degrees[a] > 1 and degrees[b] > 1:
            edges.remove((a, b))
            degrees[a] -= 1
            degrees[b] -= 1
    for _ in range(20 * size):
        if len(edges) >= wanted:
            break
        a, b = sorted((dice.below(size), dice.below(size)))
        if a != b:
            edges.add((a, b))
    return len(edges) == wanted


def position_in_set(size: int, seed: int, index: int) -> tuple[float, ...]:
    """The place of an instance among those of a size and a seed."""
    return spread(index, Dice("asyncplan", size, seed))
