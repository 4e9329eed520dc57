"""Lets a planner work beside the usual engine, for tasks that came from PDDL.

What makes a task of PDDL hard is often to find any plan at all, which is what planners are good
at; to prove that none is shorter is what they are bad at. So both work at the same time. If the
usual engine proves its answer, that is the answer, and the planner is ended. Otherwise the better
of the two answers counts. Where the usual engine has an answer before the time is over, and can say
no more, the planner gets as long again and no more: it may be looking for a shorter plan than there
is, for all the time that there is.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import wait
from dataclasses import replace

from irc.diagnostics import Code, Diagnostic, InputError
from irc.driver.judge import Answer
from irc.driver.running import Running
from irc.errors import IrcError
from irc.problem.objective_values import costs
from irc.schedule import Status
from irc.targets import Budget, Cancellation, EngineFailed

Solve = Callable[[Budget], Answer]
"""An answer within a budget."""

LEAST_PATIENCE = 2.0
"""Seconds that the planner gets at least after the usual engine has an answer."""


def with_planner(solve: Solve, plan: Solve, budget: Budget, target: str) -> Answer:
    """The better of the answers of `solve` and of `plan`, which run at the same time.

    `target` names what solves. Raises what `solve` raises if the planner has no answer either.
    """
    running = Running(lambda cancel: _planned(plan, budget, cancel), budget.cancel)
    try:
        answer = solve(budget)
        if answer.schedule.status in (Status.OPTIMAL, Status.INFEASIBLE):
            return answer
        patience = max(LEAST_PATIENCE, budget.elapsed) if answer.schedule.answered else None
        found = _result(running, patience)
    except (EngineFailed, InputError):
        found = _result(running)
        if found is None or not found.schedule.answered:
            raise
        return _with_note(found, f"{target!r} failed")
    finally:
        running.end()
    if found is None or not _is_better(found, answer):
        return answer
    if answer.schedule.answered:
        return _with_note(found, f"{target!r} found no better schedule")
    return _with_note(found, f"{target!r} found no schedule within {budget.elapsed:.1f} s")


def _planned(plan: Solve, budget: Budget, cancel: Cancellation) -> Answer | None:
    """The planner's answer; None where it fails, which is no fault of the task."""
    # (It ends a little before the other one, so that its answer is there by then.)
    own = Budget(budget.left, cancel=cancel).share(0.98)
    try:
        return plan(own)
    except (IrcError, OSError):
        return None


def _result(running: Running[Answer | None], patience: float | None = None) -> Answer | None:
    """The planner's answer; after `patience`, in seconds, the best that it has by then."""
    if wait((running.future,), patience).not_done:
        running.cancellation.cancel()
    return running.future.result()


def _is_better(new: Answer, old: Answer) -> bool:
    if not new.schedule.answered:
        return False
    if not old.schedule.answered:
        return True
    values = [costs(answer.problem, answer.schedule) for answer in (new, old)]
    new_values, old_values = ([own[n] for n in new.problem.objectives] for own in values)
    return new_values < old_values


def _with_note(found: Answer, why: str) -> Answer:
    """The planner's answer, with a note that it is one."""
    note = Diagnostic(
        Code.NO_ANSWER,
        f"{why}; this is the plan of {found.schedule.engine}, which was asked because the task came"
        " from PDDL",
        hint="name the target with --target to ask one of them alone",
    )
    return replace(found, notes=(*found.notes, note))
