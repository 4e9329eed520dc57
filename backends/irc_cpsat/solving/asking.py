"""Runs CP-SAT so that it can be ended at any moment, and no signal has to wait for it."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, wait
from threading import Thread
from typing import Any

from ortools.sat.python import cp_model

from irc.problem import Problem
from irc.targets import Budget

_LOOK_SECONDS = 0.03
"""Between two looks of the waiting thread at its budget."""


def solver_for(problem: Problem, seed: int) -> cp_model.CpSolver:
    """A solver for models of a problem.

    Where activities have calendars or pause, its presolve looks for no symmetry, nor then for
    equal columns: on some of these models the check `VarToConstraints(var).empty()` of CP-SAT 9.15
    fails in that step, which ends the whole process.
    """
    solver = cp_model.CpSolver()
    solver.parameters.random_seed = seed
    if problem.has_work:
        solver.parameters.symmetry_level = 0
    return solver


def asked(
    solver: cp_model.CpSolver,
    model: cp_model.CpModel,
    budget: Budget,
    callback: cp_model.CpSolverSolutionCallback | None = None,
    ended: Callable[[], bool] = lambda: False,
) -> Any:
    """The status of a search, which ends with the budget or as soon as that is cancelled.

    It ends earlier where `ended`, which is asked again and again meanwhile, says so.

    A budget of work limits the search by CP-SAT's own measure, with one worker.

    CP-SAT runs in a thread of its own while this one waits in Python, where signals are handled.
    What is raised meanwhile (`KeyboardInterrupt`) ends the search before it goes on its way.
    """
    # (CP-SAT would take ^C for itself, and nobody else would learn of it.)
    solver.parameters.catch_sigint_signal = False
    work = budget.work
    if work is not None:
        solver.parameters.num_workers = 1
        solver.parameters.max_deterministic_time = budget.left
    elif budget.is_limited:
        solver.parameters.max_time_in_seconds = budget.left
    search: Future[Any] = Future()
    # (A pool would make the whole program wait for it at its end.)
    arguments = (search, solver, model, callback)
    Thread(target=_search, args=arguments, name="irc-cpsat", daemon=True).start()
    try:
        while not wait((search,), _LOOK_SECONDS).done:
            if budget.is_over or ended():
                solver.stop_search()
    finally:
        while not wait((search,), _LOOK_SECONDS).done:
            solver.stop_search()
    status = search.result()
    if work is not None:
        response: Any = solver.response_proto
        work.add(response.deterministic_time)
    return status


def _search(
    search: Future[Any],
    solver: cp_model.CpSolver,
    model: cp_model.CpModel,
    callback: cp_model.CpSolverSolutionCallback | None,
) -> None:
    try:
        search.set_result(solver.solve(model, callback))
    except BaseException as error:  # noqa: BLE001 - it is raised where the call waits
        search.set_exception(error)
