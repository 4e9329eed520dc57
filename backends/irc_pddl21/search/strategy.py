"""The strategy for a task by its objectives, and the proof of its answer."""

from __future__ import annotations

from dataclasses import replace
from itertools import takewhile

from irc.diagnostics import Code, Diagnostic
from irc.model.objectives import is_sum
from irc.passes.critical_path import TimesContradictError, heads_and_tails
from irc.passes.restrict import decide_presence
from irc.problem import Problem
from irc.problem.objective_values import in_units, schedule_values
from irc.schedule import Status
from irc.targets import Budget, ObjectiveLevel, Outcome, Program, SolveOptions
from irc_pddl21.objective_values import objective_values
from irc_pddl21.planners.planner import Planner
from irc_pddl21.search.choice_search import ChoiceSearch
from irc_pddl21.search.choices import choices_of
from irc_pddl21.search.dates import DATED, by_dates
from irc_pddl21.search.limits import by_limits
from irc_pddl21.search.makespan import shorten
from irc_pddl21.search.order_search import OrderSearch
from irc_pddl21.search.original import plan_original
from irc_pddl21.search.planner_session import ALL_TACTICS, PlannerSession, Tactics, ticks
from irc_pddl21.search.selection import (
    SELECTIVE,
    ObjectiveWeights,
    SelectionSpace,
    optional_items,
)
from irc_pddl21.search.selection_search import SelectionSearch, shortest_of_best
from irc_pddl21.search.shortest_selection import shortest_of_selections

_CONTRADICTION = Diagnostic(
    Code.LAGS,
    "the lags and durations of the actions that must be present contradict each other",
    hint="`irc explain` shows which of them",
)

ORDERS_SHARE = 0.5
"""Of the time left, for a search over orders."""

PREPARING_SHARE = 0.1
"""Of the time left, for the bounds on selections before the search."""


def solve_with(
    planner: Planner,
    program: Program,
    options: SolveOptions,
    budget: Budget,
    tactics: Tactics = ALL_TACTICS,
) -> Outcome:
    """The best answer of one planner within the budget, with its status.

    The objectives are taken one after the other: reward and cost by selecting optional items, the
    makespan by deadlines. Raises `EngineFailed` or `Refusal` where no run gave an answer.
    """
    session = PlannerSession(planner, program, options, budget, tactics)
    problem = program.problem
    try:
        fixed = _with_fixed_presence(problem)
    except TimesContradictError:
        return Outcome(Status.INFEASIBLE, planner.name, notes=(_CONTRADICTION,))
    if session.tactics.original:
        plan_original(session)
    if not counts_orders(problem):
        return _outcome(session, _by_first_objective(session, problem, fixed))
    search = OrderSearch(session, fixed, session.budget.share(ORDERS_SHARE))
    search.run()
    bounds = _bounds_on_levels(search)
    if not _is_proven(session, bounds):
        others = _by_first_objective(session, problem, fixed)
        session.limits.clear()
        search.go_on(session.budget)
        bounds = _greater(_bounds_on_levels(search), others)
    return _outcome(session, bounds)


def counts_orders(problem: Problem) -> bool:
    """Whether orders on resources are to be searched: for set-ups, and for weighted sums."""
    names = problem.objectives
    return problem.has_setups or any("setup" in name or is_sum(name) for name in names)


def _bounds_on_levels(search: OrderSearch) -> dict[str, int]:
    """The bounds by a search over orders, each as far as it holds."""
    if search.bounds is None:
        return {}
    value = search.value
    found: dict[str, int] = {}
    levels = zip(search.problem.objectives, search.bounds, strict=True)
    for k, (name, bound) in enumerate(levels):
        # (A bound on a level holds where no level before it can be better.)
        if not k or (value is not None and value[:k] == search.bounds[:k]):
            found[name] = -bound if name == "reward" else bound
    return found


def _greater(one: dict[str, int], other: dict[str, int]) -> dict[str, int]:
    """The tighter of two bounds on each objective; a reward is bounded from above."""
    both = {**one, **other}
    return {
        name: bound
        if name not in one or name not in other
        else (min if name == "reward" else max)(one[name], other[name])
        for name, bound in both.items()
    }


def _by_first_objective(
    session: PlannerSession, problem: Problem, fixed: Problem
) -> dict[str, int]:
    """The bounds by the strategy that fits the first objective.

    `fixed`: the problem in which all that must be present is mandatory.
    """
    first = tuple(takewhile(lambda name: name in SELECTIVE, problem.objectives))
    rest = problem.objectives[len(first) :]
    if first:
        return _by_selection(session, fixed, first, "makespan" in rest)
    if rest[0] in DATED:
        return {"makespan": fixed.bounds.makespan.value, **by_dates(session, fixed, rest[0])}
    if rest[0] == "makespan":
        return _by_makespan(session, problem, fixed, rest[1:])
    return by_limits(session, fixed)


def _with_fixed_presence(problem: Problem) -> Problem:
    """The problem in which all that must be present is mandatory, its makespan not bounded yet."""
    fixed = decide_presence(problem)
    return fixed if fixed is problem else heads_and_tails(fixed)


def _by_makespan(
    session: PlannerSession, problem: Problem, fixed: Problem, behind: tuple[str, ...]
) -> dict[str, int]:
    """The bounds of the makespan first; then, under it as a deadline, of the selection.

    `fixed`: the problem in which all that must be present is mandatory.
    """
    best, bound = shortest_of_selections(session, fixed)
    best = best or session.best
    if bound is not None and bound > problem.bounds.makespan.value:
        problem = problem.with_bound(bound, "the optional items, one selection after the other")
    best = shorten(session, problem, best)
    bounds = {"makespan": problem.bounds.makespan.value}
    selective = tuple(takewhile(lambda name: name in SELECTIVE, behind))
    if best is None or not selective or session.is_over:
        return bounds
    shortest = ticks(problem, best)
    within = _with_fixed_presence(replace(problem, deadline=shortest))
    found = _by_selection(session, within, selective, makespan=False)
    return {**bounds, **found} if shortest == problem.bounds.makespan.value else bounds


def _by_selection(
    session: PlannerSession, problem: Problem, names: tuple[str, ...], makespan: bool
) -> dict[str, int]:
    """The bounds of the selection first; then of the makespan of the best selection."""
    if "cost" in names and any(m.cost for a in problem.activities for m in a.details.modes):
        return _by_choices(session, problem, names, makespan)
    items, weights, all_there = optional_items(problem, names)
    part = session.budget.share(PREPARING_SHARE)
    search = SelectionSearch(session, SelectionSpace(problem, items, lambda: part.is_over))
    search.run()
    if search.chosen is None or session.best is None or not all_there:
        return {}
    bounds = _bounds_of(session, search, weights)
    if makespan and search.plan is not None and not session.is_over:
        _, bound = shortest_of_best(session, search)
        if bound is not None:
            bounds["makespan"] = bound
    return bounds


def _by_choices(
    session: PlannerSession, problem: Problem, names: tuple[str, ...], makespan: bool
) -> dict[str, int]:
    """The bounds where modes have costs: of the best choice of modes and of optional items."""
    choices, base, all_there = choices_of(problem, names)
    search = ChoiceSearch(session, problem, names, choices, base)
    search.run()
    if makespan and search.plan is not None and search.planned is not None:
        shorten(session, search.planned, search.plan)
    if not all_there or search.bound is None:
        return {}
    if search.value == search.bound:
        known = dict(zip(names, search.bound, strict=True))
    else:
        known = {names[0]: search.bound[0]}
    return {name: -value if name == "reward" else value for name, value in known.items()}


def _bounds_of(
    session: PlannerSession, search: SelectionSearch, weights: ObjectiveWeights
) -> dict[str, int]:
    """The bounds on the objectives of a selection: on the first, and on all where it is proven."""
    assert session.best is not None
    values = schedule_values(session.problem, session.best)
    if search.is_proven:
        return {name: int(values[name]) for name in weights.names}
    if search.bound is None or search.value is None:
        return {}
    name = weights.names[0]
    more = weights.first_bound(search.bound - search.value)
    return {name: int(values[name]) + (more if name == "reward" else -more)}


def _is_proven(session: PlannerSession, bounds: dict[str, int]) -> bool:
    """Whether the best plan meets the bound of each level."""
    outcome = session.best and _outcome(session, bounds)
    return outcome is not None and outcome.status is Status.OPTIMAL


def _outcome(session: PlannerSession, bounds: dict[str, int]) -> Outcome:
    """The outcome with its levels; optimal where each level meets its bound."""
    outcome = session.outcome()
    problem = session.problem
    if outcome.schedule is None:
        return outcome
    values = schedule_values(problem, outcome.schedule)
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
    return (
        new
        if objective_values(problem, new.schedule) < objective_values(problem, old.schedule)
        else old
    )


def proven(problem: Problem, outcome: Outcome) -> bool:
    """Whether no better answer is possible."""
    if outcome.status is Status.OPTIMAL:
        return True
    schedule = outcome.schedule
    if schedule is None or problem.objectives != ("makespan",):
        return False
    return schedule.makespan == problem.to_units(problem.bounds.makespan.value)
