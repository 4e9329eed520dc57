"""Finds conflicts over resources: a solver's core, made minimal by leaving statements out.

The core comes from a model without an objective and with one assumption for each statement
(google/or-tools#3943: otherwise it is not exact). It is checked (google/or-tools#5141): a set is
impossible if a bound, or the solver without assumptions, refutes it as a problem of its own, and
possible if there is a schedule, made by a rule or by the solver and re-timed exactly. At the end
the solver alone refutes the remaining set once more.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from irc.explanation.minimise import Conflict, Possibility, Trial, minimise, narrow
from irc.passes import bound_with_setups
from irc.passes.contention import drop_uncontended, merge_pools
from irc.passes.critical_path import heads_and_tails
from irc.passes.energy import energy_bound
from irc.passes.serial_sgs import quick_schedule
from irc.problem import Activity, OpenDemand, Problem
from irc.problem.horizon import safe_horizon
from irc.problem.statements import (
    Kind,
    Statement,
    all_statements,
    differences_of,
    end_point,
    problem_of,
)
from irc.schedule import Status
from irc.targets import Budget, EngineFailed
from irc.targets.refuter import Assumptions, Refuter

_ORDER = (
    Kind.USE,
    Kind.DURATION,
    Kind.PRECEDENCE,
    Kind.RELEASE,
    Kind.DEADLINE,
    Kind.LATEST_START,
    Kind.EARLIEST_END,
    Kind.START,
    Kind.GROUP_DEADLINE,
    Kind.TASK_DEADLINE,
    Kind.NO_IDLE,
    Kind.SETUPS,
    Kind.CAPACITY,
)

_OF_RESOURCE = frozenset((Kind.CAPACITY, Kind.SETUPS, Kind.NO_IDLE))
"""The order of leaving out: deadlines and capacities, which authors set, are kept longest."""

_OF_ACTION = (
    *(Kind.DURATION, Kind.USE, Kind.RELEASE),
    *(Kind.DEADLINE, Kind.LATEST_START, Kind.EARLIEST_END, Kind.START),
)


def resource_conflict(
    problem: Problem, refuter: Refuter, budget: Budget
) -> Conflict[Statement] | None:
    """A minimal conflict of a problem that has no schedule, although time alone allows one.

    None if the budget is over at the start; if it ends during the search, the conflict may not be
    minimal. The caller must have proven that the problem has no schedule.
    """
    return _Search(problem, refuter, budget).conflict()


def horizon_without_limits(problem: Problem) -> int:
    """An upper bound on the end of some schedule of each feasible subset of the statements."""
    return max(1, safe_horizon(replace(problem, deadline=None)))


@dataclass
class _Search:
    problem: Problem
    refuter: Refuter
    budget: Budget
    known: dict[frozenset[Statement], Trial[Statement]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.horizon = horizon_without_limits(self.problem)

    def conflict(self) -> Conflict[Statement] | None:
        found = self._found()
        if found is None:
            return None
        order = sorted(found, key=self._dispensable)
        implied = self._implied(found)
        conflict = minimise(found, self.attempt, order, self._families(found), implied)
        return narrow(self.problem, self._rechecked(conflict), self.attempt)

    def _found(self) -> frozenset[Statement] | None:
        """The set to minimise: the solver's core if it is confirmed, else all statements."""
        if self.budget.is_over:
            return None
        statements = frozenset(self._relevant())
        if not _refuted_by_energy(self._part(statements)):
            core = self.refuter.core(self._assumptions(statements), self.budget)
            if core is not None and self.attempt(core).result is Possibility.IMPOSSIBLE:
                return core
        return statements

    def _rechecked(self, conflict: Conflict[Statement]) -> Conflict[Statement]:
        """The conflict, minimal only if the solver alone also finds it impossible."""
        part = self._part(frozenset(conflict.statements))
        status = self.refuter.decide(part, self.horizon, self.budget)
        if status is Status.FEASIBLE:
            raise EngineFailed("a conflict turned out to have a schedule; this is a defect of irc")
        return replace(conflict, minimal=conflict.minimal and status is Status.INFEASIBLE)

    def attempt(self, statements: frozenset[Statement]) -> Trial[Statement]:
        """Whether these statements can hold together, decided on a problem of their own."""
        trial = self.known.get(statements)
        if trial is None:
            trial = self.known[statements] = Trial(self._possibility(statements))
        return trial

    def _part(self, statements: frozenset[Statement]) -> Problem:
        """The problem of some statements, without resources that have no contention."""
        part = problem_of(self.problem, statements, self.horizon)
        return heads_and_tails(drop_uncontended(merge_pools(part)))

    def _possibility(self, statements: frozenset[Statement]) -> Possibility:
        """Decides by bounds and quick schedules first: most sets need no solver."""
        if self.budget.is_over:
            return Possibility.UNKNOWN
        part = self._part(statements)
        if not part.has_contention:
            return Possibility.POSSIBLE  # All statements together have no conflict of time.
        if _refuted_by_energy(part):
            return Possibility.IMPOSSIBLE
        if quick_schedule(part) is not None:
            return Possibility.POSSIBLE
        status = self.refuter.decide(part, self.horizon, self.budget)
        if status is Status.UNKNOWN and _refuted_by_cases(part):
            return Possibility.IMPOSSIBLE
        return {
            Status.FEASIBLE: Possibility.POSSIBLE,
            Status.INFEASIBLE: Possibility.IMPOSSIBLE,
        }.get(status, Possibility.UNKNOWN)

    def _relevant(self) -> list[Statement]:
        """The statements without those about resources that have no contention.

        If all statements are in conflict, so are these: such a resource never restricts a schedule.
        """
        contended = drop_uncontended(merge_pools(self.problem))
        uses = {(i, d.use) for i, a in enumerate(contended.activities) for d in a.open_demands}
        resources = {r for i, u in uses for r in self.problem.activities[i].uses[u].alternatives}
        return [
            s
            for s in all_statements(self.problem)
            if (s.kind is not Kind.USE or (s.of, s.use) in uses)
            and (s.kind not in _OF_RESOURCE or s.of in resources)
        ]

    def _assumptions(self, statements: frozenset[Statement]) -> Assumptions:
        uses = {(s.of, s.use): s for s in sorted(statements) if s.kind is Kind.USE}
        demands: dict[int, list[OpenDemand]] = {}
        for i, u in uses:
            of = self.problem.activities[i].uses[u]
            demands.setdefault(i, []).append(OpenDemand(u, of.alternatives, of.amount))
        bare = replace(
            self.problem,
            activities=tuple(
                Activity(a.id, 0, self.horizon, uses=a.uses, open_demands=tuple(demands.get(i, ())))
                for i, a in enumerate(self.problem.activities)
            ),
            # (Set-ups are no assumptions: a core that needs them is found without one.)
            resources=tuple(replace(r, setups=None) for r in self.problem.resources),
            arcs=(),
            deadline=None,
        )
        return Assumptions(
            merge_pools(bare),
            differences_of(self.problem, sorted(statements)),
            uses,
            {s.of: s for s in sorted(statements) if s.kind is Kind.CAPACITY},
            self.horizon,
        )

    def _dispensable(self, statement: Statement) -> tuple[int, int, Statement]:
        """A sort key: statements about short actions first, so that fewer statements remain."""
        rank = _ORDER.index(statement.kind)
        if statement.kind in (Kind.DURATION, Kind.USE):
            return rank, self._length(statement.of), statement
        return rank, 0, statement

    def _length(self, activity: int) -> int:
        return self.problem.activities[activity].duration_min

    def _implied(self, found: frozenset[Statement]) -> dict[Statement, Statement]:
        """Uses, each with the duration that is needed if the use is needed.

        Take a schedule that is possible without the use, and let the action take no time: then it
        uses nothing, and its earlier end breaks no statement, unless one keeps the end late.
        """
        kept_late = {
            d.dst
            for d in differences_of(self.problem, found)
            if d.statement is not None and d.statement.kind is not Kind.DURATION
        }
        return {
            s: duration
            for s in found
            if s.kind is Kind.USE and end_point(s.of) not in kept_late
            for duration in (Statement(Kind.DURATION, s.of),)
            if duration in found
        }

    def _families(self, found: frozenset[Statement]) -> list[list[frozenset[Statement]]]:
        """Groups that can often be left out together: by resource, precedences, and by action.

        (Sets of statements have no fixed order, so `found` is sorted.)
        """
        of_resource: dict[int, set[Statement]] = {}
        of_action: dict[int, set[Statement]] = {}
        arcs = []
        for s in sorted(found):
            if s.kind in _OF_RESOURCE:
                of_resource.setdefault(s.of, set()).add(s)
            elif s.kind is Kind.PRECEDENCE:
                arcs.append(frozenset((s,)))
            elif s.kind in _OF_ACTION:
                of_action.setdefault(s.of, set()).add(s)
            if s.kind is Kind.USE:
                for r in self.problem.activities[s.of].uses[s.use].alternatives:
                    of_resource.setdefault(r, set()).add(s)
        by_length = sorted(of_action, key=lambda i: (self._length(i), i))
        return [
            [frozenset(of_resource[r]) for r in sorted(of_resource)],
            arcs,
            [frozenset(of_action[i]) for i in by_length],
        ]


def _refuted_by_energy(part: Problem) -> bool:
    if part.deadline is None:
        return False
    return bound_with_setups(energy_bound(part)).bounds.makespan.value > part.deadline


def _refuted_by_cases(part: Problem) -> bool:
    """Whether the destructive bound refutes a problem; it takes longer than the energy bound."""
    if part.deadline is None:
        return False
    from irc.passes.destructive import destructive_bound

    return destructive_bound(energy_bound(part)).bounds.makespan.value > part.deadline
