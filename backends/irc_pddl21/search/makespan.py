"""Short schedules from planners that minimise badly: hard deadlines, tighter and tighter.

A planner that minimises by itself tends to stop a little above the optimum, and proves nothing.
But it finds *a* plan under a hard deadline quickly, and the compiler knows a good lower bound.
Where the planner finds no plan at the bound it goes in steps, from a plan it has to one that is a
tick shorter and differs in a few places. The first of them may be the compiler's own list
schedule, handed to the planner as the order to follow.
"""

from __future__ import annotations

import random

from irc.problem import Problem
from irc.schedule import Schedule
from irc_pddl21.search.list_schedules import searched_schedule, short_list_schedule
from irc_pddl21.search.neighbourhood import Places, makespan_of, near, neighbourhoods, places_in
from irc_pddl21.search.planner_session import PlannerSession, ticks, with_deadline

BOUND_SECONDS = 0.6
BOUND_SHARE = 0.1
"""For a first plan under the deadline "makespan = bound", in each kind of search; seconds, and of
the time left."""

HINT_SECONDS = 2.0
HINT_SHARE = 0.1
"""For the search for a list schedule to follow."""

SEARCH_SECONDS = 10.0
SEARCH_SHARE = 0.4
"""For the local search for a schedule to follow."""

STEP_SECONDS = 0.5
STEP_SHARE = 0.05
"""For a plan that differs from the best in a few places."""

STEPS_SHARE = 0.8
"""Of the time left, for all steps together."""

FIRST_SHARE = 0.4
"""Of the time left, for any plan at all, in each kind of search."""


def shorten(
    session: PlannerSession, problem: Problem, best: Schedule | None = None
) -> Schedule | None:
    """The shortest plan of `problem` found before its bound is met or time is over.

    `best`: a plan of it that is known.
    """
    lower = problem.bounds.makespan.value
    if session.planner.under_deadlines:
        search = _MakespanSearch(session, problem, best)
        best = search.run()
    if session.is_over or (best is not None and ticks(problem, best) <= lower):
        return best
    if session.tactics.anytime or best is None:
        plan = session.ask(problem, session.left, enough=lower, first_plan=False)
        best = _shorter(problem, best, plan)
    return best


class _MakespanSearch:
    """The search for one problem: a plan at the bound, a first plan, and steps down from it."""

    def __init__(self, session: PlannerSession, problem: Problem, best: Schedule | None) -> None:
        self.session, self.problem, self.best = session, problem, best
        self.tactics = session.tactics
        self.may_shorten = session.tactics.shortened and _state_meets_resources(problem)

    @property
    def is_done(self) -> bool:
        """Whether the bound is met, or time is over."""
        return self.session.is_over or (
            self.best is not None
            and ticks(self.problem, self.best) <= self.problem.bounds.makespan.value
        )

    def run(self) -> Schedule | None:
        """The shortest plan that is found."""
        if self.tactics.bound and _may_bind(self.problem):
            self._ask_at_bound(self.session.planner.searches[0], BOUND_SECONDS)
        if self.tactics.hint and not self.is_done:
            self._follow_list_schedule()
        if self.tactics.bound and _may_bind(self.problem):
            for search in self.session.planner.searches[1:]:
                self._ask_at_bound(search, BOUND_SHARE * self.session.left)
        for search in dict.fromkeys(("", *self.session.planner.searches)):
            if self.best is None and not self.is_done:
                self._ask(self.problem, None, FIRST_SHARE * self.session.left, search)
        if self.best is None and self.may_shorten and not self.is_done:
            self._ask(self.problem, None, FIRST_SHARE * self.session.left, shortened=True)
        if self.tactics.tighten:
            self._tighten()
        if self.tactics.hint and not self.is_done:
            self._follow_local_search()
        if self.tactics.steps and self.best is not None:
            self._step_down()
        return self.best

    def _ask_at_bound(self, search: str, seconds: float) -> None:
        """Asks for a plan as short as the bound, in one kind of search."""
        if not self.is_done:
            self._ask(
                self.problem,
                self.problem.bounds.makespan.value,
                max(seconds, BOUND_SECONDS),
                search,
            )

    def _ask(
        self,
        problem: Problem,
        deadline: int | None,
        seconds: float,
        search: str = "",
        *,
        shortened: bool = False,
    ) -> bool:
        """Whether one run gave a shorter plan."""
        asked = problem if deadline is None else with_deadline(problem, deadline)
        enough = self.problem.bounds.makespan.value
        plan = self.session.ask(asked, seconds, enough=enough, search=search, shortened=shortened)
        before, self.best = self.best, _shorter(self.problem, self.best, plan)
        return self.best is not before

    def _follow_list_schedule(self) -> None:
        """Asks for the plan that follows a list schedule, if that is shorter than the best."""
        budget = self.session.budget.share(HINT_SHARE).at_most(HINT_SECONDS)
        rng = random.Random(self.session.options.seed)
        least = self.problem.bounds.makespan.value
        self._follow(short_list_schedule(self.problem, least, budget, rng))

    def _follow_local_search(self) -> None:
        """The same with a schedule that local search finds."""
        budget = self.session.budget.share(SEARCH_SHARE).at_most(SEARCH_SECONDS)
        least = self.problem.bounds.makespan.value
        self._follow(searched_schedule(self.problem, least, budget, self.session.options.seed))

    def _follow(self, known: Places | None) -> None:
        if known is None:
            return
        if self.best is None or makespan_of(known) < ticks(self.problem, self.best):
            seconds = max(STEP_SECONDS, STEP_SHARE * self.session.left)
            self._ask(near(self.problem, known, frozenset()), makespan_of(known), seconds)

    def _tighten(self) -> None:
        """Asks for plans of the whole problem a tick shorter, as long as they come quickly."""
        while self.best is not None and not self.is_done:
            seconds = max(STEP_SECONDS, 2 * STEP_SHARE * self.session.left)
            sooner = ticks(self.problem, self.best) - 1
            if self._ask(self.problem, sooner, seconds):
                continue
            if not self.may_shorten or not self._ask(self.problem, sooner, seconds, shortened=True):
                return

    def _step_down(self) -> None:
        """Asks for plans near the best a tick shorter, in ever larger neighbourhoods."""
        rng = random.Random(self.session.options.seed)
        budget = self.session.budget.share(STEPS_SHARE)
        while self.best is not None and not self.is_done:
            known = places_in(self.problem, self.best)
            for free in neighbourhoods(known, rng):
                if self.is_done or budget.is_over:
                    return
                seconds = max(STEP_SECONDS, STEP_SHARE * self.session.left)
                deadline = ticks(self.problem, self.best) - 1
                if self._ask(near(self.problem, known, free), deadline, seconds):
                    break
            else:
                return


def _shorter(problem: Problem, old: Schedule | None, new: Schedule | None) -> Schedule | None:
    if old is None or new is None:
        return old or new
    return new if ticks(problem, new) < ticks(problem, old) else old


def _state_meets_resources(problem: Problem) -> bool:
    """Whether ranks may require another order than tokens; see `irc_pddl21.decoding.rounding`."""
    return problem.has_state and any(
        activity.open_demands or activity.details.all_stock for activity in problem.activities
    )


def _may_bind(problem: Problem) -> bool:
    """Whether a deadline at the bound would say more than the problem does."""
    if not problem.has_contention or not problem.bounds.makespan.value:
        return False
    return problem.deadline is None or problem.deadline > problem.bounds.makespan.value
