"""The model under construction: its variables, and the constraints that all elements share.

An activity has a start and, where its duration can vary, an end; an optional one has a literal.
Where there is state, every happening also has a rank, and `moment = time × ranks + rank` is one
integer that orders happenings (docs/semantics.md, rule 6).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from ortools.sat.python import cp_model

from irc.errors import IrcError
from irc.passes.serial_sgs import quick_schedule
from irc.problem import PLAIN, Activity, OpenDemand, Problem
from irc.problem.decisions import Decision
from irc.problem.horizon import safe_horizon, within

Hint = tuple[list[Decision], list[tuple[int, ...]]]
"""A list schedule: a decision for each activity, and the pool of each open demand."""

Literal = cp_model.IntVar
Expression = Any
"""A linear expression, a variable or a number."""

DemandLiterals = list[list[list[tuple[int, Literal]]]]
"""`[i][c]` lists, for open demand c of activity i, (pool, literal that takes it)."""


@dataclass
class ResourceUses:
    """The intervals that take from one pool, with their amounts, and whether each pauses."""

    intervals: list[cp_model.IntervalVar] = field(default_factory=list)
    amounts: list[int] = field(default_factory=list)
    pauses: list[bool] = field(default_factory=list)

    def add(self, interval: cp_model.IntervalVar, amount: int, pauses: bool = False) -> None:
        """Adds one interval."""
        self.intervals.append(interval)
        self.amounts.append(amount)
        self.pauses.append(pauses)

    @property
    def without_pauses(self) -> ResourceUses:
        """The uses that do not pause."""
        kept = [k for k, pauses in enumerate(self.pauses) if not pauses]
        return ResourceUses(
            [self.intervals[k] for k in kept], [self.amounts[k] for k in kept], [False] * len(kept)
        )


@dataclass(frozen=True)
class Taker:
    """A use of a resource with set-ups: the activity, the family, and the literal of the use.

    Without a `literal` the activity always uses the resource.
    """

    activity: int
    family: int
    literal: Literal | None


@dataclass(frozen=True)
class LoadTaker(Taker):
    """A use of a batch resource, with its amount."""

    amount: int


@dataclass
class Model:
    """A CP-SAT model and the variables that carry its answer.

    A demand with one alternative has no `literals`. `present[i]` is None where activity i is always
    present; `modes[i]` has a literal for each of its modes. `ranks[i]` are the variables of the
    ranks of its start and its end, None where there is no state. `values` are the expressions of
    the objectives.
    """

    model: cp_model.CpModel
    problem: Problem
    starts: list[cp_model.IntVar]
    ends: list[cp_model.IntVar | None]
    makespan: cp_model.IntVar
    literals: DemandLiterals
    sizes: dict[int, cp_model.IntVar]
    positive: dict[int, Literal]
    present: list[Literal | None]
    modes: list[list[Literal]]
    ranks: list[tuple[cp_model.IntVar, cp_model.IntVar] | None]
    values: dict[str, Expression]
    hint: Hint | None = None


class OutOfTimeError(IrcError):
    """The time was over before the model was complete."""


class Builder:
    """Holds the variables of a problem whose repeats are unrolled.

    `bounds` and `hints` add what the compiler already knows. `horizon` (ticks) replaces the one
    that the problem would be given, and `found` the list schedule. `is_over` says whether no time
    is left. The elements are added by `irc_cpsat.encoding.encode`.
    """

    def __init__(
        self,
        problem: Problem,
        bounds: bool,
        hints: bool,
        horizon: int | None = None,
        found: Hint | None = None,
    ) -> None:
        quick = problem.is_plain or problem.has_setups or problem.is_plain_but_loads
        if found is None and quick and (bounds or hints):
            found = quick_schedule(problem)
        by_makespan = (
            bounds and problem.objectives[:1] == ("makespan",) and not problem.previous.stability
        )
        self.is_over: Callable[[], bool] = lambda: False
        self.bounds = bounds
        self.hints = hints
        self.hint = found if hints else None
        self.model = cp_model.CpModel()
        self.ranked = problem.has_state
        self.rank_count = _rank_count(problem)
        self.safe_horizon = safe_horizon(problem) if horizon is None else horizon
        self.horizon = _tightened(
            self.safe_horizon, problem, found[0] if by_makespan and found else None
        )
        self.problem = within(problem, self.horizon)
        self.uses = [ResourceUses() for _ in problem.contention.pools]
        self.uses_in_moments = [ResourceUses() for _ in problem.contention.pools]
        self.takers: dict[int, list[Taker]] = {}
        self.sequences: list[Any] = []
        self.loads: dict[int, list[LoadTaker]] = {}
        self.batches: list[Any] = []
        self.starts: list[cp_model.IntVar] = []
        self.ends: list[cp_model.IntVar | None] = []
        self.sizes: dict[int, cp_model.IntVar] = {}
        self.positive: dict[int, Literal] = {}
        self.present: list[Literal | None] = []
        self.groups: list[Literal | None] = []
        self.modes: list[list[Literal]] = []
        self.ranks: list[tuple[cp_model.IntVar, cp_model.IntVar] | None] = []
        self.points: dict[tuple[int, bool], cp_model.IntVar] = {}
        self.conjunctions: dict[tuple[int, int], tuple[Literal, Literal, Literal]] = {}

    def check_time(self) -> None:
        """Raises `OutOfTimeError` where there is no time to go on."""
        if self.is_over():
            raise OutOfTimeError("the time was over before its model was complete")

    def end(self, i: int) -> Any:
        """The end of an activity, as an expression."""
        end = self.ends[i]
        return self.starts[i] + self.problem.activities[i].duration_min if end is None else end

    def moment(self, i: int, *, at_end: bool) -> Any:
        """time × ranks + rank of a happening; plain time where there are no ranks."""
        time = self.end(i) if at_end else self.starts[i]
        ranks = self.ranks[i] if self.ranked else None
        return time if ranks is None else time * self.rank_count + ranks[at_end]

    def point(self, i: int, *, at_end: bool) -> Any:
        """The moment of a happening as a variable and an offset: intervals take no more."""
        activity = self.problem.activities[i]
        if not self.ranked:
            return self.end(i) if at_end else self.starts[i]
        if at_end and activity.is_fixed:
            return self.point(i, at_end=False) + activity.duration_min * self.rank_count
        key = i, at_end
        if key not in self.points:
            reach = max(activity.duration_min, 0) + (activity.start or 0)
            latest = (2 * (self.horizon + 1) + reach) * self.rank_count
            self.points[key] = self.model.new_int_var(0, latest, "")
            self.model.add(self.points[key] == self.moment(i, at_end=at_end))
        return self.points[key]

    def enforced(self, constraint: Any, *whose: int, also: Sequence[Any] = ()) -> None:
        """Makes a constraint bind only where some activities (and other literals) are present."""
        literals = [p for i in whose if (p := self.present[i]) is not None]
        literals += also
        if literals:
            constraint.only_enforce_if(literals)

    def both(self, a: Literal, b: Literal) -> Literal:
        """A literal that is true where both are."""
        key = (min(a.index, b.index), max(a.index, b.index))
        if key not in self.conjunctions:
            both = self.model.new_bool_var("")
            self.model.add_bool_and(a, b).only_enforce_if(both)
            self.model.add_bool_or(~a, ~b, both)
            self.conjunctions[key] = both, a, b
        return self.conjunctions[key][0]

    def taking(
        self, i: int, demand: OpenDemand, r: int, *literals: Literal | None
    ) -> Literal | None:
        """A literal under which the open demand takes pool r; None where it always does."""
        together: Literal | None = None
        for literal in literals:
            if literal is not None:
                together = literal if together is None else self.both(literal, together)
        return together


def name_of(activity: Activity) -> str:
    """The name of an activity in variables: its id, and its number if it is a later occurrence."""
    if activity.details is PLAIN or activity.details.occurrence == 1:
        return activity.id
    return f"{activity.id} ({activity.details.occurrence})"


def _rank_count(problem: Problem) -> int:
    """The number of ranks that is enough: one for each happening that can have its own, behind
    those that are known."""
    if not problem.has_state:
        return 1
    known = [rank for a in problem.activities for rank in a.details.ranks or () if rank is not None]
    known += [a.details.not_before[1] for a in problem.activities if a.details.not_before]
    free = sum(1 if a.is_fixed else 2 for a in problem.activities)
    free += sum(1 for _ in problem.timed_changes)
    return 1 + free + max(known, default=0)


def _tightened(horizon: int, problem: Problem, known: Sequence[Decision] | None) -> int:
    """The horizon, no later than the end of a known schedule, no earlier than the bound."""
    if known is not None:
        horizon = min(horizon, max((int(d.end) for d in known), default=0))
    return max(horizon, problem.bounds.makespan.value)
