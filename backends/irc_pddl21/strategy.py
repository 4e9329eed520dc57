"""Which strategy a task gets, and when an answer is proven."""

from __future__ import annotations

from dataclasses import replace
from itertools import takewhile

from irc.passes.critical_path import heads_and_tails
from irc.passes.restrict import settle_presence
from irc.problem import Problem
from irc.problem.objective_values import in_units, worth
from irc.schedule import Status
from irc.targets import Limits, ObjectiveLevel, OnProgress, Outcome, Program
from irc_pddl21.rewards import RewardSearch, shortest_of_best
from irc_pddl21.runs import Planner
from irc_pddl21.selection import SELECTIVE, Selections, Worths, optional_items
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

    The objectives are taken one after the other: reward and cost by choosing what is there, the
    makespan by deadlines. Raises `EngineFailed` or `Refusal` where no run gave an answer.
    """
    session = Session(planner, program, limits, on_progress, tactics)
    problem = program.problem
    first = tuple(takewhile(lambda name: name in SELECTIVE, problem.objectives))
    rest = problem.objectives[len(first) :]
    if first:
        bounds = _by_worth(session, _settled(problem), first, "makespan" in rest)
    else:
        bounds = _by_makespan(session, problem, rest[1:])
    return _told(session, bounds)


def _settled(problem: Problem) -> Problem:
    """The problem with all that must be there mandatory, its makespan not bounded yet."""
    settled = settle_presence(problem)
    return settled if settled is problem else heads_and_tails(settled)


def _by_makespan(session: Session, problem: Problem, behind: tuple[str, ...]) -> dict[str, int]:
    """The makespan first; then, under it as a deadline, what is chosen."""
    best = shorten(session, problem)
    bounds = {"makespan": problem.bound.value}
    selective = tuple(takewhile(lambda name: name in SELECTIVE, behind))
    if best is None or not selective or session.is_over:
        return bounds
    shortest = ticks(problem, best)
    within = _settled(replace(problem, deadline=shortest))
    found = _by_worth(session, within, selective, makespan=False)
    return {**bounds, **found} if shortest == problem.bound.value else bounds


def _by_worth(
    session: Session, problem: Problem, names: tuple[str, ...], makespan: bool
) -> dict[str, int]:
    """The choice of what is there first; then the makespan of the best choice."""
    choice = optional_items(problem, names)
    if choice is None:
        shorten(session, replace(problem, objectives=("makespan",)))
        return {}
    items, worths = choice
    search = RewardSearch(session, Selections(problem, items))
    search.run()
    if search.chosen is None or session.best is None:
        return {}
    bounds = _bounds_of(session, search, worths)
    if makespan and search.plan is not None and not session.is_over:
        _, bound = shortest_of_best(session, search)
        if bound is not None:
            bounds["makespan"] = bound
    return bounds


def _bounds_of(session: Session, search: RewardSearch, worths: Worths) -> dict[str, int]:
    """The bounds on the objectives of a choice: on the first, and on all where it is proven."""
    assert session.best is not None
    values = worth(session.problem, session.best)
    if search.is_proven:
        return {name: int(values[name]) for name in worths.names}
    if search.bound is None or search.value is None:
        return {}
    name = worths.names[0]
    more = worths.first_bound(search.bound - search.value)
    return {name: int(values[name]) + (more if name == "reward" else -more)}


def _told(session: Session, bounds: dict[str, int]) -> Outcome:
    """The outcome with its levels; optimal where each level meets its bound."""
    outcome = session.outcome()
    problem = session.problem
    if outcome.schedule is None:
        return outcome
    values = worth(problem, outcome.schedule)
    levels: list[ObjectiveLevel] = []
    proven = True
    for name in problem.objectives:
        bound = bounds.get(name) if proven else None
        shown = None if bound is None else in_units(problem, name, bound)
        levels.append(ObjectiveLevel(name, values[name], shown))
        proven = proven and shown is not None and shown == values[name]
    status = Status.OPTIMAL if proven else Status.FEASIBLE
    return replace(outcome, status=status, levels=tuple(levels))


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
