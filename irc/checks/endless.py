"""Checks for more occurrences than can be planned, and for rewards without a limit.

(Of a reward without a limit every schedule could be improved by one more.)
"""

from __future__ import annotations

from collections.abc import Mapping

from irc.diagnostics import Code, Findings
from irc.passes.stock_occurrences import most_by_stock
from irc.passes.unroll import MOST_OCCURRENCES
from irc.problem import Activity, Problem


def check_number(problem: Problem, findings: Findings) -> None:
    """Reports repeated actions that must occur more often than any model holds."""
    least = {
        i: a.details.repeats[0]
        for i, a in enumerate(problem.activities)
        if a.details.repeats is not None
    }
    total = sum(least.values())
    if total > MOST_OCCURRENCES:
        most = max(least, key=lambda i: least[i])
        activity = problem.activities[most]
        findings.add(
            Code.TOO_MANY,
            f"action {activity.id!r} must occur at least {least[most]:,} times"
            + (f", and all repeated actions {total:,} times" if total > least[most] else "")
            + f"; at most {MOST_OCCURRENCES:,} occurrences of repeated actions can be planned",
            (*activity.origin, "occurs"),
            hint="a longer action that stands for several occurrences would do",
        )


def check_endless(problem: Problem, findings: Findings) -> None:
    """Reports actions that may occur any number of times and gain something each time."""
    by_stock = most_by_stock(problem)
    for i, activity in enumerate(problem.activities):
        if activity.details.repeats is None or activity.details.repeats[1] is not None:
            continue
        objective = _growing_objective(problem, activity)
        if objective is None or _is_bounded(problem, i, objective, by_stock):
            continue
        what = "reward" if objective == "reward" else "negative cost"
        findings.add(
            Code.OCCURRENCE,
            f"the {what} of action {activity.id!r} can be collected without limit",
            (*activity.origin, "occurs"),
            hint='give "occurs" a "max", or the task a deadline',
        )


def _growing_objective(problem: Problem, activity: Activity) -> str | None:
    """The first objective that each further occurrence improves."""
    for name in problem.objectives:
        if (name == "reward" and activity.details.reward > 0) or (
            name == "cost" and min(way.cost for way in activity.details.ways) < 0
        ):
            return name
    return None


def _is_bounded(problem: Problem, i: int, objective: str, by_stock: Mapping[int, int]) -> bool:
    """Whether time, a more important objective, or a stock limits the occurrences."""
    activity = problem.activities[i]
    before = problem.objectives[: problem.objectives.index(objective)]
    if activity.duration_min > 0 and (
        problem.effective_deadline(i) is not None
        or activity.latest_start is not None
        or "makespan" in before
    ):
        return True
    return i in by_stock
