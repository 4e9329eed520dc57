"""A first plan from the PDDL that a task was made of.

A planner reads its lifted actions, and makes of them what it needs by itself; our own text of the
task is ground, and has facts for each occurrence. So the original is often solved at once where the
ground text is not. The plan is judged like any other: it is re-timed, and
the validator must accept it as a schedule of the task.

Which kind of search succeeds differs from domain to domain, and the one that does mostly succeeds
within a second. So each gets a little time in turn, and then each gets more.
"""

from __future__ import annotations

from collections.abc import Sequence

from irc_pddl21.search.planner_session import PlannerSession

ROUNDS = (0.2, 0.6)
"""Of the time left at first: what the kinds of search get together in each round, each as much."""

EXHAUSTED = 0.5
"""A search that ends without a plan before this part of its time is not asked again."""


def plan_original(session: PlannerSession) -> None:
    """Asks for plans of the original, if the program is of a task as it was made of PDDL.

    The best plan of the first round that has one is the session's best then, and the answer names
    the original with the planner.
    """
    program = session.program
    if program.task.original is None or program.judge is not None or program.task.events:
        return
    searches: Sequence[str] = session.planner.lifted_searches
    whole = session.left
    for share in ROUNDS:
        searches = _round(session, searches, share * whole / max(1, len(searches)))
        if session.best is not None:
            return


def _round(session: PlannerSession, searches: Sequence[str], seconds: float) -> list[str]:
    """Asks with each kind of search for some seconds; the kinds that may still have a plan.

    The round ends with the first plan that meets the bound on the makespan.
    """
    problem = session.problem
    least = problem.bounds.makespan.value
    waiting = []
    for search in searches:
        before = session.left
        plan = session.ask(problem, seconds, enough=least, search=search, original=True)
        if plan is not None and problem.whole_ticks(plan.makespan) <= least:
            break
        if plan is None and before - session.left >= EXHAUSTED * seconds:
            waiting.append(search)
    return waiting
