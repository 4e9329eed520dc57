"""What must hold of random tasks: every test run tries some, deep tests go on with others."""

from __future__ import annotations

import irc
from irc.diagnostics import Code, InputError
from irc.driver.solve import solve_task
from irc.model import Task
from irc.schedule import Schedule, Status
from irc.targets import (
    SolveOptions,
)
from irc.validation import validate
from online_cases import replanned
from oracles.brute_force import optimal_makespan
from oracles.online_judge import judge_step
from oracles.online_random import play
from oracles.state_brute_force import Optimum, TooLargeError, optimum
from oracles.state_generators import state_task


def judged(task: Task, schedule: Schedule, best: int | None) -> str:
    """How an answer ended, after checking that it is valid and claims nothing untrue."""
    if schedule.status is Status.UNKNOWN:
        assert schedule.entries == ()
        return "unknown"
    if schedule.status is Status.INFEASIBLE:
        assert best is None
        return "infeasible"
    assert best is not None
    assert validate(task, schedule).valid
    assert schedule.makespan >= best
    (objective,) = schedule.objective
    assert objective.value == schedule.makespan
    assert objective.bound is not None
    assert objective.bound <= best
    if schedule.status is Status.OPTIMAL:
        assert schedule.makespan == best
    return str(schedule.status)


def answered(task: Task, target: str, engine: str, seconds: float | None = None) -> str:
    """What an engine says of a task; "refused" where the checks already see a contradiction."""
    best = optimal_makespan(task)
    options = SolveOptions(target, engine, seconds, workers=1, shortcut=False)
    try:
        answer = solve_task(task, options)
    except InputError as refusal:
        codes = {d.code for d in refusal.report.errors}
    else:
        return judged(task, answer.schedule, best)
    if Code.OUT_OF_RANGE in codes:
        return "beyond the target"
    assert best is None
    return "refused"


def has_no_schedule(task: Task) -> bool:
    """Whether the checks alone say so."""
    codes = {d.code.id[:4] for d in irc.check(task).errors}
    assert codes <= {"IRC3"}
    return bool(codes)


def answer_of(task: Task) -> Schedule | None:
    """What `cpsat` proves: the best schedule, or (None) that there is none."""
    if has_no_schedule(task):
        return None
    schedule = irc.solve(task, "cpsat", shortcut=False, workers=1, time_limit=60)
    assert schedule.status in (Status.OPTIMAL, Status.INFEASIBLE)
    return None if schedule.status is Status.INFEASIBLE else schedule


def agree(task: Task, schedule: Schedule | None, best: Optimum | None) -> None:
    """Fails unless a valid schedule is as good as the best one there is."""
    assert (schedule is None) == (best is None)
    if schedule is None or best is None:
        return
    assert tuple(o.value for o in schedule.objective) == best.vector
    assert validate(task, schedule).valid


def told_of(seed: int) -> set[str]:
    """The codes of all errors about a random task."""
    return {d.code.id for d in irc.check(state_task(seed)).errors}


def has_schedule(seed: int) -> bool:
    """Whether there is a valid schedule; a search that is too large is no proof of none."""
    try:
        return optimum(state_task(seed), max_situations=200_000) is not None
    except TooLargeError:
        return True


def faults_of_repairs(seed: int, operation: str | None) -> list[str]:
    """What the judge holds against the repairs of a random execution."""
    found: list[str] = []
    over: frozenset[str] = frozenset()
    for one in play(seed, operation, replanned):
        judged = judge_step(
            one.task, one.schedule, one.step, one.events, over, max_situations=20_000
        )
        over = judged.over
        found += judged.faults
    return found
