"""Finds conflicts of time alone: positive cycles of the temporal network, without a solver.

Every statement about time is a difference of two time points (`irc.problem.statements`). Statements
can hold together unless some of them form a cycle of positive length. Source: Dechter, Meiri,
Pearl, "Temporal constraint networks", AIJ 49 (1991).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from irc.explanation.minimise import Conflict, Possibility, Trial, minimise, narrow
from irc.problem import Problem
from irc.problem.statements import (
    ORIGIN,
    Difference,
    Kind,
    Statement,
    all_statements,
    differences_of,
    how_time_is,
)
from irc.problem.temporal_network import Network, earliest
from irc.targets import Budget

STEPS = 500_000
"""Limit on the constraints visited in the search for a cycle of few statements."""

ROOTS = 40
"""Limit on the points of a cycle from which the search starts."""

MINIMISING_SECONDS = 8.0
"""Limit on leaving out statements that are not needed; a conflict of thousands would take hours."""


def temporal_conflict(problem: Problem, budget: Budget) -> Conflict[Statement] | None:
    """A minimal set of statements that cannot hold together in time; None if there is none.

    Of several it is one with few statements, within the limit `STEPS`. After the end of the budget
    nothing more is left out, and the conflict may not be minimal.
    """
    differences = _graph(problem, all_statements(problem))
    cycles = _cycles(differences)
    if not cycles:
        return None
    budget = budget.at_most(MINIMISING_SECONDS)
    found = min(_candidates(differences, cycles), key=_Candidate.measure)
    statements = found.statements

    def attempt(statements: frozenset[Statement]) -> Trial[Statement]:
        if budget.is_over:
            return Trial(Possibility.UNKNOWN)
        cycles = _cycles(_graph(problem, statements))
        if not cycles:
            return Trial(Possibility.POSSIBLE)
        return Trial(Possibility.IMPOSSIBLE, frozenset(_stated(cycles[0])))

    if _is_minimal(problem, found):
        conflict = Conflict(tuple(sorted(statements)), minimal=True)
    else:
        order = sorted(statements, key=lambda s: _dispensable(problem, s))
        conflict = minimise(statements, attempt, order, budget=budget)
    return _in_order(problem, narrow(problem, conflict, attempt, budget))


@dataclass(frozen=True, slots=True)
class _Candidate:
    """A positive cycle; if it has a root, no positive cycle through it has fewer statements."""

    cycle: list[Difference]
    root: int | None = None

    @property
    def statements(self) -> frozenset[Statement]:
        return frozenset(_stated(self.cycle))

    def measure(self) -> tuple[int, bool, list[Statement]]:
        return len(self.statements), self.root is None, sorted(self.statements)


def _is_minimal(problem: Problem, found: _Candidate) -> bool:
    """Whether the search for few statements has already proven that each of them is needed.

    A positive cycle without one of them would be simple, lead through the root, and use each of the
    others at most once: two constraints of one statement in a simple cycle would be each other's
    reverse. So it would have fewer statements.
    """
    statements = found.statements
    if found.root is None or len(list(_stated(found.cycle))) > len(statements):
        return False
    elsewhere = [d for d in _graph(problem, statements) if found.root not in (d.src, d.dst)]
    return not _cycles(elsewhere)


def _in_order(problem: Problem, conflict: Conflict[Statement]) -> Conflict[Statement]:
    """The conflict with its statements in the order of the cycle, from t = 0 if it is on it."""
    cycle = _cycles(_graph(problem, conflict.statements))[0]
    first = next((k for k, d in enumerate(cycle) if d.src == ORIGIN), 0)
    ordered = dict.fromkeys(_stated([*cycle[first:], *cycle[:first]]))
    rest = tuple(s for s in conflict.statements if s not in ordered)
    excess = sum(d.weight for d in cycle)
    return replace(conflict, statements=(*ordered, *rest), excess=excess)


def _dispensable(problem: Problem, statement: Statement) -> tuple[int, int, Statement]:
    """A sort key: short durations first, so that fewer statements remain."""
    if statement.kind is Kind.DURATION:
        return 0, problem.activities[statement.of].duration_min, statement
    return 1, 0, statement


def _graph(problem: Problem, statements: Iterable[Statement]) -> list[Difference]:
    stated = differences_of(problem, sorted(statements))
    points = {p for d in stated for p in (d.src, d.dst) if p != ORIGIN}
    return [*stated, *how_time_is(sorted({(p - 1) // 2 for p in points}))]


def _cycles(differences: Sequence[Difference]) -> list[list[Difference]]:
    """One positive cycle for each part of the network that has one."""
    points = sorted({ORIGIN, *(p for d in differences for p in (d.src, d.dst))})
    place = {p: k for k, p in enumerate(points)}
    network = Network(len(points))
    for src, dst, weight, _ in differences:
        network.add(place[src], place[dst], weight)
    times = earliest(network, [0] * len(points))
    return [[differences[edge] for edge in cycle] for cycle in times.cycles]


def _stated(cycle: Iterable[Difference]) -> Iterator[Statement]:
    return (d.statement for d in cycle if d.statement is not None)


def _candidates(
    differences: Sequence[Difference], cycles: list[list[Difference]]
) -> Iterator[_Candidate]:
    """The cycles, and for points on them the positive cycle with the fewest statements."""
    search = _FewestStatements(differences)
    for cycle in cycles:
        yield _Candidate(cycle)
        on_cycle = dict.fromkeys(d.src for d in cycle)
        roots = [ORIGIN] if ORIGIN in on_cycle else list(on_cycle)[:ROOTS]
        for root in roots:
            shorter = search.cycle(root)
            if shorter is not None:
                yield _Candidate(shorter, root)


@dataclass(frozen=True, slots=True, eq=False)
class _Reached:
    """A longest path to a point with a given number of statements: its length and last step."""

    length: int
    point: int
    step: Difference | None = None
    before: _Reached | None = None


@dataclass
class _FewestStatements:
    """Longest paths in rounds, each with one statement more (Bellman 1958).

    Differences without a statement, such as that no duration is negative, do not count.
    """

    differences: Sequence[Difference]
    steps: int = STEPS
    leaving: dict[int, list[Difference]] = field(default_factory=dict)
    free: dict[int, list[Difference]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for d in self.differences:
            where = self.free if d.statement is None else self.leaving
            where.setdefault(d.src, []).append(d)

    def cycle(self, root: int) -> list[Difference] | None:
        """The positive cycle through `root` with the fewest statements; None if none is found."""
        best = {root: _Reached(0, root)}
        latest = self._freely(dict(best), best)
        while latest and self.steps > 0:
            found: dict[int, _Reached] = {}
            for reached in latest.values():
                for d in self.leaving.get(reached.point, ()):
                    self.steps -= 1
                    _improve(found, best, reached, d)
            best.update(found)
            latest = self._freely(found, best)
            if root in latest:
                return _way(latest[root])
        return None

    def _freely(self, found: dict[int, _Reached], best: dict[int, _Reached]) -> dict[int, _Reached]:
        waiting = list(found)
        while waiting:
            point = waiting.pop()
            for d in self.free.get(point, ()):
                self.steps -= 1
                if _improve(found, best, found[point], d):
                    best[d.dst] = found[d.dst]
                    waiting.append(d.dst)
        return found


def _improve(
    found: dict[int, _Reached], best: dict[int, _Reached], reached: _Reached, d: Difference
) -> bool:
    length = reached.length + d.weight
    for known in (found.get(d.dst), best.get(d.dst)):
        if known is not None and known.length >= length:
            return False
    found[d.dst] = _Reached(length, d.dst, d, reached)
    return True


def _way(reached: _Reached) -> list[Difference]:
    steps: list[Difference] = []
    while reached.step is not None and reached.before is not None:
        steps.append(reached.step)
        reached = reached.before
    return steps[::-1]
