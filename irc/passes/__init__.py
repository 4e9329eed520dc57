"""The passes, in the order in which they run: plain functions from `Problem` to `Problem`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from irc.passes.contention import drop_uncontended, merge_pools
from irc.passes.critical_path import bounded_mandatory_part, heads_and_tails
from irc.passes.grid import bound_on_grid
from irc.passes.reduction import reduce_transitively
from irc.problem import Problem


def order_from_state(problem: Problem) -> Problem:
    """Turns state that only orders into precedence; only tasks with state load the code."""
    if not problem.variables:
        return problem
    from irc.passes import state_order

    return state_order.order_from_state(problem)


def bounded_by_stock(problem: Problem) -> Problem:
    """Limits repetitions to what stock allows; only tasks with stock load the code."""
    if not problem.reservoirs:
        return problem
    from irc.passes import stock_occurrences

    return stock_occurrences.bounded_by_stock(problem)


def quick_bounds(problem: Problem) -> Problem:
    """Raises the bound by the work of each resource: what `resource_bounds` begins with."""
    if not problem.has_contention:
        return problem
    core = bounded_mandatory_part(problem)
    if core is not problem:
        bound = quick_bounds(core).bounds.makespan
        return replace(problem, bounds=replace(problem.bounds, makespan=bound))
    from irc.passes.energy import energy_bound

    return energy_bound(problem)


MOST_FOR_SEARCH = 20_000
"""Of more activities no list schedule is made in which a destructive bound is sought: the steps
that this one may take no longer raise the bound, and the schedule takes longer than they do."""


def resource_bounds(problem: Problem) -> Problem:
    """Raises the bound by arguments about resources; without contention there are none."""
    if not problem.has_contention:
        return problem
    core = bounded_mandatory_part(problem)
    if core is not problem:
        bound = resource_bounds(core).bounds.makespan
        return replace(problem, bounds=replace(problem.bounds, makespan=bound))
    from irc.passes.serial_sgs import quick_makespan

    problem = quick_bounds(problem)
    if len(problem.activities) > MOST_FOR_SEARCH:
        return problem
    reached = quick_makespan(problem)
    if reached == problem.bounds.makespan.value:
        return problem
    from irc.passes.destructive import destructive_bound

    return destructive_bound(problem, reached)


def bound_by_open_times(problem: Problem) -> Problem:
    """Raises the bound by open times; only tasks with calendars load the code."""
    if not problem.has_calendars:
        return problem
    from irc.passes.open_time_bound import open_time_bound

    return open_time_bound(problem)


def bound_with_setups(problem: Problem) -> Problem:
    """Raises the bound by the least set-ups; only tasks with set-ups load the code."""
    if not problem.has_setups:
        return problem
    from irc.passes.setup_bound import setup_bound

    return setup_bound(problem)


def bound_with_loads(problem: Problem) -> Problem:
    """Raises the bound by loads; only tasks with batch resources load the code."""
    if not problem.has_batches:
        return problem
    from irc.passes.load_bound import load_bound

    return load_bound(problem)


Pass = Callable[[Problem], Problem]

PASSES: tuple[Pass, ...] = (
    bounded_by_stock,
    order_from_state,
    reduce_transitively,
    merge_pools,
    drop_uncontended,
    heads_and_tails,
    resource_bounds,
    bound_by_open_times,
    bound_with_setups,
    bound_with_loads,
    bound_on_grid,
)


def run_passes(
    problem: Problem,
    passes: tuple[Pass, ...] = PASSES,
    hurried: Callable[[], bool] = lambda: False,
) -> Problem:
    """The problem after all passes; a call that is `hurried` looks for the quick bounds only."""
    for step in passes:
        problem = (quick_bounds if step is resource_bounds and hurried() else step)(problem)
    return problem
