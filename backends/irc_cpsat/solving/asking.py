"""Runs CP-SAT so that it can be ended at any moment, and no signal has to wait for it."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from typing import Any

from ortools.sat.python import cp_model

from irc.targets import Budget

_LOOK_SECONDS = 0.03
"""How often the waiting thread looks whether the search is to end."""


def asked(
    solver: cp_model.CpSolver,
    model: cp_model.CpModel,
    budget: Budget,
    callback: cp_model.CpSolverSolutionCallback | None = None,
) -> Any:
    """The status of a search, which ends with the budget or as soon as that is cancelled.

    CP-SAT runs in a thread of its own while this one waits in Python, where signals are handled.
    What is raised meanwhile (`KeyboardInterrupt`) ends the search before it goes on its way.
    """
    # (CP-SAT would take ^C for itself, and nobody else would learn of it.)
    solver.parameters.catch_sigint_signal = False
    if budget.is_limited:
        solver.parameters.max_time_in_seconds = budget.left
    with ThreadPoolExecutor(1, "irc-cpsat") as threads:
        search = threads.submit(solver.solve, model, callback)
        try:
            while not wait((search,), _LOOK_SECONDS).done:
                if budget.is_over:
                    solver.stop_search()
        finally:
            while not wait((search,), _LOOK_SECONDS).done:
                solver.stop_search()
        return search.result()
