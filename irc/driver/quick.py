"""The compiler's own quick schedule: an answer where there is no time to ask an engine."""

from __future__ import annotations

from irc.model.garbage import without_garbage
from irc.passes.serial_sgs import quick_schedule
from irc.problem import Problem
from irc.problem.decisions import AnswerError
from irc.retiming.listed import listed_schedule
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule, Status
from irc.targets import Outcome

QUICK_ENGINE = "list-schedule"
"""The name of the engine in a schedule that no solver has made or improved."""


@without_garbage()
def quick_outcome(problem: Problem) -> Outcome | None:
    """The list schedule of a problem with resources and lags alone, or the warm start of a running
    one; None where there is neither.
    """
    schedule = _listed(problem) if problem.is_plain else None
    if schedule is None and problem.previous.warm_start:
        schedule = schedule_of(problem, problem.previous.warm_start)
    if schedule is None:
        return None
    return Outcome(Status.FEASIBLE, QUICK_ENGINE, schedule, problem.bounds.makespan.value)


def _listed(problem: Problem) -> Schedule | None:
    found = quick_schedule(problem)
    if found is None:
        return None
    try:
        return listed_schedule(problem, found)
    except AnswerError:
        return None  # Exact times may break a limit that the rule has kept in whole ticks.
