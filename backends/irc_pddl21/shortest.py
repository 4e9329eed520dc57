"""Short schedules from planners that minimise badly: hard deadlines, tighter and tighter.

A planner that minimises by itself tends to stop a little above the optimum, and proves nothing.
But it finds *a* plan under a hard deadline quickly, and the compiler knows a good lower bound.
"""

from __future__ import annotations

from irc.list_schedule import quick_makespan
from irc.problem import Problem
from irc_pddl21.session import Session, ticks, with_deadline

BOUND_SHARE = 0.25
"""Of the time left, for a first plan under the deadline "makespan = bound"."""

TIGHTEN_SHARE = 0.4
"""Of the time left, for a plan shorter than the best."""

LEAST_SHARE = 0.5
"""In seconds: what a run under a deadline gets at least."""


def shorten(session: Session, problem: Problem, best: int | None = None) -> int | None:
    """Looks for ever shorter plans of `problem` until its bound is met or time is over.

    `best`: the makespan of a plan that is known. Returns the least makespan, in ticks.
    """
    lower = problem.bound.value
    hasty = session.planner.under_deadlines
    if hasty and session.tactics.bound and _may_bind(problem):
        found = _under(session, problem, lower, BOUND_SHARE)
        best = _least(best, found)
        if best == lower:
            return best
    if hasty and session.tactics.tighten:
        best = _tighten(session, problem, best)
    if best == lower or session.is_over:
        return best
    if session.tactics.anytime or best is None:
        plan = session.ask(problem, session.left, enough=lower, first_plan=False)
        best = _least(best, None if plan is None else ticks(problem, plan))
    return best


def _tighten(session: Session, problem: Problem, best: int | None) -> int | None:
    """Plans a tick shorter than the best, as long as there are such and there is time."""
    if best is None:
        best = _some_plan(session, problem)
    while best is not None and best > problem.bound.value and not session.is_over:
        found = _under(session, problem, best - 1, TIGHTEN_SHARE)
        if found is None or found >= best:
            break
        best = found
    return best


def _some_plan(session: Session, problem: Problem) -> int | None:
    """A first plan: as short as the list schedule if possible."""
    quick = quick_makespan(problem) if session.tactics.quick and problem.is_plain else None
    if quick is not None and quick > problem.bound.value:
        found = _under(session, problem, quick, BOUND_SHARE)
        if found is not None:
            return found
    plan = session.ask(problem, TIGHTEN_SHARE * session.left, enough=problem.bound.value)
    return None if plan is None else ticks(problem, plan)


def _under(session: Session, problem: Problem, deadline: int, share: float) -> int | None:
    """The makespan of a plan that ends by a deadline, if the planner finds one."""
    seconds = max(LEAST_SHARE, share * session.left)
    plan = session.ask(with_deadline(problem, deadline), seconds, enough=problem.bound.value)
    return None if plan is None else ticks(problem, plan)


def _least(a: int | None, b: int | None) -> int | None:
    return min((m for m in (a, b) if m is not None), default=None)


def _may_bind(problem: Problem) -> bool:
    """Whether a deadline at the bound would say more than the problem does."""
    if not problem.has_contention or not problem.bound.value:
        return False
    return problem.deadline is None or problem.deadline > problem.bound.value
