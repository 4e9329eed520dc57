"""A first plan from the PDDL that a task was made of.

A planner reads its lifted actions, and makes of them what it needs by itself; our own text of the
task is ground, and has facts for each occurrence. So the original is often solved at once where the
ground text is not. The plan is judged like any other: it is re-timed, and
the validator must accept it as a schedule of the task.
"""

from __future__ import annotations

from irc_pddl21.search.planner_session import PlannerSession

ORIGINAL_SHARES = (0.5, 0.7)
"""Of the time left, for the original in one kind of search after the other."""


def plan_original(session: PlannerSession) -> None:
    """Asks for a plan of the original, if the program is of a task as it was made of PDDL.

    The plan is the session's best then, and the answer names the original with the planner.
    """
    program = session.program
    if program.task.original is None or program.judge is not None or program.task.events:
        return
    problem = session.problem
    least = problem.bounds.makespan.value
    searches = reversed(session.planner.searches)
    for search, share in zip(searches, ORIGINAL_SHARES, strict=False):
        seconds = share * session.left
        plan = session.ask(problem, seconds, enough=least, search=search, original=True)
        if plan is not None:
            break
