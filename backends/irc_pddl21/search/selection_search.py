"""Rewards and costs: the search for the best selection of optional items that has a plan.

Planners cannot maximise a reward (kairos answers 0, OPTIC crashes), but they find plans of
mandatory activities quickly. So selections of items are tried by falling value: each is refuted by
a bound or handed to the planner as a task in which the selected items are mandatory and the others
absent. The first plan is then optimal if each better selection was refuted. Since that may take
long, a good selection is found first, by local search.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace

from irc.passes import resource_bounds
from irc.problem import Problem
from irc.schedule import Schedule
from irc_pddl21.search.list_schedules import short_list_schedule
from irc_pddl21.search.local_search import good_selection
from irc_pddl21.search.makespan import shorten
from irc_pddl21.search.neighbourhood import Places, makespan_of, near, neighbourhoods
from irc_pddl21.search.planner_session import PlannerSession, ticks
from irc_pddl21.search.selection import Selection, SelectionSpace, breaks_selections, is_refuted
from irc_pddl21.search.selection_tree import SelectionTree

PLAN_SECONDS = 1.0
PLAN_SHARE = 0.15
"""For one plan of one selection: seconds, and of the time left."""

HINT_SECONDS = 0.3
HINT_SHARE = 0.1
"""For the search for a list schedule of one selection."""

TIES_LIMIT = 100
"""The number of selections of equal value that are compared by makespan; more leave it unproven."""


class SelectionSearch:
    """The best selection of items for which the planner finds a plan.

    After `run`, `value` is the value of the best selection `chosen` (None: nothing was found), and
    no selection has a greater one than `bound`.
    """

    def __init__(self, session: PlannerSession, space: SelectionSpace) -> None:
        self.session, self.space = session, space
        self.everything = frozenset(range(len(space.items)))
        self.chosen: Selection | None = None
        self.plan: Schedule | None = None
        self.value: int | None = None
        self.bound = space.upper_bound(frozenset(), self.everything)
        self._missed: set[Selection] = set()
        self._tree = SelectionTree(space)

    @property
    def is_proven(self) -> bool:
        """Whether no selection has a greater value than the best one found."""
        return self.value is not None and self.value == self.bound

    def run(self) -> None:
        """Finds a good selection, then goes through all that may be better, best first."""
        chosen: Selection | None = good_selection(self.session, self.space, self.bound)
        while chosen is not None and not self.session.is_over:
            if self._try(chosen):
                break
            chosen = self._smaller(chosen)
        for upper, leaf in self._tree.falling():
            self.bound = max([upper, *(self.space.value(c) for c in self._missed)])
            if self.value is not None and upper <= self.value:
                self._tree.put_back(upper, leaf)
                break
            if self.session.is_over:
                return
            if leaf is not None and leaf != self.chosen and not self._refuted(leaf):
                self._try(leaf)
        self._retry_missed()

    def _retry_missed(self) -> None:
        """Asks the planner once more for the selections it missed, with all the time there is.

        All others have been seen, so none has a greater value than the best one or these.
        """
        value = self.space.value
        for chosen in sorted(self._missed, key=value, reverse=True):
            if self.session.is_over or (self.value is not None and value(chosen) <= self.value):
                break
            if self._refuted(chosen):
                self._missed.discard(chosen)
            elif self._try_hard(chosen):
                break
        found = self.value
        better = [value(c) for c in self._missed if found is None or value(c) > found]
        self.bound = max(better, default=found)

    def _try_hard(self, chosen: Selection) -> bool:
        """Whether the planner finds a plan that differs from the (late) list schedule in places."""
        problem = self.problem_of(chosen)
        rng = random.Random(self.session.options.seed)
        latest = problem.deadline or 0
        budget = self.session.budget.share(HINT_SHARE)
        known = short_list_schedule(problem, latest, budget, rng)
        if known is None:
            return False
        for free in neighbourhoods(known, rng):
            if self.session.is_over:
                return False
            asked = near(problem, known, free)
            plan = self.session.ask(asked, PLAN_SECONDS, enough=problem.bounds.makespan.value)
            if plan is not None:
                self.chosen, self.plan, self.value = chosen, plan, self.space.value(chosen)
                return True
        return False

    def ties(self) -> Iterator[Selection | None]:
        """The other selections of the same value; None where time ran out or there are too many."""
        # Those that the planner missed were seen before: they may be shorter all the same.
        missed = [c for c in self._missed if self.space.value(c) == self.value]
        yield from sorted(missed, key=sorted)
        found = len(missed)
        for upper, leaf in self._tree.falling():
            if self.value is None or upper < self.value:
                return
            if self.session.is_over or found > TIES_LIMIT:
                yield None
                return
            if leaf is not None and leaf != self.chosen and leaf not in self._missed:
                found += 1
                yield leaf

    def problem_of(self, chosen: Selection) -> Problem:
        """The problem of a selection that was not refuted, with the best bound there is."""
        problem = self.space.restricted(chosen)
        assert problem is not None
        return resource_bounds(problem)

    def _refuted(self, chosen: Selection) -> bool:
        return is_refuted(self.space.restricted(chosen), thoroughly=True)

    def _try(self, chosen: Selection) -> bool:
        """Whether the planner finds a plan of a selection; the best selection is kept."""
        plan = plan_of(self.session, self.problem_of(chosen))
        if plan is None:
            self._missed.add(chosen)
            return False
        value = self.space.value(chosen)
        if self.value is None or value > self.value:
            self.chosen, self.plan, self.value = chosen, plan, value
        return True

    def _smaller(self, chosen: Selection) -> Selection | None:
        """The selection without its item of least value."""
        return chosen - {max(chosen)} if chosen else None


def plan_of(session: PlannerSession, problem: Problem) -> Schedule | None:
    """A plan of a problem, if the planner finds one soon."""
    if breaks_selections(problem):
        return None
    if not (problem.activities or problem.goals or problem.number_goals):
        nothing = Schedule((), task=problem.name)
        session.keep(nothing)
        return nothing
    latest = problem.deadline
    known: Places | None = None
    if session.tactics.hint and latest is not None:
        rng = random.Random(session.options.seed)
        budget = session.budget.share(HINT_SHARE).at_most(HINT_SECONDS)
        known = short_list_schedule(problem, latest, budget, rng)
    if known is not None and latest is not None and makespan_of(known) <= latest:
        followed = near(problem, known, frozenset())
        plan = session.ask(followed, PLAN_SECONDS, enough=problem.bounds.makespan.value)
        if plan is not None:
            return plan
    for search in session.planner.searches:
        seconds = max(PLAN_SECONDS, PLAN_SHARE * session.left) / len(session.planner.searches)
        plan = session.ask(problem, seconds, enough=problem.bounds.makespan.value, search=search)
        if plan is not None:
            return plan
    return None


def shortest_of_best(
    session: PlannerSession, search: SelectionSearch
) -> tuple[Schedule, int | None]:
    """The shortest plan among the selections of the best value, and a bound on its makespan.

    The bound is in ticks; None where not all of those selections were compared.
    """
    assert search.chosen is not None
    assert search.plan is not None
    problem = search.problem_of(search.chosen)
    best = shorten(session, problem, search.plan) or search.plan
    bound = problem.bounds.makespan.value
    if not search.is_proven:
        return best, None
    for chosen in search.ties():
        if chosen is None:
            return best, None
        other = search.problem_of(chosen)
        if is_refuted(other, thoroughly=False) or other.bounds.makespan.value >= ticks(
            problem, best
        ):
            continue
        sooner = replace(other, deadline=ticks(problem, best) - 1)
        plan = shorten(session, sooner)
        if plan is not None and ticks(problem, plan) < ticks(problem, best):
            best = plan
        bound = min(bound, other.bounds.makespan.value)
    return best, bound
