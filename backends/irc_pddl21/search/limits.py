"""Objectives that a planner cannot bound by itself: plans within a limit on set-ups, or on the end.

A limit on the time or the cost of set-ups is a counter in the text, and a limit on the makespan is
a deadline. So the planner is asked for a plan that has less of one part and no more of the others.
"""

from __future__ import annotations

from irc.model.objectives import terms_of
from irc.passes.setup_totals import SETUP_OBJECTIVES, least_setups
from irc.problem import Problem
from irc.problem.objective_values import schedule_values
from irc.schedule import Schedule
from irc_pddl21.search.makespan import STEP_SECONDS, STEP_SHARE, shorten
from irc_pddl21.search.planner_session import PlannerSession, ticks, with_deadline

FIRST_SHARE = 0.3
"""Of the time left, for any plan at all."""


def by_limits(session: PlannerSession, problem: Problem) -> dict[str, int]:
    """The bounds on set-ups as the first objective, after plans within lower and lower limits."""
    name = problem.objectives[0]
    _first_plan(session, problem)
    if name in SETUP_OBJECTIVES:
        least = least_setups(problem, name)
        _lower(session, problem, name, least)
        if "makespan" in problem.objectives and session.best is not None:
            shorten(session, problem, session.best)
        return {name: least}
    _lower_parts(session, problem, name)
    return {}


def _first_plan(session: PlannerSession, problem: Problem) -> None:
    if session.best is None and not session.is_over:
        session.ask(problem, FIRST_SHARE * session.left, enough=0)
    if session.best is None and not session.is_over:
        shorten(session, problem)


def _lower(session: PlannerSession, problem: Problem, name: str, least: int) -> None:
    """Asks for plans with less and less of one kind of set-ups; the limit stays at the best."""
    tried = least
    while session.best is not None and not session.is_over:
        value = _part(session, session.best, name)
        if value <= least:
            break
        session.limits[name] = min(tried, value - 1)
        plan = session.ask(problem, _seconds(session), enough=0)
        if plan is None and tried >= value - 1:
            break
        tried = value - 1 if plan is None else least
    if session.best is not None:
        session.limits[name] = _part(session, session.best, name)


def _lower_parts(session: PlannerSession, problem: Problem, name: str) -> None:
    """Asks for plans with less of one part of a sum, and no more of the others."""
    parts = [part for _, part in terms_of(name) if part in ("makespan", "setup_time", "setup_cost")]
    better = True
    while better and session.best is not None and not session.is_over:
        better = False
        for part in parts:
            before = session.best
            _ask_less(session, problem, parts, part)
            better = better or session.best is not before
    session.limits.clear()


def _ask_less(session: PlannerSession, problem: Problem, parts: list[str], part: str) -> None:
    best = session.best
    if best is None or session.is_over:
        return
    values = {name: _part(session, best, name) - (name == part) for name in parts}
    if values[part] < 0:
        return
    session.limits = {name: value for name, value in values.items() if name != "makespan"}
    if "makespan" in values:
        problem = with_deadline(problem, values["makespan"])
    session.ask(problem, _seconds(session), enough=0)


def _part(session: PlannerSession, schedule: Schedule, name: str) -> int:
    """The value of an objective in ticks, or in whole numbers."""
    if name == "makespan":
        return ticks(session.problem, schedule)
    value = schedule_values(session.problem, schedule)[name]
    return session.problem.whole_ticks(value) if name == "setup_time" else int(value)


def _seconds(session: PlannerSession) -> float:
    return max(STEP_SECONDS, STEP_SHARE * session.left)
