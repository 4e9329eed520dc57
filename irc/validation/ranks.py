"""The search for ranks where a schedule gives none.

Every demand on ranks is an edge: rank(b) ≥ rank(a) + 0 or 1. Ranks exist iff the edges of some
order of each knot (see `irc.validation.knots`) close no cycle with a 1 in it.

1. Durations, tight precedences and the knots with one answer give edges at once; a cycle among
   these is final. Where the order of writers is known, slots that these edges rule out are dropped,
   until nothing changes. This is near linear, and all that most schedules need.
2. A cycle stays inside a strongly connected component of the graph of all *possible* edges. So
   knots that share neither a component nor a value are independent puzzles, solved smallest first.
3. A puzzle is searched depth first with exact backtracking: the next writer, then a slot for each
   item, the narrowest first. Ranks that satisfy all edges so far are kept up to date (starting from
   a topological order), so an impossible edge is seen when it is added.

The question is NP-hard (orders of simultaneous changes), so the search is bounded: by
`SEARCH_STEPS` edge relaxations and `STEPS_PER_OCCURRENCE` more for each occurrence. Beyond, what is
left is reported as undecided.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from irc.validation.happenings import Edge, Edges, Story, Value, timing_edges
from irc.validation.knots import OPEN, Knot, Writer, slots, untangle
from irc.validation.rank_graph import (
    Budget,
    OutOfSteps,
    RankGraph,
    inside_components,
    shortest_path,
    strict_cycles,
    strong_components,
    successors,
)
from irc.validation.subject import Subject
from irc.validation.verdict import Violations, listed

SEARCH_STEPS = 1_000_000
STEPS_PER_OCCURRENCE = 100
"""A million steps take a second or two."""


def find_ranks(
    subject: Subject, story: Story, budget: Budget, violations: Violations
) -> list[int] | None:
    """Ranks under which state and precedences hold, or None and the reasons why there are none."""
    tangle = untangle(subject, story, violations)
    edges = [*timing_edges(subject, story), *tangle.edges]
    components = strong_components(story.node_count, edges)
    cycles = strict_cycles(components, edges)
    if cycles:
        _add_cycles(subject, story, inside_components(components, edges), cycles, violations)
        return None
    # Edges never lead to a higher component, and equal ones are tied: a topological order.
    graph = RankGraph([-component for component in components], edges, budget)
    search = _Search(graph, _narrow(graph, tangle.knots), edges)
    for puzzle in search.puzzles:
        outcome = search.solve(puzzle)
        if outcome is not True:
            knots = [search.knots[i] for i in puzzle]
            _add_unsolved(knots, outcome is None, violations)
    return None if violations else graph.ranks


def _narrow(graph: RankGraph, knots: Sequence[Knot]) -> list[Knot]:
    """Settles the items that have one possible slot left; one that has none is left to fail."""
    left = list(knots)
    try:
        while True:
            narrower = [_narrowed(graph, knot) for knot in left]
            settled = sum(len(a.items) - len(b.items) for a, b in zip(left, narrower, strict=True))
            left = narrower
            if not settled:
                return left
    except OutOfSteps:
        return left


def _narrowed(graph: RankGraph, knot: Knot) -> Knot:
    if knot.incoming is OPEN or len(knot.writers) > 1:
        return knot
    items = []
    for item in knot.items:
        options = [o for o in slots(item, knot.writers, knot.incoming) if graph.allows(o)]
        if len(options) == 1:
            graph.add(options[0])
        else:
            items.append(item)
    return knot if len(items) == len(knot.items) else replace(knot, items=tuple(items))


class _State(NamedTuple):
    """How far a puzzle is solved: its `at`-th knot, the order of writers so far, and, once that is
    complete, the options of each item, of which the first `placed` are chosen."""

    at: int = 0
    order: tuple[Writer, ...] = ()
    plans: tuple[list[Edges], ...] | None = None
    placed: int = 0


_Choices = Iterator[tuple[Edges, _State]]


class _Search:
    """Solves the knots that are left over, one independent puzzle at a time."""

    def __init__(self, graph: RankGraph, knots: Sequence[Knot], edges: Sequence[Edge]) -> None:
        self.graph = graph
        self.knots = knots
        self.last: dict[int, Value] = {}
        self.puzzles: list[list[int]] = []
        if not all(knot.is_settled for knot in knots):
            given = [*edges, *graph.added]
            component = strong_components(*_with_possible_edges(len(graph.ranks), given, knots))
            self.puzzles = _puzzles(knots, component)

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

    def _incoming(self, knot: Knot) -> Value:
        if knot.incoming is not OPEN:
            return knot.incoming
        return self.last[knot.previous] if knot.previous is not None else None

    def _advance(self, puzzle: Sequence[int], state: _State) -> _State | None:
        """The next state in which something is to be chosen; None when all is."""
        while state.at < len(puzzle):
            knot = self.knots[puzzle[state.at]]
            if len(state.order) < len(knot.writers):
                return state
            incoming = self._incoming(knot)
            last = state.order[-1].value if state.order else incoming
            if state.plans is None:
                plans = [slots(item, state.order, incoming) for item in knot.items]
                if any(goal != last for goal in knot.goals):
                    plans.append([])
                state = state._replace(plans=tuple(sorted(plans, key=len)))
            if state.plans is not None and state.placed < len(state.plans):
                return state
            self.last[puzzle[state.at]] = last
            state = _State(state.at + 1)
        return None

    def _choices(self, puzzle: Sequence[int], state: _State) -> _Choices:
        if state.plans is None:
            return self._writers(self.knots[puzzle[state.at]], state)
        return self._slots(state.plans[state.placed], state)

    def _slots(self, options: list[Edges], state: _State) -> _Choices:
        following = state._replace(placed=state.placed + 1)
        for edges in sorted(options, key=self.graph.unmet):
            yield edges, following

    def _writers(self, knot: Knot, state: _State) -> _Choices:
        ranks, order = self.graph.ranks, state.order
        if not order and _is_hopeless(knot, self._incoming(knot)):
            return
        value = order[-1].value if order else self._incoming(knot)
        placed = {writer.happening.node for writer in order}
        left = [writer for writer in knot.writers if writer.happening.node not in placed]
        waiting = {writer.happening.node for writer in left}
        self.graph.budget.charge(len(left))
        for writer in sorted(left, key=lambda w: ranks[w.happening.node]):
            node = writer.happening.node
            if any(need != value for need in writer.needs):
                continue
            if self.graph.follows_any(node, waiting):
                continue
            edges: Edges = ((order[-1].happening.node, node, 1),) if order else ()
            yield edges, state._replace(order=(*order, writer))


def _is_hopeless(knot: Knot, incoming: Value) -> bool:
    """Whether a value is needed that never occurs, so that no order need be tried."""
    given: set[Value] = {writer.value for writer in knot.writers}
    ever = given | {incoming}
    needed = [need for writer in knot.writers for need in writer.needs]
    needed += [item.value for item in knot.items if item.kind != "close"]
    return not ever.issuperset(needed) or not given.issuperset(knot.goals)


def _with_possible_edges(
    count: int, edges: Sequence[Edge], knots: Sequence[Knot]
) -> tuple[int, list[Edge]]:
    """The graph with a hub per knot, through which all its happenings reach each other."""
    possible = list(edges)
    for knot in knots:
        if not knot.writers or knot.is_settled:
            continue
        for happening in knot.happenings():
            possible += [(happening.node, count, 0), (count, happening.node, 0)]
        count += 1
    return count, possible


def _puzzles(knots: Sequence[Knot], component: Sequence[int]) -> list[list[int]]:
    """The knots by what they have to do with each other, in the order of time; smallest first."""
    parent = list(range(len(knots)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    in_component: dict[int, int] = {}
    for i, knot in enumerate(knots):
        if knot.previous is not None:
            parent[root(i)] = root(knot.previous)
        if knot.writers:
            # All happenings of a knot with writers are in one component.
            home = component[knot.writers[0].happening.node]
            parent[root(i)] = root(in_component.setdefault(home, i))
    puzzles: dict[int, list[int]] = {}
    for i, knot in enumerate(knots):
        if not knot.is_settled:
            puzzles.setdefault(root(i), []).append(i)
    ordered = [sorted(puzzle, key=lambda i: (knots[i].time, i)) for puzzle in puzzles.values()]
    return sorted(ordered, key=len)


def _add_cycles(
    subject: Subject,
    story: Story,
    edges: Sequence[Edge],
    cycles: Sequence[Edge],
    violations: Violations,
) -> None:
    owner: dict[int, int] = {}
    for number, nodes in enumerate(story.nodes):
        owner.update(dict.fromkeys(nodes, number))
    following = successors(edges)
    for first, second, _ in cycles:
        circle = shortest_path(second, first, following)
        members = [subject.occurrences[owner[node]] for node in circle]
        names = list(dict.fromkeys(member.entry.id for member in members))
        violations.add(
            "rank",
            f"no ranks exist: {listed(names, len(names))} would have to come "
            "one after the other in a circle",
            names,
            sorted({member.start for member in members}),
        )


def _add_unsolved(knots: Sequence[Knot], undecided: bool, violations: Violations) -> None:
    names = list(dict.fromkeys(h.occurrence.entry.id for knot in knots for h in knot.happenings()))
    variables = list(dict.fromkeys(knot.variable for knot in knots))
    times = list(dict.fromkeys(knot.time for knot in knots))
    where = f"{listed(names, len(names))} at {violations.time(times[0])}"
    if len(times) > 1:
        where += f" and {len(times) - 1} later instants"
    about = listed(variables, len(variables))
    if undecided:
        message = f"whether some order of {where} suits {about} is too hard to decide; give ranks"
    else:
        message = f"no order of {where} suits {about}"
    violations.add("undecided" if undecided else "rank", message, names, times)
