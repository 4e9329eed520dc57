"""Solves a task that is kept as columns: only precedences bind its actions, and no solver is asked.

The answer is the one that all other code of the driver gives for the same task, at a tenth of its
cost: neither a `Problem` nor an action is made before something asks for it.
"""

from __future__ import annotations

from functools import partial

from irc.driver.compile import lower_for
from irc.driver.judge import SHORTCUT_ENGINE, Answer, _approved
from irc.model import Task
from irc.model.canonical import task_sha256
from irc.model.features import Feature
from irc.model.garbage import without_garbage
from irc.problem.precedence_times import earliest_times
from irc.schedule import ObjectiveValue, Schedule, Status
from irc.schedule.entry import plain_entries
from irc.targets import Backend, Budget, SolveOptions

_NEEDED = {Feature.PRECEDENCE, Feature.MAKESPAN}
"""The features of a task that is kept as columns."""


@without_garbage()
def by_columns(
    task: Task, backend: Backend, options: SolveOptions, budget: Budget
) -> Answer | None:
    """The validated answer; None for a task that has no columns or is infeasible, where a target
    does not support what it has, or where options ask for a solver.
    """
    columns = task.columns
    if columns is None or not options.shortcut or not set(backend.supports) >= _NEEDED:
        return None
    times = earliest_times(columns.durations, columns.following)
    if times is None:
        return None
    ends = [s + d for s, d in zip(times.starts, columns.durations, strict=True)]
    rows = sorted(zip(times.starts, ends, columns.ids, strict=True))
    schedule = Schedule(
        plain_entries(rows),
        status=Status.OPTIMAL,
        objective=(ObjectiveValue("makespan", times.makespan, times.makespan),),
        task=task.name,
        task_sha256=task_sha256(task),
        target=backend.name,
        engine=SHORTCUT_ENGINE,
        seconds=round(budget.elapsed, 3),
        time_unit=task.time_unit,
        repeatable=True if options.deterministic else None,
        made_for=task,
    )
    approved = _approved(task, schedule)
    return Answer(approved, partial(lower_for, task, backend), times=times)
