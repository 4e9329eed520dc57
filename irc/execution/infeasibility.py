"""Finds why a history has no continuation: the limits that would have to be relaxed.

The named limits suffice: a schedule was found that breaks only those. Each sort of limit is tried
alone, with CP-SAT and for a short time only.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

from irc.diagnostics import Code, Diagnostic
from irc.execution.continuation import PROVER, Repair
from irc.execution.freeze import with_groups
from irc.execution.limits import HINTS, Limit, Sort, broken, in_words, time_limits, without
from irc.execution.numbers import without_limits_on
from irc.model.state_values import value_text
from irc.passes import order_from_state
from irc.problem import IMPOSSIBLE_DEADLINE, Activity, Condition, PreviousPlan, Problem
from irc.problem.decisions import AnswerError
from irc.schedule import Schedule, Status
from irc.targets import Budget, EngineFailed, Refusal, get_backend

PATIENCE = 3.0
"""Seconds for all attempts together."""

EACH = 1.0
"""Seconds for each attempt."""

SHOWN = 3
"""At most this many limits of one sort are named."""


def what_is_in_the_way(repair: Repair) -> tuple[Diagnostic, ...]:
    """The limits that would have to be relaxed where no continuation exists, as diagnostics.

    Empty where nothing was found. It takes little time, and no more than the time that is left.
    """
    frozen, budget = repair.frozen, repair.budget.at_most(PATIENCE)
    freest = with_groups(frozen, frozen.half_done(), all_carried=True)
    problem = order_from_state(freest)
    problem = replace(problem, previous=PreviousPlan(stability=problem.previous.stability))
    backend = get_backend(PROVER)
    prover = replace(repair, backend=backend, engine=backend.engine())
    if prover.engine.missing() is not None or not prover.engine.can_begin(budget):
        return ()
    search = _LimitSearch(problem, frozenset(frozen.executed), prover, budget)
    for sort in _SORTS:
        found = [*sort(search)]
        if found:
            return tuple(
                Diagnostic(Code.NO_CONTINUATION, why, hint=hint) for why, hint in found[:SHOWN]
            )
        if budget.is_over:
            break
    return ()


_Item = TypeVar("_Item")

_Reason = tuple[str, str]
"""A fault, and a hint."""


@dataclass(frozen=True)
class _LimitSearch:
    problem: Problem
    begun: Collection[int]
    prover: Repair
    budget: Budget

    @property
    def open(self) -> list[tuple[int, Activity]]:
        """The activities that have not begun and are not over."""
        return [
            (i, a)
            for i, a in enumerate(self.problem.activities)
            if i not in self.begun and a.deadline != IMPOSSIBLE_DEADLINE
        ]

    def tried(self, relaxed: Problem) -> tuple[Schedule, bool] | None:
        """A schedule of a relaxed problem, and whether it is the best, if one was found."""
        if self.budget.is_over:
            return None
        try:
            found = self.prover.tried(relaxed, self.budget.at_most(EACH))
        except (AnswerError, EngineFailed, Refusal):
            return None  # An engine that fails proves nothing.
        if found.schedule is None:
            return None
        return found.schedule, found.status is Status.OPTIMAL

    def is_possible(self, relaxed: Problem) -> bool:
        return self.tried(replace(relaxed, objectives=("makespan",))) is not None

    def with_open(self, change: Callable[[Activity], Activity]) -> tuple[Activity, ...]:
        """All activities, with the open ones changed."""
        changed = list(self.problem.activities)
        for i, activity in self.open:
            changed[i] = change(activity)
        return tuple(changed)

    def without(self, limits: Collection[Limit]) -> tuple[Schedule, bool] | None:
        """A schedule that need not keep some limits, with as little lateness as possible."""
        problem = without(self.problem, limits)
        activities = [replace(a, details=replace(a.details, due=None)) for a in problem.activities]
        for sort, i in limits:
            if sort in (Sort.DEADLINE, Sort.START, Sort.LATEST_START):
                was, now = self.problem.activities[i], activities[i]
                due = _as_due(was, sort)
                activities[i] = replace(now, details=replace(now.details, due=due, weight=1))
        late = any(a.details.due is not None for a in activities)
        relaxed = replace(
            problem,
            activities=tuple(activities),
            groups=tuple(replace(g, due=None) for g in problem.groups),
            objectives=("tardiness", "makespan") if late else ("makespan",),
        )
        return self.tried(relaxed)


def _as_due(activity: Activity, sort: Sort) -> int | None:
    """A limit on an activity's time as a due date."""
    if sort is Sort.DEADLINE:
        return activity.deadline
    start = activity.start if sort is Sort.START else activity.latest_start
    return (start or 0) + activity.duration_min


def _too_small(search: _LimitSearch) -> Iterator[_Reason]:
    """Required activities that ask for more than their resources have from now on."""
    problem = search.problem
    for i, activity in search.open:
        details = activity.details
        if details.optional or not activity.duration_min or _is_choice(problem, i):
            continue
        for k, use in enumerate(activity.uses):
            if details.use_mode(k) is not None:
                continue
            greatest = max(
                problem.resources[r].greatest_capacity(activity.release) for r in use.alternatives
            )
            if greatest < use.amount:
                names = " or ".join(repr(problem.resources[r].id) for r in use.alternatives)
                why = f"{activity.id!r} needs {use.amount} of {names}, which has at most {greatest}"
                yield why, f"more of {names}, or cancelling {activity.id!r}, would help"


def _is_choice(problem: Problem, index: int) -> bool:
    return any(not g.required and index in g.members for g in problem.groups)


def _times(search: _LimitSearch) -> Iterator[_Reason]:
    """The limits on time that would have to be relaxed: of one sort if that suffices, else of all.

    A small set is found by restoring the limits one by one.
    """
    limits = [*time_limits(search.problem, search.begun)]
    by_sort = [[limit for limit in limits if limit.sort is sort] for sort in Sort]
    for dropped in (*filter(None, by_sort), limits):
        found = search.without(dropped)
        if found is None:
            continue
        needed = broken(search.problem, dropped, found[0])
        for limit in [*needed]:
            fewer = [other for other in needed if other != limit]
            again = search.without(fewer) if fewer and limit in needed else None
            if again is not None:
                found, needed = again, broken(search.problem, fewer, again[0])
        only = found[1] and len(needed) == 1
        for limit, reached in needed.items():
            yield in_words(search.problem, limit, reached, only), HINTS[limit.sort]
        return


def _goals(search: _LimitSearch) -> Iterator[_Reason]:
    problem = search.problem
    for k, (v, value) in enumerate(problem.goals):
        rest = problem.goals[:k] + problem.goals[k + 1 :]
        if search.is_possible(replace(problem, goals=rest)):
            variable = problem.variables[v]
            what = f"{variable.id!r} = {value_text(variable.values[value])}"
            yield f"the goal {what} cannot be reached any more", "other goals would help"


def _number_goals(search: _LimitSearch) -> Iterator[_Reason]:
    problem = search.problem
    for k, goal in enumerate(problem.number_goals):
        rest = problem.number_goals[:k] + problem.number_goals[k + 1 :]
        if search.is_possible(replace(problem, number_goals=rest)):
            number = problem.numbers[goal.number]
            what = f"{number.id!r} {number.limits_text(goal.least, goal.greatest)}"
            yield f"the goal {what} cannot be reached any more", "other goals would help"


def _numbers(search: _LimitSearch) -> Iterator[_Reason]:
    """Numbers without whose conditions and bounds a continuation exists."""
    problem = search.problem
    for k, number in enumerate(problem.numbers):
        free = [*problem.numbers]
        free[k] = replace(number, least=None, greatest=None)
        activities = search.with_open(partial(without_limits_on, number=k))
        if search.is_possible(replace(problem, activities=activities, numbers=tuple(free))):
            asked = {
                (a.id, number.limits_text(c.least, c.greatest))
                for _, a in search.open
                for c in a.details.all_number_conditions
                if c.number == k
            }
            wanted = [f"{limits} for {name!r}" for name, limits in sorted(asked)[:SHOWN]]
            if (number.least, number.greatest) != (None, None):
                wanted.append(number.limits_text(number.least, number.greatest) + " always")
            why = f"{number.id!r} does not reach the levels that are needed: {', '.join(wanted)}"
            yield why, "an action that changes it, or another level now, would help"


def _state(search: _LimitSearch) -> Iterator[_Reason]:
    """Variables without whose conditions a continuation exists."""
    problem = search.problem
    for v, variable in enumerate(problem.variables):
        needed = sorted(
            {
                (a.id, value_text(variable.values[c.value]))
                for _, a in search.open
                for c in a.details.all_conditions
                if c.var == v
            }
        )
        if not needed:
            continue
        freed = search.with_open(partial(_without_conditions, var=v))
        if search.is_possible(replace(problem, activities=freed)):
            asked = ", ".join(f"{value} for {name!r}" for name, value in needed[:SHOWN])
            why = f"{variable.id!r} does not reach the needed value: {asked}"
            yield why, "an action that sets it, or another value now, would help"


def _without_conditions(activity: Activity, var: int) -> Activity:
    details = activity.details

    def kept(conditions: tuple[Condition, ...]) -> tuple[Condition, ...]:
        return tuple(c for c in conditions if c.var != var)

    modes = tuple(m._replace(conditions=kept(m.conditions)) for m in details.modes)
    details = replace(
        details,
        conditions=kept(details.conditions),
        modes=modes,
        protects=tuple(p for p in details.protects if p.var != var),
    )
    return replace(activity, details=details)


def _stock(search: _LimitSearch) -> Iterator[_Reason]:
    problem = search.problem
    changes = [c for a in problem.activities for c in a.details.all_stock]
    for r, reservoir in enumerate(problem.reservoirs):
        taken = sum(-c.amount for c in changes if c.reservoir == r and c.amount < 0)
        fuller = replace(reservoir, initial=reservoir.initial + taken, greatest=None)
        if search.is_possible(replace(problem, reservoirs=_put(problem.reservoirs, r, fuller))):
            yield (
                f"the stock of {reservoir.id!r} does not suffice",
                f"more of {reservoir.id!r} would help",
            )


def _capacities(search: _LimitSearch) -> Iterator[_Reason]:
    problem = search.problem
    for r, resource in enumerate(problem.resources):
        asked = sum(u.amount for a in problem.activities for u in a.uses if r in u.alternatives)
        if asked <= resource.capacity and not resource.windows:
            continue
        if search.is_possible(_with_plenty(problem, r, max(asked, resource.capacity))):
            why = f"there is not enough of {resource.id!r} for the remaining actions"
            yield why, f"more of {resource.id!r}, or having it sooner, would help"


def _with_plenty(problem: Problem, resource: int, capacity: int) -> Problem:
    """The problem in which a resource always has this capacity."""
    larger = replace(problem.resources[resource], capacity=capacity, windows=())
    pools = tuple(
        replace(p, capacity=max(capacity, p.capacity), base=None, windows=())
        if resource in p.members
        else p
        for p in problem.contention.pools
    )
    return replace(
        problem,
        resources=_put(problem.resources, resource, larger),
        contention=replace(problem.contention, pools=pools),
    )


def _put(items: Sequence[_Item], index: int, item: _Item) -> tuple[_Item, ...]:
    return (*items[:index], item, *items[index + 1 :])


_SORTS: tuple[Callable[[_LimitSearch], Iterator[_Reason]], ...] = (
    _too_small,
    _times,
    _goals,
    _number_goals,
    _state,
    _numbers,
    _stock,
    _capacities,
)
