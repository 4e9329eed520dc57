"""The search for ranks where a schedule gives none.

Every demand on ranks is an edge: rank(b) ≥ rank(a) + 0 or 1. Ranks exist iff the edges of some
order of each cluster (see `irc.validation.simultaneous`, and for resources and stock
`irc.validation.level_clusters`) close no cycle with a 1 in it.

1. Durations, tight precedences and the clusters with one answer give edges at once; a cycle among
   these is final. Where the order of writers is known, slots that these edges rule out are dropped,
   until nothing changes. This is near linear, and all that most schedules need.
2. A cycle stays inside a strongly connected component of the graph of all *possible* edges. So
   clusters that share neither a component nor a value are independent puzzles, the smallest first.
3. A puzzle is searched depth first with exact backtracking: the next writer, then a slot for each
   item, the narrowest first. Ranks that satisfy all edges so far are kept up to date (starting from
   a topological order), so an impossible edge is seen when it is added. Happenings that change
   levels are ordered one by one, as far as the levels allow.

The question is NP-hard (orders of simultaneous changes), so the search is bounded: by
`SEARCH_STEPS` edge relaxations and `STEPS_PER_OCCURRENCE` more for each occurrence. Clusters that
are left then are reported as undecided.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from irc.validation.bound_schedule import BoundSchedule
from irc.validation.happenings import Edge, Edges, Timelines, timing_edges
from irc.validation.level_clusters import LevelCluster, level_clusters
from irc.validation.levels import NumberChange, Value, changed, meets
from irc.validation.loads import load_edges
from irc.validation.past_first import past_first_pairs
from irc.validation.rank_graph import (
    OutOfSteps,
    RankGraph,
    StepBudget,
    inside_components,
    shortest_path,
    strict_cycles,
    strong_components,
    successors,
)
from irc.validation.simultaneous import OPEN, Cluster, Writer, rank_constraints, slots
from irc.validation.verdict import Violations, listed

SEARCH_STEPS = 1_000_000
STEPS_PER_OCCURRENCE = 100
"""A million steps take a second or two."""


def find_ranks(
    bound: BoundSchedule, timelines: Timelines, budget: StepBudget, violations: Violations
) -> list[int] | None:
    """Ranks under which state and precedences hold; None, with violations, where there are none."""
    constraints = rank_constraints(bound, timelines, violations)
    count, past_first = _past_first_edges(bound, timelines)
    needed, levels = level_clusters(bound, timelines)
    count, loads = load_edges(bound, timelines, count)
    edges = [*loads, *timing_edges(bound, timelines), *past_first, *needed, *constraints.edges]
    components = strong_components(count, edges)
    cycles = strict_cycles(components, edges)
    if cycles:
        _add_cycles(bound, timelines, inside_components(components, edges), cycles, violations)
        return None
    # Edges never lead to a higher component, and equal ones are tied: a topological order.
    graph = RankGraph([-component for component in components], edges, budget)
    search = _RankSearch(graph, [*_narrow(graph, constraints.clusters), *levels], edges)
    for puzzle in search.puzzles:
        outcome = search.solve(puzzle)
        if outcome is not True:
            clusters = [search.clusters[i] for i in puzzle]
            _add_unsolved(clusters, outcome is None, violations)
    return None if violations else _from_zero(graph.ranks[: timelines.node_count])


def _from_zero(ranks: Sequence[int]) -> list[int]:
    """The same order of ranks, the least of them 0."""
    least = min(ranks, default=0)
    return [rank - least for rank in ranks]


def _past_first_edges(bound: BoundSchedule, timelines: Timelines) -> tuple[int, list[Edge]]:
    """The number of nodes, and the edges at events' instants, each through a node of its own."""
    count, edges = timelines.node_count, []
    for earlier, later in past_first_pairs(bound):
        edges += [(timelines.nodes[o.number][at_end], count, 0) for o, at_end in earlier]
        edges += [(count, timelines.nodes[o.number][at_end], 0) for o, at_end in later]
        count += 1
    return count, edges


_AnyCluster = Cluster | LevelCluster


def _narrow(graph: RankGraph, clusters: Sequence[Cluster]) -> list[Cluster]:
    """Places the items that have one possible slot left; the search fails on one that has none."""
    left = list(clusters)
    try:
        while True:
            narrower = [_narrowed(graph, cluster) for cluster in left]
            placed = sum(len(a.items) - len(b.items) for a, b in zip(left, narrower, strict=True))
            left = narrower
            if not placed:
                return left
    except OutOfSteps:
        return left


def _narrowed(graph: RankGraph, cluster: Cluster) -> Cluster:
    if cluster.incoming is OPEN or len(cluster.writers) > 1:
        return cluster
    items = []
    for item in cluster.items:
        options = [o for o in slots(item, cluster.writers, cluster.incoming) if graph.allows(o)]
        if len(options) == 1:
            graph.add(options[0])
        else:
            items.append(item)
    return cluster if len(items) == len(cluster.items) else replace(cluster, items=tuple(items))


class _State(NamedTuple):
    """A partial solution of a puzzle: its `at`-th cluster and the order of writers so far.

    Once that order is complete, `plans` are the options of each item, of which the first `placed`
    are chosen. Where levels change, `queue` is the order of parties so far, by number.
    """

    at: int = 0
    order: tuple[Writer, ...] = ()
    queue: tuple[int, ...] = ()
    plans: tuple[list[Edges], ...] | None = None
    placed: int = 0


_Choices = Iterator[tuple[Edges, _State]]


class _RankSearch:
    """Solves the clusters that are left over, one independent puzzle at a time."""

    def __init__(
        self, graph: RankGraph, clusters: Sequence[_AnyCluster], edges: Sequence[Edge]
    ) -> None:
        self.graph = graph
        self.clusters = clusters
        self.last: dict[int, Value] = {}
        self.puzzles: list[list[int]] = []
        if not all(_is_decided(cluster) for cluster in clusters):
            given = [*edges, *graph.added]
            component = strong_components(*_with_possible_edges(len(graph.ranks), given, clusters))
            self.puzzles = _puzzles(clusters, component)

    def solve(self, puzzle: Sequence[int]) -> bool | None:
        """Whether the puzzle has a solution, which then stays in `graph`; None if undecided."""
        start = self.graph.mark()
        try:
            if self._solve(puzzle):
                return True
        except OutOfSteps:
            self.graph.undo(start)
            return None
        self.graph.undo(start)
        return False

    def _solve(self, puzzle: Sequence[int]) -> bool:
        state = self._advance(puzzle, _State())
        if state is None:
            return True
        frames = [(self._choices(puzzle, state), self.graph.mark())]
        while frames:
            choices, mark = frames[-1]
            self.graph.undo(mark)
            choice = next(choices, None)
            if choice is None:
                frames.pop()
                continue
            edges, chosen = choice
            if not self.graph.add(edges):
                continue
            state = self._advance(puzzle, chosen)
            if state is None:
                return True
            frames.append((self._choices(puzzle, state), self.graph.mark()))
        return False

    def _incoming(self, cluster: Cluster) -> Value:
        if cluster.incoming is not OPEN:
            return cluster.incoming
        return self.last[cluster.previous] if cluster.previous is not None else None

    def _advance(self, puzzle: Sequence[int], state: _State) -> _State | None:
        """The next state with a choice to make; None when all choices are made."""
        while state.at < len(puzzle):
            cluster = self.clusters[puzzle[state.at]]
            if isinstance(cluster, LevelCluster):
                if len(state.queue) < len(cluster.parties):
                    return state
                state = _State(state.at + 1)
                continue
            if len(state.order) < len(cluster.writers):
                return state
            incoming = self._incoming(cluster)
            last = _after(state.order, incoming)
            if state.plans is None:
                plans = [slots(item, state.order, incoming) for item in cluster.items]
                if not all(meets(last, goal) for goal in cluster.goals):
                    plans.append([])
                state = state._replace(plans=tuple(sorted(plans, key=len)))
            if state.plans is not None and state.placed < len(state.plans):
                return state
            self.last[puzzle[state.at]] = last
            state = _State(state.at + 1)
        return None

    def _choices(self, puzzle: Sequence[int], state: _State) -> _Choices:
        cluster = self.clusters[puzzle[state.at]]
        if isinstance(cluster, LevelCluster):
            return self._parties(cluster, state)
        if state.plans is None:
            return self._writers(cluster, state)
        return self._slots(state.plans[state.placed], state)

    def _slots(self, options: list[Edges], state: _State) -> _Choices:
        following = state._replace(placed=state.placed + 1)
        for edges in sorted(options, key=self.graph.unmet):
            yield edges, following

    def _parties(self, cluster: LevelCluster, state: _State) -> _Choices:
        """The possible next parties: by their ranks so far, and producers before consumers."""
        nodes = [party.happening.node for party in cluster.parties]
        left = [k for k in range(len(nodes)) if k not in state.queue]
        self.graph.budget.charge(len(nodes))
        gains = [sum(amount for _, amount in party.changes) for party in cluster.parties]
        for k in sorted(left, key=lambda k: (self.graph.ranks[nodes[k]], -gains[k])):
            if cluster.allows(state.queue, k):
                edges: Edges = ((nodes[state.queue[-1]], nodes[k], 0),) if state.queue else ()
                yield edges, state._replace(queue=(*state.queue, k))

    def _writers(self, cluster: Cluster, state: _State) -> _Choices:
        ranks, order = self.graph.ranks, state.order
        if not order and _is_hopeless(cluster, self._incoming(cluster)):
            return
        value = _after(order, self._incoming(cluster))
        placed = {writer.happening.node for writer in order}
        left = [writer for writer in cluster.writers if writer.happening.node not in placed]
        waiting = {writer.happening.node for writer in left}
        self.graph.budget.charge(len(left))
        for writer in sorted(left, key=lambda w: ranks[w.happening.node]):
            node = writer.happening.node
            if not all(meets(value, need) for need in writer.needs):
                continue
            if cluster.always:
                self.graph.budget.charge(1)
                given = changed(value, writer.change)
                if not all(meets(given, need) for need in cluster.always):
                    continue
            if self.graph.follows_any(node, waiting):
                continue
            edges: Edges = ((order[-1].happening.node, node, 1),) if order else ()
            yield edges, state._replace(order=(*order, writer))


def _after(order: Sequence[Writer], value: Value) -> Value:
    """The value after some writers."""
    if order and not isinstance(order[-1].change, NumberChange):
        return order[-1].change
    for writer in order:
        value = changed(value, writer.change)
    return value


def _is_hopeless(cluster: Cluster, incoming: Value) -> bool:
    """Whether a needed value never occurs, so that no order need be tried."""
    if any(isinstance(writer.change, NumberChange) for writer in cluster.writers):
        return False
    given = {writer.change for writer in cluster.writers}
    ever = given | {incoming}
    needed = [need for writer in cluster.writers for need in writer.needs]
    needed += [item.need for item in cluster.items if item.kind != "close"]
    return not ever.issuperset(needed) or not given.issuperset(cluster.goals)


def _with_possible_edges(
    count: int, edges: Sequence[Edge], clusters: Sequence[_AnyCluster]
) -> tuple[int, list[Edge]]:
    """The graph with a hub per cluster, through which all its happenings reach each other."""
    possible = list(edges)
    for cluster in clusters:
        if _first_node(cluster) is None or _is_decided(cluster):
            continue
        for happening in cluster.happenings():
            possible += [(happening.node, count, 0), (count, happening.node, 0)]
        count += 1
    return count, possible


def _is_decided(cluster: _AnyCluster) -> bool:
    return isinstance(cluster, Cluster) and cluster.is_decided


def _first_node(cluster: _AnyCluster) -> int | None:
    """The node of one happening that all others of the cluster are compared with."""
    if isinstance(cluster, LevelCluster):
        return cluster.parties[0].happening.node
    return cluster.writers[0].happening.node if cluster.writers else None


def _puzzles(clusters: Sequence[_AnyCluster], component: Sequence[int]) -> list[list[int]]:
    """The clusters that depend on each other, in the order of time; the smallest puzzle first."""
    parent = list(range(len(clusters)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    in_component: dict[int, int] = {}
    for i, cluster in enumerate(clusters):
        if isinstance(cluster, Cluster) and cluster.previous is not None:
            parent[root(i)] = root(cluster.previous)
        node = _first_node(cluster)
        if node is not None:
            # All happenings of a cluster with writers, or parties, are in one component.
            parent[root(i)] = root(in_component.setdefault(component[node], i))
    puzzles: dict[int, list[int]] = {}
    for i, cluster in enumerate(clusters):
        if not _is_decided(cluster):
            puzzles.setdefault(root(i), []).append(i)
    ordered = [sorted(puzzle, key=lambda i: (clusters[i].time, i)) for puzzle in puzzles.values()]
    return sorted(ordered, key=len)


def _add_cycles(
    bound: BoundSchedule,
    timelines: Timelines,
    edges: Sequence[Edge],
    cycles: Sequence[Edge],
    violations: Violations,
) -> None:
    owner: dict[int, int] = {}
    for number, nodes in enumerate(timelines.nodes):
        owner.update(dict.fromkeys(nodes, number))
    following = successors(edges)
    for first, second, _ in cycles:
        circle = shortest_path(second, first, following)
        members = [bound.happening[owner[node]] for node in circle if node in owner]
        names = list(dict.fromkeys(member.entry.id for member in members))
        violations.add(
            "rank",
            f"no ranks exist: {listed(names, len(names))} must come "
            "one after the other, in a circle",
            names,
            sorted({member.start for member in members}),
        )


def _add_unsolved(clusters: Sequence[_AnyCluster], undecided: bool, violations: Violations) -> None:
    happenings = [happening for cluster in clusters for happening in cluster.happenings()]
    names = list(dict.fromkeys(h.occurrence.entry.id for h in happenings))
    concerned = [
        name
        for cluster in clusters
        for name in (cluster.names if isinstance(cluster, LevelCluster) else (cluster.variable,))
    ]
    concerned = list(dict.fromkeys(concerned))
    times = list(dict.fromkeys(cluster.time for cluster in clusters))
    where = f"{listed(names, len(names))} at {violations.time(times[0])}"
    if len(times) > 1:
        where += f" and {len(times) - 1} later instant{'s' if len(times) > 2 else ''}"
    about = listed(concerned, len(concerned))
    if undecided:
        message = f"whether some order of {where} suits {about} is too hard to decide; give ranks"
    else:
        message = f"no order of {where} suits {about}"
    violations.add("undecided" if undecided else "rank", message, names, times)
