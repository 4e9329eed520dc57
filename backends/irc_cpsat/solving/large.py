"""Local search alone, for tasks of which a model of the whole would improve nothing."""

from __future__ import annotations

from irc.local_search.search import is_large
from irc.problem import Problem
from irc.problem.decisions import AnswerError
from irc.retiming.listed import listed_schedule
from irc.schedule import Status
from irc.targets import Budget, ObjectiveLevel, OnProgress, Outcome, Progress
from irc_cpsat.solving.improving import Improving

NAME = "local-search"
"""The engine in a schedule that local search alone has made."""

PATIENCE = 0.5
"""The part of the time after which it gives up, where nothing it finds meets a deadline."""


def large_outcome(
    problem: Problem, seed: int, budget: Budget, on_progress: OnProgress | None = None
) -> Outcome | None:
    """The outcome of local search within a budget, with the compiler's bound.

    None where it knows not about all of the problem, or finds no schedule: solvers may.
    """
    if not is_large(problem):
        return None
    improving = Improving(problem, seed)
    if not improving.begin():
        return None
    reported: int | None = None
    while improving.step() and not budget.is_over:
        if improving.found is None and budget.elapsed > PATIENCE * budget.limit:
            return None
        if on_progress is not None and improving.value != reported:
            reported = improving.value
            _tell(improving, budget, on_progress)
    if improving.found is None:
        return None
    try:
        schedule = listed_schedule(problem, improving.found)
    except AnswerError:
        return None  # Exact times may break a limit that holds in whole ticks.
    bound = problem.bounds.makespan.value
    return Outcome(Status.FEASIBLE, NAME, schedule, bound, seconds=budget.elapsed)


def _tell(improving: Improving, budget: Budget, on_progress: OnProgress) -> None:
    problem, found = improving.problem, improving.found
    if improving.value is None or found is None:
        return
    bound = problem.to_units(problem.bounds.makespan.value)
    level = ObjectiveLevel("makespan", problem.to_units(improving.value), bound)
    on_progress(
        Progress(
            budget.elapsed, NAME, "makespan", (level,), lambda: listed_schedule(problem, found)
        )
    )
