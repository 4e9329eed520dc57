"""Simple temporal networks: the least times that satisfy `t[v] >= t[u] + w`, and why not.

Longest paths: topological order where the constraints are acyclic (linear time); inside a
strongly connected component (maximum lags, duration ranges) label correction with detection of
positive cycles. Source: Dechter, Meiri, Pearl, "Temporal constraint networks", AIJ 49 (1991).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple


@dataclass
class Network:
    """Difference constraints over numbered points; edge e says `t[dst] >= t[src] + weight`."""

    size: int
    src: list[int] = field(default_factory=list)
    dst: list[int] = field(default_factory=list)
    weight: list[int] = field(default_factory=list)

    def add(self, src: int, dst: int, weight: int) -> int:
        """Adds a constraint and returns its number."""
        self.src.append(src)
        self.dst.append(dst)
        self.weight.append(weight)
        return len(self.src) - 1

    def reversed(self) -> Network:
        """The network of distances *to* the end: every edge reversed."""
        return Network(self.size, self.dst, self.src, self.weight)


class Times(NamedTuple):
    """The least solution, the cause of each time, and the contradictions found.

    `cause[v]` is the edge that set `t[v]`, or -1 where its floor did. `cycles` holds one positive
    cycle (edge numbers in order) for each strongly connected component that has one; the points
    of such a component keep their floors.
    """

    t: list[int]
    cause: list[int]
    cycles: list[list[int]]

    def chain(self, point: int, network: Network) -> list[int]:
        """The edges that forced a point's time, first to last."""
        edges: list[int] = []
        while (edge := self.cause[point]) >= 0 and len(edges) <= network.size:
            edges.append(edge)
            point = network.src[edge]
        return edges[::-1]


def earliest(network: Network, floors: Sequence[int]) -> Times:
    """The least times with `t[v] >= floors[v]` that satisfy every constraint."""
    t, cause = list(floors), [-1] * network.size
    src, dst, weight = network.src, network.dst, network.weight
    leaving: list[list[int]] = [[] for _ in range(network.size)]
    waiting = [0] * network.size
    for edge, point in enumerate(src):
        leaving[point].append(edge)
        waiting[dst[edge]] += 1
    ready = [point for point in range(network.size) if not waiting[point]]
    done = 0
    while ready:
        u = ready.pop()
        done += 1
        for edge in leaving[u]:
            v = dst[edge]
            reached = t[u] + weight[edge]
            if reached > t[v]:
                t[v] = reached
                cause[v] = edge
            waiting[v] -= 1
            if not waiting[v]:
                ready.append(v)
    if done == network.size:
        return Times(t, cause, [])
    rest = [point for point in range(network.size) if waiting[point]]
    return _earliest_on_cycles(network, leaving, rest, t, cause)


def _earliest_on_cycles(
    network: Network, leaving: list[list[int]], rest: list[int], t: list[int], cause: list[int]
) -> Times:
    """Times of the points on cycles and after them, one strongly connected component at a time."""
    cycles: list[list[int]] = []
    for component in components(network, leaving, rest):
        members = set(component)
        before = [(t[p], cause[p]) for p in component]
        cycle = _relax(network, leaving, component, members, t, cause)
        if cycle is not None:
            cycles.append(cycle)
            for point, (time, edge) in zip(component, before, strict=True):
                t[point], cause[point] = time, edge
        for u in component:
            for edge in leaving[u]:
                v = network.dst[edge]
                if v not in members and t[u] + network.weight[edge] > t[v]:
                    t[v] = t[u] + network.weight[edge]
                    cause[v] = edge
    return Times(t, cause, cycles)


def _relax(
    network: Network,
    leaving: list[list[int]],
    component: list[int],
    members: set[int],
    t: list[int],
    cause: list[int],
) -> list[int] | None:
    """Corrects labels inside one component; returns a positive cycle if there is one."""
    dst, weight = network.dst, network.weight
    queue, queued = deque(_forward(network, leaving, component, members)), set(component)
    # While there is a positive cycle the causes close to one sooner or later; looking for it once
    # per as many steps as there are points costs no more than the steps themselves (Cherkassky and
    # Goldberg, "Negative-cycle detection algorithms", 1999).
    steps = 0
    while queue:
        steps += 1
        if steps % len(component) == 0 and (cycle := _cycle_of_causes(network, cause, members)):
            return cycle
        u = queue.popleft()
        queued.discard(u)
        for edge in leaving[u]:
            v = dst[edge]
            if v not in members or t[u] + weight[edge] <= t[v]:
                continue
            t[v] = t[u] + weight[edge]
            cause[v] = edge
            if v not in queued:
                queue.append(v)
                queued.add(v)
    return None


def _forward(
    network: Network, leaving: list[list[int]], component: list[int], members: set[int]
) -> list[int]:
    """The component, along its constraints of weight >= 0 (depth first, reverse postorder).

    So one round over it finds the times that minimum lags demand, however long their chains are.
    """
    dst, weight = network.dst, network.weight
    order: list[int] = []
    seen: set[int] = set()
    for root in component:
        work = [] if root in seen else [(root, iter(leaving[root]))]
        seen.add(root)
        while work:
            for edge in work[-1][1]:
                v = dst[edge]
                if weight[edge] >= 0 and v in members and v not in seen:
                    seen.add(v)
                    work.append((v, iter(leaving[v])))
                    break
            else:
                order.append(work.pop()[0])
    return order[::-1]


def _cycle_of_causes(network: Network, cause: list[int], members: set[int]) -> list[int] | None:
    """A cycle of causes (such a cycle is always positive), if one has closed yet."""
    walked: dict[int, int] = {}
    for number, point in enumerate(members):
        while point in members and point not in walked and cause[point] >= 0:
            walked[point] = number
            point = network.src[cause[point]]
        if walked.get(point) == number:
            return _causes_around(network, cause, point)
    return None


def _causes_around(network: Network, cause: list[int], first: int) -> list[int]:
    point, edges = first, []
    while True:
        edge = cause[point]
        edges.append(edge)
        point = network.src[edge]
        if point == first:
            return edges[::-1]


def components(
    network: Network, leaving: list[list[int]], points: Sequence[int]
) -> list[list[int]]:
    """Strongly connected components in topological order (Tarjan 1972, without recursion)."""
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    on_stack: set[int] = set()
    stack: list[int] = []
    found: list[list[int]] = []
    dst = network.dst
    for root in points:
        if root in index:
            continue
        index[root] = low[root] = len(index)
        stack.append(root)
        on_stack.add(root)
        work = [(root, iter(leaving[root]))]
        while work:
            u, edges = work[-1]
            for edge in edges:
                v = dst[edge]
                if v not in index:
                    index[v] = low[v] = len(index)
                    stack.append(v)
                    on_stack.add(v)
                    work.append((v, iter(leaving[v])))
                    break
                if v in on_stack:
                    low[u] = min(low[u], index[v])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[u])
                if low[u] == index[u]:
                    component = []
                    while True:
                        v = stack.pop()
                        on_stack.discard(v)
                        component.append(v)
                        if v == u:
                            break
                    found.append(component)
    return found[::-1]


def is_acyclic(size: int, arcs: Iterable[tuple[Any, ...]]) -> bool:
    """Whether arcs (their first two fields: from, to) between numbered points form no cycle."""
    following: list[list[int]] = [[] for _ in range(size)]
    waiting = [0] * size
    for arc in arcs:
        following[arc[0]].append(arc[1])
        waiting[arc[1]] += 1
    ready = [point for point in range(size) if not waiting[point]]
    for u in ready:
        for v in following[u]:
            waiting[v] -= 1
            if not waiting[v]:
                ready.append(v)
    return len(ready) == size
