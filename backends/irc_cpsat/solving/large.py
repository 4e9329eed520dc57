"""Local search alone, for tasks of which a model of the whole would improve nothing."""

from __future__ import annotations

from irc.local_search.search import LocalSearch, is_large, search_of
from irc.local_search.ways import NotApplicable
from irc.problem import Problem
from irc.problem.decisions import AnswerError
from irc.retiming.listed import listed_schedule
from irc.schedule import Schedule, Status
from irc.targets import Budget, ObjectiveLevel, OnProgress, Outcome, Progress

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
    try:
        search = search_of(problem, seed)
    except NotApplicable:
        return None
    bound = problem.bounds.makespan.value
    reported: int | None = None
    while not budget.is_over and (search.value is None or search.value > bound):
        search.step()
        if not _is_in_time(problem, search):
            if budget.elapsed > PATIENCE * budget.limit:
                return None
        elif on_progress is not None and search.value != reported:
            reported = search.value
            _tell(problem, search, budget, on_progress)
    # (Read once: of many activities that takes as long as some steps.)
    found = search.found()
    if found is None or not _is_in_time(problem, search):
        return None
    try:
        schedule = listed_schedule(problem, found)
    except AnswerError:
        return None  # Exact times may break a limit that holds in whole ticks.
    return Outcome(Status.FEASIBLE, NAME, schedule, bound, seconds=budget.elapsed)


def _is_in_time(problem: Problem, search: LocalSearch) -> bool:
    """Whether there is a schedule that ends by the deadline and the horizon."""
    limits = (limit for limit in (problem.deadline, problem.horizon) if limit is not None)
    value = search.value
    return value is not None and all(value <= limit for limit in limits)


def _tell(problem: Problem, search: LocalSearch, budget: Budget, on_progress: OnProgress) -> None:
    """Reports the best schedule so far; it is read when it is asked for."""
    assert search.value is not None
    bound = problem.to_units(problem.bounds.makespan.value)
    level = ObjectiveLevel("makespan", problem.to_units(search.value), bound)

    def best() -> Schedule:
        found = search.found()
        assert found is not None
        return listed_schedule(problem, found)

    on_progress(Progress(budget.elapsed, NAME, "makespan", (level,), best))
