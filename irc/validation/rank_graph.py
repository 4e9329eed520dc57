"""The graph of rank constraints: which node comes after another, or together with it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence

from irc.errors import IrcError
from irc.validation.happenings import Edge, Edges


class OutOfSteps(IrcError):
    """The search has used up its steps."""


class StepBudget:
    """The steps that are left to the search for ranks."""

    def __init__(self, steps: int) -> None:
        self.left = steps

    @property
    def is_spent(self) -> bool:
        """Whether no step is left."""
        return self.left <= 0

    def charge(self, steps: int) -> None:
        """Takes steps for work that was done elsewhere."""
        self.left -= steps

    def spend(self) -> None:
        """Takes one step; raises when none is left."""
        if self.left <= 0:
            raise OutOfSteps
        self.left -= 1


class RankGraph:
    """Ranks that satisfy a growing, shrinking set of edges."""

    def __init__(self, ranks: list[int], edges: Iterable[Edge], budget: StepBudget) -> None:
        self.ranks = ranks
        self.added: list[Edge] = []
        self.budget = budget
        self._out: list[list[tuple[int, int]]] = [[] for _ in ranks]
        self._in: list[list[int]] = [[] for _ in ranks]
        self._raised: list[tuple[int, int]] = []
        for a, b, least in edges:
            self._out[a].append((b, least))
            self._in[b].append(a)

    def mark(self) -> tuple[int, int]:
        """The present state, for `undo`."""
        return len(self.added), len(self._raised)

    def undo(self, mark: tuple[int, int]) -> None:
        """Removes all edges that were added since `mark`."""
        edges, raised = mark
        while len(self.added) > edges:
            a, b, _ = self.added.pop()
            self._out[a].pop()
            self._in[b].pop()
        while len(self._raised) > raised:
            node, rank = self._raised.pop()
            self.ranks[node] = rank

    def add(self, edges: Edges) -> bool:
        """Adds edges and raises ranks to satisfy them; False, part done, on a strict cycle."""
        return all(self._add(edge) for edge in edges)

    def allows(self, edges: Edges) -> bool:
        """Whether edges could be added."""
        mark = self.mark()
        allowed = self.add(edges)
        self.undo(mark)
        return allowed

    def _add(self, edge: Edge) -> bool:
        a, b, least = edge
        self.budget.spend()
        if a == b:
            return least == 0
        self.added.append(edge)
        self._out[a].append((b, least))
        self._in[b].append(a)
        if self.ranks[b] >= self.ranks[a] + least:
            return True
        self._raise(b, self.ranks[a] + least)
        queue = deque([b])
        while queue:
            node = queue.popleft()
            rank = self.ranks[node]
            for target, more in self._out[node]:
                self.budget.spend()
                if self.ranks[target] >= rank + more:
                    continue
                if target == a:
                    return False
                self._raise(target, rank + more)
                queue.append(target)
        return True

    def _raise(self, node: int, rank: int) -> None:
        self._raised.append((node, self.ranks[node]))
        self.ranks[node] = rank

    def unmet(self, edges: Edges) -> int:
        """The number of `edges` that the present ranks do not satisfy."""
        return sum(self.ranks[b] < self.ranks[a] + least for a, b, least in edges)

    def follows_any(self, node: int, others: set[int]) -> bool:
        """Whether `node` comes after, or together with, another one of `others`."""
        seen = {node}
        queue = deque([node])
        while queue:
            for source in self._in[queue.popleft()]:
                self.budget.spend()
                if source in others and source != node:
                    return True
                if source not in seen:
                    seen.add(source)
                    queue.append(source)
        return False


def strong_components(count: int, edges: Sequence[Edge]) -> list[int]:
    """The strongly connected component of each node, numbered so that edges never lead upward.

    Tarjan (1972), without recursion: O(nodes + edges).
    """
    following: list[list[int]] = [[] for _ in range(count)]
    for a, b, _ in edges:
        following[a].append(b)
    index = [-1] * count
    low = [0] * count
    component = [-1] * count
    stack: list[int] = []
    seen, found = 0, 0
    for root in range(count):
        if index[root] >= 0:
            continue
        path = [(root, iter(following[root]))]
        index[root] = low[root] = seen
        seen += 1
        stack.append(root)
        while path:
            node, targets = path[-1]
            for target in targets:
                if index[target] < 0:
                    index[target] = low[target] = seen
                    seen += 1
                    stack.append(target)
                    path.append((target, iter(following[target])))
                    break
                if component[target] < 0:
                    low[node] = min(low[node], index[target])
            else:
                path.pop()
                if path:
                    parent = path[-1][0]
                    low[parent] = min(low[parent], low[node])
                if low[node] == index[node]:
                    while True:
                        member = stack.pop()
                        component[member] = found
                        if member == node:
                            break
                    found += 1
    return component


def inside_components(component: Sequence[int], edges: Sequence[Edge]) -> list[Edge]:
    """The edges within components; no other one lies on a cycle."""
    return [edge for edge in edges if component[edge[0]] == component[edge[1]]]


def strict_cycles(component: Sequence[int], edges: Sequence[Edge]) -> list[Edge]:
    """One strict edge of each component that has one: it lies on a cycle that nothing satisfies."""
    cycles = {
        component[a]: (a, b, least)
        for a, b, least in edges
        if least and component[a] == component[b]
    }
    return list(cycles.values())


def successors(edges: Iterable[Edge]) -> dict[int, list[int]]:
    """For each node with edges, the nodes they lead to."""
    following: dict[int, list[int]] = {}
    for a, b, _ in edges:
        following.setdefault(a, []).append(b)
    return following


def shortest_path(source: int, target: int, following: Mapping[int, Sequence[int]]) -> list[int]:
    """The nodes from `source` to `target`, which must be reachable."""
    came_from = {source: source}
    queue = deque([source])
    while target not in came_from:
        node = queue.popleft()
        for other in following.get(node, ()):
            if other not in came_from:
                came_from[other] = node
                queue.append(other)
    path = [target]
    while path[-1] != source:
        path.append(came_from[path[-1]])
    return path[::-1]
