"""Activities, precedence and resources in a CP-SAT model, one method for each kind of element.

State, stock, calendars and objectives have modules of their own, as have hints.

An activity is a start and, where it can move by itself, an end; what may be absent has a literal.
Where state is left, every happening also has a rank, and `moment = time × ranks + rank` is one
integer that orders happenings (docs/semantics.md, rule 6).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from ortools.sat.python import cp_model

from irc.passes.serial_sgs import quick_schedule
from irc.problem import Activity, Claim, Problem, Shared
from irc.problem.decisions import Decision
from irc.problem.horizon import safe_horizon, within
from irc_cpsat.calendars import with_windows
from irc_cpsat.hints import add_earlier, add_hint, add_places
from irc_cpsat.names import name_of
from irc_cpsat.objectives import makespan, values_of
from irc_cpsat.stock import add_stock
from irc_cpsat.sums import refuse_overflow

Hint = tuple[list[Decision], list[tuple[int, ...]]]
"""A list schedule: a decision for each activity, and the shared resource of each claim."""

Literal = cp_model.IntVar
Expression = Any
"""A linear expression, a variable or a number."""


@dataclass
class Users:
    """The intervals that claim one shared resource, with their amounts."""

    intervals: list[cp_model.IntervalVar] = field(default_factory=list)
    amounts: list[int] = field(default_factory=list)


@dataclass
class Model:
    """A CP-SAT model and the variables that carry its answer.

    `literals[i][c]` lists, for claim c of activity i, (shared resource, literal that takes it);
    a claim with one alternative has no literals. `present[i]` is None where activity i always is;
    `modes[i]` has a literal for each of its modes. `ranks[i]` are the variables of its start's and
    its end's rank, None where there is no state. `values` are the objectives' expressions.
    """

    model: cp_model.CpModel
    problem: Problem
    starts: list[cp_model.IntVar]
    ends: list[cp_model.IntVar | None]
    makespan: cp_model.IntVar
    literals: list[list[list[tuple[int, Literal]]]]
    sizes: dict[int, cp_model.IntVar]
    positive: dict[int, Literal]
    present: list[Literal | None]
    modes: list[list[Literal]]
    ranks: list[tuple[cp_model.IntVar, cp_model.IntVar] | None]
    values: dict[str, Expression]
    hint: Hint | None = None


class Builder:
    """Writes a problem, whose repeats are unrolled, into a model.

    `bounds` and `hints` add what the compiler already knows. `horizon` (ticks) replaces the one
    that the problem would be given. Raises `Refusal` where sums would not fit 64 bits.
    """

    def __init__(
        self, problem: Problem, bounds: bool, hints: bool, horizon: int | None = None
    ) -> None:
        self.problem = problem
        self.bounds = bounds
        self.model = cp_model.CpModel()
        self.users = [Users() for _ in problem.shared]
        found = quick_schedule(problem) if problem.is_plain and (bounds or hints) else None
        self.hints = hints
        self.hint = found if hints else None
        self.ranked = bool(problem.variables)
        self.rank_count = self._rank_count()
        by_makespan = bounds and problem.objectives[:1] == ("makespan",) and not problem.stability
        self.horizon = self._horizon(horizon, found[0] if by_makespan and found else None)
        self.problem = within(problem, self.horizon)
        self.sequel = frozenset(problem.sequel)
        self.sizes: dict[int, cp_model.IntVar] = {}
        self.positive: dict[int, Literal] = {}
        self.pairs: dict[tuple[int, int], Literal] = {}
        self.both_of: list[tuple[Literal, Literal, Literal]] = []
        self.starts: list[cp_model.IntVar] = []
        self.ends: list[cp_model.IntVar | None] = []
        self.present: list[Literal | None] = []
        self.modes: list[list[Literal]] = []
        self.ranks: list[tuple[cp_model.IntVar, cp_model.IntVar] | None] = []
        self.groups: list[Literal | None] = []

    def _rank_count(self) -> int:
        """So many ranks are enough: one for each happening that can have its own."""
        if not self.ranked:
            return 1
        return 1 + sum(1 if a.is_fixed else 2 for a in self.problem.activities)

    def _horizon(self, given: int | None, known: Sequence[Any] | None) -> int:
        problem = self.problem
        horizon = safe_horizon(problem) if given is None else given
        refuse_overflow(problem, horizon, self.rank_count)
        if known is not None:
            horizon = min(horizon, max((int(d.end) for d in known), default=0))
        return max(horizon, problem.bound.value)

    # --- the whole ---

    def build(self, *, objective: bool = True) -> Model:
        """The model; without `objective` any schedule will do."""
        problem = self.problem
        self._presence()
        for i, activity in enumerate(problem.activities):
            start, end = self._points(i, activity)
            self.starts.append(start)
            self.ends.append(end)
        if self.ranked:
            self._ranks()
        for k in range(len(problem.arcs)):
            self._arc(k)
        self._occurrences()
        literals = [self._claims(i, a) for i, a in enumerate(problem.activities)]
        for shared, users in zip(problem.shared, self.users, strict=True):
            self._resource(shared, users)
        if problem.reservoirs:
            add_stock(self)
        if self.ranked:
            from irc_cpsat.state import add_state

            add_state(self)
        latest = makespan(self)
        built = Model(
            model=self.model,
            problem=problem,
            starts=self.starts,
            ends=self.ends,
            makespan=latest,
            literals=literals,
            sizes=self.sizes,
            positive=self.positive,
            present=self.present,
            modes=self.modes,
            ranks=self.ranks,
            values=values_of(self, latest, literals),
        )
        if objective:
            name = problem.objectives[0]
            if name == "reward":
                self.model.maximize(built.values[name])
            else:
                self.model.minimize(built.values[name])
        if self.hint is not None:
            decisions, choices = self.hint
            add_hint(self, built, decisions, lambda i, c, r: choices[i][c] == r)
            built.hint = self.hint
        elif problem.start_from and self.hints:
            add_places(self, built, problem.start_from)
        elif any(problem.earlier) and self.hints:
            add_earlier(self, built)
        return built

    # --- presence and modes ---

    def _presence(self) -> None:
        model, problem = self.model, self.problem
        by_group: dict[int, Literal] = {}
        for group in problem.groups:
            literal = None if group.required else model.new_bool_var(f"group {group.id}")
            self.groups.append(literal)
            if literal is None:
                continue
            if not group.members:
                model.add(literal == 0)
            for i in group.members:
                if not problem.activities[i].details.optional:
                    model.add(literal == 1)
                elif i in by_group:
                    model.add(literal == by_group[i])
                else:
                    by_group[i] = literal
        for i, activity in enumerate(problem.activities):
            details = activity.details
            if not details.optional:
                self.present.append(None)
            elif i in by_group:
                self.present.append(by_group[i])
            else:
                self.present.append(model.new_bool_var(f"present {name_of(activity)}"))
        for i in problem.wanted:
            if (literal := self.present[i]) is not None:
                model.add(literal == 1)
        for i, activity in enumerate(problem.activities):
            self.modes.append(self._modes(i, activity))

    def _modes(self, i: int, activity: Activity) -> list[Literal]:
        modes = activity.details.modes
        if not modes:
            return []
        literals = [
            self.model.new_bool_var(f"mode {mode.id} of {name_of(activity)}") for mode in modes
        ]
        absent = self._absent(i)
        self.model.add_exactly_one([*literals, *absent])
        return literals

    def _absent(self, i: int) -> list[Any]:
        literal = self.present[i]
        return [] if literal is None else [~literal]

    def enforced(self, constraint: Any, *whose: int, also: Sequence[Any] = ()) -> None:
        """Makes a constraint bind only where some activities (and other literals) are there."""
        literals = [p for i in whose if (p := self.present[i]) is not None]
        literals += also
        if literals:
            constraint.only_enforce_if(literals)

    # --- times ---

    def _points(self, i: int, activity: Activity) -> tuple[cp_model.IntVar, cp_model.IntVar | None]:
        deadline = self.problem.effective_deadline(i)
        latest_end = self.horizon if deadline is None else min(self.horizon, deadline)
        earliest = max(activity.release, self.problem.heads[i] if self.bounds else 0)
        name = name_of(activity)
        fits = earliest + activity.duration_min <= latest_end
        literal = self.present[i]
        if not fits and literal is not None:
            self.model.add(literal == 0)
            latest_end = earliest + activity.duration_max
        if activity.start is not None:
            domain = cp_model.Domain(activity.start, activity.start)
        else:
            domain = cp_model.Domain(earliest, max(earliest, latest_end - activity.duration_min))
        start = self.model.new_int_var_from_domain(domain, f"start {name}")
        late = activity.start is not None and activity.start + activity.duration_min > latest_end
        if (not fits and literal is None) or late:
            self.enforced(self.model.add(start + activity.duration_min <= latest_end), i)
        if activity.start is not None and activity.start < activity.release:
            self.enforced(self.model.add(start >= activity.release), i)
        if activity.is_fixed:
            return start, None
        end = self.model.new_int_var(0, max(0, latest_end, self._latest(activity)), f"end {name}")
        if self._latest(activity) > latest_end:
            self.enforced(self.model.add(end <= latest_end), i)
        longest = max(activity.duration_min, min(activity.duration_max, self.horizon))
        size = self.model.new_int_var(activity.duration_min, longest, f"duration {name}")
        self.model.add(start + size == end)
        self.sizes[i] = size
        for mode, chosen in zip(activity.details.modes, self.modes[i], strict=True):
            self.model.add(size >= mode.duration_min).only_enforce_if(chosen)
            if mode.duration_max < longest:
                self.model.add(size <= mode.duration_max).only_enforce_if(chosen)
        return start, end

    def _latest(self, activity: Activity) -> int:
        """A fixed start may be so late that its end, if it is absent, needs room."""
        if activity.start is None:
            return 0
        return activity.start + min(activity.duration_max, max(activity.duration_min, self.horizon))

    def end(self, i: int) -> Any:
        """When an activity ends, as an expression."""
        end = self.ends[i]
        return self.starts[i] + self.problem.activities[i].duration_min if end is None else end

    def _ranks(self) -> None:
        """A rank for each start; a fixed duration gives its end the same one."""
        concerned = {i for arc in self.problem.arcs for i in (arc.before, arc.after)}
        for i, activity in enumerate(self.problem.activities):
            details = activity.details
            touches = bool(details.conditions or details.effects) or i in concerned
            last = self.rank_count - 1 if touches else 0
            start = self.model.new_int_var(0, last, f"rank {name_of(activity)}")
            if activity.is_fixed:
                self.ranks.append((start, start))
                continue
            end = self.model.new_int_var(0, last, f"end rank {name_of(activity)}")
            self.ranks.append((start, end))
            self._duration_in_ranks(i, activity)

    def _duration_in_ranks(self, i: int, activity: Activity) -> None:
        """Bounds on a duration hold in moments too; a mode of fixed duration has one rank."""
        lasts = self.moment(i, at_end=True) - self.moment(i, at_end=False)
        k = self.rank_count
        modes = activity.details.modes
        if not modes:
            self.model.add(lasts >= k * activity.duration_min)
            self.model.add(lasts <= k * activity.duration_max)
        for mode, chosen in zip(modes, self.modes[i], strict=True):
            self.model.add(lasts >= k * mode.duration_min).only_enforce_if(chosen)
            self.model.add(lasts <= k * mode.duration_max).only_enforce_if(chosen)

    def moment(self, i: int, *, at_end: bool) -> Any:
        """time × ranks + rank of a happening; plain time where there are no ranks."""
        time = self.end(i) if at_end else self.starts[i]
        ranks = self.ranks[i] if self.ranked else None
        return time if ranks is None else time * self.rank_count + ranks[at_end]

    def _arc(self, k: int) -> None:
        arc = self.problem.arcs[k]
        i, j, factor = arc.before, arc.after, self.rank_count
        # Lags beyond the horizon never bind; one that reaches just as far may, in ranks.
        if arc.min_lag >= -self.horizon:
            apart = self.moment(j, at_end=arc.to_end) - self.moment(i, at_end=arc.from_end)
            sequel = self.ranked and (i, j) in self.sequel
            least = factor * arc.min_lag + (1 if sequel and arc.min_lag == 0 else 0)
            self.enforced(self.model.add(apart >= least), i, j)
        if arc.max_lag is not None and arc.max_lag < self.horizon:
            before = self.end(i) if arc.from_end else self.starts[i]
            after = self.end(j) if arc.to_end else self.starts[j]
            self.enforced(self.model.add(after - before <= arc.max_lag), i, j)

    def _occurrences(self) -> None:
        """Occurrences of one action come one after the other, without gaps in their numbers."""
        for i, activity in enumerate(self.problem.activities):
            previous = activity.details.previous
            if previous is None:
                continue
            self.enforced(self.model.add(self.starts[i] >= self.end(previous)), i)
            here, there = self.present[i], self.present[previous]
            if here is not None and there is not None:
                self.model.add_implication(here, there)

    # --- resources ---

    def _claims(self, i: int, activity: Activity) -> list[list[tuple[int, Literal]]]:
        if not activity.claims:
            return []
        held = self._holding(i, activity)
        return [self._claim(i, claim, c, held) for c, claim in enumerate(activity.claims)]

    def _holding(self, i: int, activity: Activity) -> Literal | None:
        """A literal that says the activity has a length; None where it always has."""
        if activity.duration_min > 0:
            return None
        literal = self.model.new_bool_var(f"holds {name_of(activity)}")
        self.model.add(self.sizes[i] >= 1).only_enforce_if(literal)
        self.model.add(self.sizes[i] == 0).only_enforce_if(~literal)
        self.positive[i] = literal
        return literal

    def _claim(
        self, i: int, claim: Claim, c: int, held: Literal | None
    ) -> list[tuple[int, Literal]]:
        activity = self.problem.activities[i]
        mode = activity.details.use_mode(claim.use)
        there = self.present[i] if mode is None else self.modes[i][mode]
        if len(claim.alternatives) == 1:
            taken = self._all_of(i, claim, claim.alternatives[0], there, held)
            self._take(claim.alternatives[0], self._interval(i, taken), claim.amount)
            return []
        literals: list[tuple[int, Literal]] = []
        for r in claim.alternatives:
            name = f"use {c} of {name_of(activity)} on {self.problem.shared[r].id}"
            literal = self.model.new_bool_var(name)
            literals.append((r, literal))
            if claim.amount > self.problem.shared[r].capacity and activity.duration_min > 0:
                self.model.add(literal == 0)
                continue
            taken = self._all_of(i, claim, r, held, literal)
            self._take(r, self._interval(i, taken), claim.amount)
        absent = [] if there is None else [~there]
        self.model.add_exactly_one([*(literal for _, literal in literals), *absent])
        return literals

    def _all_of(self, i: int, claim: Claim, r: int, *literals: Literal | None) -> Literal | None:
        """A literal under which the claim takes shared resource r; None where it always does."""
        together: Literal | None = None
        for literal in literals:
            if literal is not None:
                together = literal if together is None else self.both(literal, together)
        return together

    def both(self, a: Literal, b: Literal) -> Literal:
        """A literal that is true where both are."""
        key = (min(a.index, b.index), max(a.index, b.index))
        if key not in self.pairs:
            both = self.model.new_bool_var("")
            self.model.add_bool_and(a, b).only_enforce_if(both)
            self.model.add_bool_or(~a, ~b, both)
            self.pairs[key] = both
            self.both_of.append((both, a, b))
        return self.pairs[key]

    def _interval(self, i: int, literal: Literal | None) -> cp_model.IntervalVar:
        activity, start = self.problem.activities[i], self.starts[i]
        name = name_of(activity)
        if activity.is_fixed:
            size = activity.duration_min
            if literal is None:
                return self.model.new_fixed_size_interval_var(start, size, name)
            return self.model.new_optional_fixed_size_interval_var(start, size, literal, name)
        length, end = self.sizes[i], self.end(i)
        if literal is None:
            return self.model.new_interval_var(start, length, end, name)
        return self.model.new_optional_interval_var(start, length, end, literal, name)

    def _take(self, r: int, interval: cp_model.IntervalVar, amount: int) -> None:
        self.users[r].intervals.append(interval)
        self.users[r].amounts.append(amount)

    def _resource(self, shared: Shared, users: Users) -> None:
        if not users.intervals:
            return
        if shared.base is not None:
            users = with_windows(self, shared, users)
        capacity = shared.capacity
        if 2 * min(users.amounts) > capacity and max(users.amounts) <= capacity:
            self.model.add_no_overlap(users.intervals)
        else:
            self.model.add_cumulative(users.intervals, users.amounts, capacity)
