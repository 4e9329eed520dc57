"""Short schedules from planners that minimise badly: hard deadlines, tighter and tighter.

A planner that minimises by itself tends to stop a little above the optimum, and proves nothing.
But it finds *a* plan under a hard deadline quickly, and the compiler knows a good lower bound.
Where the planner does not get there in one leap it goes in steps, from a plan it has to one that
is a tick shorter and differs in a few places. The first of them may be the compiler's own list
schedule, handed to the planner as the order to follow.
"""

from __future__ import annotations

import random

from irc.problem import Problem
from irc.schedule import Schedule
from irc_pddl21.hints import hint, hinted_makespan
from irc_pddl21.neighbourhood import known_from, near, neighbourhoods
from irc_pddl21.session import Session, ticks, with_deadline

BOUND_SECONDS = 0.6
BOUND_SHARE = 0.1
"""For a first plan under the deadline "makespan = bound", in each kind of search; seconds, and of
the time left."""

HINT_SECONDS = 2.0
HINT_SHARE = 0.1
"""For the search for a list schedule to follow."""

STEP_SECONDS = 0.5
STEP_SHARE = 0.05
"""For a plan that differs from the best in a few places."""

STEPS_SHARE = 0.8
"""Of the time left, for all steps together."""

FIRST_SHARE = 0.4
"""Of the time left, for any plan at all."""


def shorten(session: Session, problem: Problem, best: Schedule | None = None) -> Schedule | None:
    """Looks for ever shorter plans of `problem` until its bound is met or time is over.

    `best`: a plan of it that is known. Returns the shortest.
    """
    lower = problem.bound.value
    if session.planner.under_deadlines:
        search = _Search(session, problem, best)
        best = search.run()
    if session.is_over or (best is not None and ticks(problem, best) <= lower):
        return best
    if session.tactics.anytime or best is None:
        plan = session.ask(problem, session.left, enough=lower, first_plan=False)
        best = _shorter(problem, best, plan)
    return best


class _Search:
    """One problem's way down: the leap to the bound, a first plan, and steps from it."""

    def __init__(self, session: Session, problem: Problem, best: Schedule | None) -> None:
        self.session, self.problem, self.best = session, problem, best
        self.tactics = session.tactics
        self.loosely = session.tactics.loose and _state_meets_resources(problem)

    @property
    def is_done(self) -> bool:
        """Whether the bound is met, or time is over."""
        return self.session.is_over or (
            self.best is not None and ticks(self.problem, self.best) <= self.problem.bound.value
        )

    def run(self) -> Schedule | None:
        """The shortest plan it comes to."""
        if self.tactics.bound and _may_bind(self.problem):
            self._leap(self.session.planner.searches[0], BOUND_SECONDS)
        if self.tactics.hint and not self.is_done:
            self._follow_a_hint(0)
        if self.tactics.bound and _may_bind(self.problem):
            for search in self.session.planner.searches[1:]:
                self._leap(search, BOUND_SHARE * self.session.left)
        if self.best is None and not self.is_done:
            self._ask(self.problem, None, FIRST_SHARE * self.session.left)
        if self.best is None and self.loosely and not self.is_done:
            self._ask(self.problem, None, FIRST_SHARE * self.session.left, loose=True)
        if self.tactics.tighten:
            self._tighten()
        if self.tactics.hint and not self.is_done:
            self._follow_a_hint(1)
        if self.tactics.steps and self.best is not None:
            self._steps()
        return self.best

    def _leap(self, search: str, seconds: float) -> None:
        """A plan as short as the bound, in one kind of search."""
        if not self.is_done:
            self._ask(self.problem, self.problem.bound.value, max(seconds, BOUND_SECONDS), search)

    def _ask(
        self,
        problem: Problem,
        deadline: int | None,
        seconds: float,
        search: str = "",
        *,
        loose: bool = False,
    ) -> bool:
        """One run; whether it gave something better."""
        asked = problem if deadline is None else with_deadline(problem, deadline)
        enough = self.problem.bound.value
        plan = self.session.ask(asked, seconds, enough=enough, search=search, loose=loose)
        before, self.best = self.best, _shorter(self.problem, self.best, plan)
        return self.best is not before

    def _follow_a_hint(self, attempt: int) -> None:
        """A list schedule, as a plan of the planner's own, if it is shorter than the best."""
        seconds = min(HINT_SECONDS, HINT_SHARE * self.session.left)
        rng = random.Random(self.session.limits.seed + attempt)
        known = hint(self.problem, self.problem.bound.value, seconds, rng)
        if known is None:
            return
        if self.best is None or hinted_makespan(known) < ticks(self.problem, self.best):
            seconds = max(STEP_SECONDS, STEP_SHARE * self.session.left)
            self._ask(near(self.problem, known, frozenset()), hinted_makespan(known), seconds)

    def _tighten(self) -> None:
        """Plans of the whole problem that are a tick shorter, as long as they come quickly."""
        while self.best is not None and not self.is_done:
            seconds = max(STEP_SECONDS, 2 * STEP_SHARE * self.session.left)
            sooner = ticks(self.problem, self.best) - 1
            if self._ask(self.problem, sooner, seconds):
                continue
            if not self.loosely or not self._ask(self.problem, sooner, seconds, loose=True):
                return

    def _steps(self) -> None:
        """Plans near the best that are a tick shorter, from ever larger neighbourhoods."""
        rng = random.Random(self.session.limits.seed)
        reserve = (1 - STEPS_SHARE) * self.session.left
        while self.best is not None and not self.is_done:
            known = known_from(self.problem, self.best)
            for free in neighbourhoods(known, rng):
                if self.is_done or self.session.left < reserve:
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
    """Whether ranks may want another order than tokens do; see `irc_pddl21.loose`."""
    return bool(problem.variables) and any(
        activity.claims or activity.details.stock for activity in problem.activities
    )


def _may_bind(problem: Problem) -> bool:
    """Whether a deadline at the bound would say more than the problem does."""
    if not problem.has_contention or not problem.bound.value:
        return False
    return problem.deadline is None or problem.deadline > problem.bound.value
