"""Which strategy a task gets, and when an answer is proven."""

from __future__ import annotations

from irc.backend import Limits, OnProgress, Outcome, Program
from irc.problem import Problem
from irc.schedule import Status
from irc_pddl21.runs import Planner
from irc_pddl21.session import ALL_TACTICS, Session, Tactics, ticks
from irc_pddl21.shortest import shorten
from irc_pddl21.worth import worth_of


def solve_with(
    planner: Planner,
    program: Program,
    limits: Limits,
    on_progress: OnProgress | None = None,
    tactics: Tactics = ALL_TACTICS,
) -> Outcome:
    """The best answer of one planner within the limits, with an honest status.

    Raises `EngineFailed` or `Refusal` where no run of it gave an answer.
    """
    session = Session(planner, program, limits, on_progress, tactics)
    problem = program.problem
    best = shorten(session, problem)
    met = best is not None and ticks(problem, best) <= problem.bound.value
    return session.outcome(Status.OPTIMAL if met and problem.objectives == ("makespan",) else None)


def better(problem: Problem, old: Outcome | None, new: Outcome) -> Outcome:
    """The outcome with the better schedule, or the better proof; the older one of equals."""
    if old is None or old.schedule is None:
        return new
    if new.schedule is None or old.status is Status.OPTIMAL:
        return old
    if new.status is Status.OPTIMAL:
        return new
    return new if worth_of(problem, new.schedule) < worth_of(problem, old.schedule) else old


def proven(problem: Problem, outcome: Outcome) -> bool:
    """Whether nothing better can come."""
    if outcome.status is Status.OPTIMAL:
        return True
    schedule = outcome.schedule
    if schedule is None or problem.objectives != ("makespan",):
        return False
    return schedule.makespan == problem.to_units(problem.bound.value)
