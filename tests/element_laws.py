"""What must hold of random tasks with one element of the vocabulary: every road says the same."""

from __future__ import annotations

import irc
from irc.diagnostics import InputError
from irc.model import Task
from irc.model.quantities import Number
from irc.schedule import Schedule, Status
from irc.targets import Refusal
from irc.validation import validate

Best = tuple[Number, ...] | None
"""The best values of the objectives, in order; None where nothing is valid."""


def judge_exact(task: Task, best: Best) -> str:
    """What `cpsat` answers, after checking that it is the best answer, and proven."""
    schedule = solve(task, "cpsat")
    if schedule is None or schedule.status is Status.INFEASIBLE:
        assert best is None, f"said to be infeasible; {best} is possible"
        return "infeasible"
    assert schedule.status is Status.OPTIMAL, schedule.status
    assert best is not None, "an answer where none is possible"
    found = tuple(o.value for o in schedule.objective)
    assert found == best, f"{found} instead of {best}"
    assert validate(task, schedule).valid
    return "optimal"


def judge_planner(task: Task, best: Best, seconds: float = 2.0) -> str:
    """How `pddl21` answers, after checking that it says nothing untrue."""
    try:
        schedule = solve(task, "pddl21", seconds)
    except Refusal:
        return "refused"
    if schedule is None or schedule.status is Status.INFEASIBLE:
        assert best is None, f"said to be infeasible; {best} is possible"
        return "infeasible"
    if schedule.status is Status.UNKNOWN:
        return "unknown"
    assert best is not None, "an answer where none is possible"
    assert validate(task, schedule).valid
    found = tuple(o.value for o in schedule.objective)
    if schedule.status is Status.OPTIMAL:
        assert found == best, f"{found} called optimal instead of {best}"
    names = task.objective
    assert not _is_better(names, found, best), f"{found} is better than {best}"
    first = schedule.objective[0]
    if first.bound is not None:
        assert not _is_better(names[:1], best[:1], (first.bound,)), f"bound {first.bound}: {best}"
    return str(schedule.status)


def _is_better(names: tuple[object, ...], found: Best, best: Best) -> bool:
    assert found is not None
    assert best is not None
    signs = [-1 if name == "maximize_reward" else 1 for name in names]

    def key(values: tuple[Number, ...]) -> list[Number]:
        return [sign * value for sign, value in zip(signs, values, strict=True)]

    return key(found) < key(best)


def solve(task: Task, target: str, seconds: float = 60) -> Schedule | None:
    """The answer of a target; None where the checks alone say that there is none."""
    report = irc.check(task)
    codes = {d.code.id[:4] for d in report.errors}
    assert codes <= {"IRC3"}, str(report)
    if codes:
        return None
    try:
        return irc.solve(task, target, shortcut=False, workers=1, time_limit=seconds)
    except InputError as refusal:
        raise Refusal(str(refusal.report)) from None
