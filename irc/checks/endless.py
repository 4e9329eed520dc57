"""Rewards that could be collected without end: an objective that no schedule is the best of."""

from __future__ import annotations

from irc.diagnostics import Code, Findings
from irc.problem import Activity, Problem


def check_endless(problem: Problem, findings: Findings) -> None:
    """Tells of actions that may occur as often as one likes, and are worth more each time."""
    refillers = _refillers(problem)
    for i, activity in enumerate(problem.activities):
        if activity.details.repeats is None or activity.details.repeats[1] is not None:
            continue
        worth = _what_grows(problem, activity)
        if worth is None or _is_bounded(problem, i, worth, refillers):
            continue
        what = "reward" if worth == "reward" else "negative cost"
        findings.add(
            Code.OCCURRENCE,
            f"the {what} of action {activity.id!r} could be collected without end",
            (*activity.origin, "occurs"),
            hint='give "occurs" a "max", or the task a deadline',
        )


def _what_grows(problem: Problem, activity: Activity) -> str | None:
    """The first objective that each further occurrence serves."""
    for name in problem.objectives:
        if (name == "reward" and activity.details.reward > 0) or (
            name == "cost" and activity.details.cost < 0
        ):
            return name
    return None


def _is_bounded(problem: Problem, i: int, worth: str, refillers: dict[int, set[int]]) -> bool:
    """Whether time, an objective that counts more, or a stock ends it."""
    activity = problem.activities[i]
    before = problem.objectives[: problem.objectives.index(worth)]
    if activity.duration_min > 0 and (
        problem.effective_deadline(i) is not None
        or activity.latest_start is not None
        or "makespan" in before
    ):
        return True
    net: dict[int, int] = {}
    for change in activity.details.stock:
        net[change.reservoir] = net.get(change.reservoir, 0) + change.amount
    # Only what no other repeated action refills runs out.
    return any(amount < 0 and refillers[k] <= {i} for k, amount in net.items())


def _refillers(problem: Problem) -> dict[int, set[int]]:
    """For each reservoir the actions that refill it as often as one likes."""
    refilled: dict[int, set[int]] = {k: set() for k in range(len(problem.reservoirs))}
    for i, activity in enumerate(problem.activities):
        repeats = activity.details.repeats
        if repeats is not None and repeats[1] is None:
            for change in activity.details.stock:
                if change.amount > 0:
                    refilled[change.reservoir].add(i)
    return refilled
