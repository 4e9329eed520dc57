"""Good list schedules for a planner to follow, by a search over priorities.

Serial list schedules contain an optimal one wherever nothing has to wait on purpose (Kolisch,
EJOR 90, 1996), so a search over priorities comes close to it in little time. It is a hint and no
answer: a planner is asked to follow its order, and only the planner's own plan counts.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import replace

from irc.passes.serial_sgs import Found, list_schedule
from irc.problem import Activity, Problem
from irc.problem.decisions import Decision
from irc.targets import Budget
from irc_pddl21.search.neighbourhood import Places

ROUNDS = 12_000
"""The greatest number of list schedules."""

STALE_LIMIT = 800
"""After this number without a shorter one the search begins anew."""


Value = tuple[int, ...]
"""Numbers that rank list schedules, the first one first; less is better."""

Judge = Callable[[Sequence[Decision]], Value]
"""The value of a list schedule by its starts and ends."""


def short_list_schedule(
    problem: Problem, enough: int, budget: Budget, rng: random.Random
) -> Places | None:
    """The shortest list schedule found; one of makespan `enough` (ticks) ends the search.

    None for problems with more than resources and lags, and where the rule finds none.
    """
    return best_list_schedule(problem, _makespan, (enough,), budget, rng)


def searched_schedule(problem: Problem, enough: int, budget: Budget, seed: int) -> Places | None:
    """The shortest schedule that local search finds; one of makespan `enough` (ticks) ends it.

    None for problems with more than resources and lags, and where it finds none in time. Loads
    numpy, and llvmlite where it is installed.
    """
    if not problem.is_plain:
        return None
    from irc.local_search.search import search_of
    from irc.local_search.ways import NotApplicable

    try:
        search = search_of(replace(problem, deadline=None), seed, seconds=budget.left)
    except NotApplicable:
        return None
    while not budget.is_over and (search.value is None or search.value > enough):
        search.step()
    found = search.found()
    return None if found is None else dict(enumerate(zip(*found, strict=True)))


def best_list_schedule(
    problem: Problem, judge: Judge, enough: Value, budget: Budget, rng: random.Random
) -> Places | None:
    """The list schedule of the least value found; one of value `enough` ends the search.

    None for problems with more than resources and lags, and where the rule finds none.
    """
    if not problem.is_plain:
        return None
    search = _PrioritySearch(replace(problem, deadline=None), judge, rng)
    best, least = search.found, search.value
    for _ in range(ROUNDS):
        if (least is not None and least <= enough) or budget.is_over:
            break
        search.step()
        if search.value is not None and (least is None or search.value < least):
            best, least = search.found, search.value
        if search.stale > STALE_LIMIT:
            search = _PrioritySearch(search.problem, judge, rng)
    return None if best is None else dict(enumerate(zip(*best, strict=True)))


class _PrioritySearch:
    """A walk over priorities and over which resource is looked at first."""

    def __init__(self, problem: Problem, judge: Judge, rng: random.Random) -> None:
        self.problem, self.judge, self.rng = problem, judge, rng
        self.variant = problem
        self.found = list_schedule(problem)
        self.value = self._value_of(self.found)
        self.stale = 0
        spans = zip(problem.bounds.tails, problem.activities, strict=True)
        self._spread = 1 + max((tail + a.duration_min for tail, a in spans), default=0)
        self._choosers = [
            i
            for i, a in enumerate(problem.activities)
            if any(len(demand.alternatives) > 1 for demand in a.open_demands)
        ]

    def _value_of(self, found: Found | None) -> Value | None:
        return None if found is None else self.judge(found[0])

    def step(self) -> None:
        """Makes one more list schedule; the search goes on from it unless it is worse."""
        self.stale += 1
        variant = self._varied()
        found = list_schedule(variant)
        value = self._value_of(found)
        if value is None or (self.value is not None and value > self.value):
            return
        if self.value is None or value < self.value:
            self.stale = 0
        self.variant, self.found, self.value = variant, found, value

    def _varied(self) -> Problem:
        rng = self.rng
        width = self._spread * rng.choice((0.05, 0.2, 0.5))
        share = rng.choice((0.1, 0.3, 1.0))
        tails = tuple(
            round(tail + rng.uniform(-width, width)) if rng.random() < share else tail
            for tail in self.variant.bounds.tails
        )
        activities = list(self.variant.activities)
        if self._choosers and rng.random() < 0.5:
            for i in rng.sample(self._choosers, min(len(self._choosers), rng.randint(1, 3))):
                activities[i] = self._rearranged(self.problem.activities[i])
        bounds = replace(self.variant.bounds, tails=tails)
        return replace(self.variant, bounds=bounds, activities=tuple(activities))

    def _rearranged(self, activity: Activity) -> Activity:
        """The activity with alternatives in another order, or only one of them left."""
        demands = []
        for demand in activity.open_demands:
            order = self.rng.sample(demand.alternatives, len(demand.alternatives))
            kept = order[:1] if self.rng.random() < 0.5 else order
            demands.append(demand._replace(alternatives=tuple(kept)))
        return replace(activity, open_demands=tuple(demands))


def _makespan(decisions: Sequence[Decision]) -> Value:
    return (max((int(d.end) for d in decisions), default=0),)
