"""`Problem` → CP-SAT model.

An activity is an interval; a resource of which only one claim fits at a time is a
`NoOverlap`, any other a `Cumulative`; a choice is one optional interval for each alternative.
An interval of size 0 must not be seen by `NoOverlap` (it would break inside another), so what
may have no length is optional there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ortools.sat.python import cp_model

from irc.backend import Refusal
from irc.horizon import safe_horizon
from irc.list_schedule import list_schedule
from irc.problem import Activity, Claim, Problem
from irc.retime import Decision

MODEL_FILE = "model.pbtxt"

_MAX_SUM = 2**62
"""CP-SAT computes sums in 64-bit integers; a model that comes near is refused."""

Hint = tuple[list[Decision], list[tuple[int, ...]]]
"""A list schedule: a decision for each activity, and the shared resource of each claim."""

Moment = cp_model.LinearExpr | cp_model.IntVar


@dataclass
class _Users:
    """The intervals that claim one shared resource, with their amounts."""

    intervals: list[cp_model.IntervalVar] = field(default_factory=list)
    amounts: list[int] = field(default_factory=list)


@dataclass
class Model:
    """A CP-SAT model and the variables that carry its answer.

    `literals[i][c]` lists, for claim c of activity i, (shared resource, literal that takes it);
    a claim with one alternative has no literals.
    """

    model: cp_model.CpModel
    starts: list[cp_model.IntVar]
    ends: list[cp_model.IntVar | None]
    makespan: cp_model.IntVar
    literals: list[list[list[tuple[int, cp_model.IntVar]]]]
    sizes: dict[int, cp_model.IntVar]
    positive: dict[int, cp_model.IntVar]
    hint: Hint | None = None


def build_model(problem: Problem, *, bounds: bool = True, hints: bool = True) -> Model:
    """The model of a problem; `bounds` and `hints` add what the compiler already knows.

    Raises `Refusal` where sums would not fit 64 bits.
    """
    return Builder(problem, bounds, hints).build()


class Builder:
    """Writes the elements of a problem into a model, one method for each kind of element.

    `horizon` (ticks) replaces the one that the problem would be given.
    """

    def __init__(
        self, problem: Problem, bounds: bool, hints: bool, horizon: int | None = None
    ) -> None:
        self.problem = problem
        self.bounds = bounds
        self.model = cp_model.CpModel()
        self.users = [_Users() for _ in problem.shared]
        found = list_schedule(problem) if bounds or hints else None
        self.hint = found if hints else None
        self.horizon = self._horizon(horizon, found[0] if bounds and found else None)
        self.sizes: dict[int, cp_model.IntVar] = {}
        self.positive: dict[int, cp_model.IntVar] = {}
        self.pairs: list[tuple[cp_model.IntVar, cp_model.IntVar, cp_model.IntVar]] = []

    def _horizon(self, given: int | None, known: Sequence[Any] | None) -> int:
        horizon = safe_horizon(self.problem) if given is None else given
        widest = max((s.capacity for s in self.problem.shared), default=1)
        if (horizon + 1) * max(1, widest) * max(1, len(self.problem.activities)) >= _MAX_SUM:
            raise Refusal(
                f"the times of this task reach {horizon} ticks, "
                "beyond what CP-SAT's 64-bit sums can hold",
                hint="use a coarser common unit for its times",
            )
        if known is not None:
            horizon = min(horizon, max((int(d.end) for d in known), default=0))
        return max(horizon, self.problem.bound.value)

    def build(self, *, objective: bool = True) -> Model:
        """The model; without `objective` any schedule will do."""
        model = self.model
        starts, ends = [], []
        for i, activity in enumerate(self.problem.activities):
            start, end = self._points(i, activity)
            starts.append(start)
            ends.append(end)
        self.starts, self.ends = starts, ends
        for k in range(len(self.problem.arcs)):
            self._arc(k)
        literals = [self._claims(i, a) for i, a in enumerate(self.problem.activities)]
        for shared, users in zip(self.problem.shared, self.users, strict=True):
            self._resource(shared.capacity, users)
        least = self.problem.bound.value if self.bounds else 0
        makespan = model.new_int_var(least, self.horizon, "makespan")
        for i in range(len(starts)):
            tail = self.problem.tails[i] if self.bounds else 0
            model.add(makespan >= self._end(i) + tail)
        if objective:
            model.minimize(makespan)
        built = Model(model, starts, ends, makespan, literals, self.sizes, self.positive)
        if self.hint is not None:
            self._add_hint(built, *self.hint)
            built.hint = self.hint
        return built

    def _points(self, i: int, activity: Activity) -> tuple[cp_model.IntVar, cp_model.IntVar | None]:
        deadline = self.problem.effective_deadline(i)
        latest_end = self.horizon if deadline is None else min(self.horizon, deadline)
        earliest = max(activity.release, self.problem.heads[i] if self.bounds else 0)
        if activity.start is not None:
            domain = cp_model.Domain(activity.start, activity.start)
        else:
            domain = cp_model.Domain(earliest, max(earliest, latest_end - activity.duration_min))
        start = self.model.new_int_var_from_domain(domain, f"start {activity.id}")
        if latest_end < earliest + activity.duration_min:
            self.model.add(start + activity.duration_min <= latest_end)
        if activity.is_fixed:
            return start, None
        end = self.model.new_int_var(0, max(0, latest_end), f"end {activity.id}")
        size = self.model.new_int_var(
            activity.duration_min,
            max(activity.duration_min, min(activity.duration_max, self.horizon)),
            f"duration {activity.id}",
        )
        self.model.add(start + size == end)
        self.sizes[i] = size
        return start, end

    def _end(self, i: int) -> Any:
        end = self.ends[i]
        return self.starts[i] + self.problem.activities[i].duration_min if end is None else end

    def _arc(self, k: int) -> None:
        arc = self.problem.arcs[k]
        before = self._end(arc.before) if arc.from_end else self.starts[arc.before]
        after = self._end(arc.after) if arc.to_end else self.starts[arc.after]
        # Lags beyond the horizon never bind, and may be beyond 64 bits.
        if arc.min_lag > -self.horizon:
            self.model.add(after - before >= arc.min_lag)
        if arc.max_lag is not None and arc.max_lag < self.horizon:
            self.model.add(after - before <= arc.max_lag)

    def _claims(self, i: int, activity: Activity) -> list[list[tuple[int, cp_model.IntVar]]]:
        if not activity.claims:
            return []
        held = self._holding(i, activity)
        return [self._claim(i, c, claim, held) for c, claim in enumerate(activity.claims)]

    def _holding(self, i: int, activity: Activity) -> cp_model.IntVar | None:
        """A literal that says the activity has a length; None where it always has."""
        if activity.duration_min > 0:
            return None
        literal = self.model.new_bool_var(f"holds {activity.id}")
        self.model.add(self.sizes[i] >= 1).only_enforce_if(literal)
        self.model.add(self.sizes[i] == 0).only_enforce_if(~literal)
        self.positive[i] = literal
        return literal

    def _claim(
        self, i: int, c: int, claim: Claim, held: cp_model.IntVar | None
    ) -> list[tuple[int, cp_model.IntVar]]:
        activity = self.problem.activities[i]
        if len(claim.alternatives) == 1:
            taken = self._all_of(i, claim, claim.alternatives[0], held)
            self._take(claim.alternatives[0], self._interval(i, taken), claim.amount)
            return []
        literals = []
        for r in claim.alternatives:
            name = f"use {c} of {activity.id} on {self.problem.shared[r].id}"
            literal = self.model.new_bool_var(name)
            literals.append((r, literal))
            if claim.amount > self.problem.shared[r].capacity and activity.duration_min > 0:
                self.model.add(literal == 0)
                continue
            taken = self._all_of(i, claim, r, held, literal)
            self._take(r, self._interval(i, taken), claim.amount)
        self.model.add_exactly_one(literal for _, literal in literals)
        return literals

    def _all_of(
        self, i: int, claim: Claim, r: int, *literals: cp_model.IntVar | None
    ) -> cp_model.IntVar | None:
        """A literal under which the claim takes shared resource r; None where it always does."""
        together: cp_model.IntVar | None = None
        for literal in literals:
            if literal is not None:
                together = literal if together is None else self._both(literal, together)
        return together

    def _both(self, a: cp_model.IntVar, b: cp_model.IntVar) -> cp_model.IntVar:
        both = self.model.new_bool_var("")
        self.model.add_bool_and(a, b).only_enforce_if(both)
        self.model.add_bool_or(~a, ~b, both)
        self.pairs.append((both, a, b))
        return both

    def _interval(self, i: int, literal: cp_model.IntVar | None) -> cp_model.IntervalVar:
        activity, start = self.problem.activities[i], self.starts[i]
        if activity.is_fixed:
            size = activity.duration_min
            if literal is None:
                return self.model.new_fixed_size_interval_var(start, size, activity.id)
            return self.model.new_optional_fixed_size_interval_var(
                start, size, literal, activity.id
            )
        length, end = self.sizes[i], self._end(i)
        if literal is None:
            return self.model.new_interval_var(start, length, end, activity.id)
        return self.model.new_optional_interval_var(start, length, end, literal, activity.id)

    def _take(self, r: int, interval: cp_model.IntervalVar, amount: int) -> None:
        self.users[r].intervals.append(interval)
        self.users[r].amounts.append(amount)

    def _resource(self, capacity: int, users: _Users) -> None:
        if not users.intervals:
            return
        if 2 * min(users.amounts) > capacity and max(users.amounts) <= capacity:
            self.model.add_no_overlap(users.intervals)
        else:
            self.model.add_cumulative(users.intervals, users.amounts, capacity)

    def _add_hint(
        self, built: Model, decisions: Sequence[Any], choices: Sequence[tuple[int, ...]]
    ) -> None:
        """A complete assignment, so that CP-SAT starts from a schedule."""
        for i, decision in enumerate(decisions):
            self.model.add_hint(built.starts[i], decision.start)
            end = built.ends[i]
            if end is not None:
                self.model.add_hint(end, decision.end)
            for taken, literals in zip(choices[i], built.literals[i], strict=True):
                for r, literal in literals:
                    self.model.add_hint(literal, int(r == taken))
        for i, size in built.sizes.items():
            self.model.add_hint(size, decisions[i].end - decisions[i].start)
        for i, literal in built.positive.items():
            self.model.add_hint(literal, int(decisions[i].end > decisions[i].start))
        hinted = self.model.proto.solution_hint
        values = dict(zip(hinted.vars, hinted.values, strict=True))
        for both, a, b in self.pairs:
            self.model.add_hint(both, values[a.index] * values[b.index])
        latest = max((int(d.end) for d in decisions), default=0)
        self.model.add_hint(built.makespan, max(latest, self.problem.bound.value))


def encode_files(problem: Problem) -> tuple[Mapping[str, str], Mapping[str, Any]]:
    """`model.pbtxt`, and which variable (by number) carries which part of the answer."""
    built = build_model(problem)
    names: dict[str, Any] = {
        "makespan": built.makespan.index,
        "actions": {
            activity.id: _variables(problem, built, i)
            for i, activity in enumerate(problem.activities)
        },
    }
    return {MODEL_FILE: str(built.model.proto)}, names


def _variables(problem: Problem, built: Model, i: int) -> dict[str, Any]:
    shown: dict[str, Any] = {"start": built.starts[i].index}
    end = built.ends[i]
    if end is None:
        shown["duration"] = problem.activities[i].duration_min
    else:
        shown["end"] = end.index
    choices = {
        str(claim.use): {problem.shared[r].id: literal.index for r, literal in literals}
        for claim, literals in zip(problem.activities[i].claims, built.literals[i], strict=True)
        if literals
    }
    if choices:
        shown["choices"] = choices
    return shown
