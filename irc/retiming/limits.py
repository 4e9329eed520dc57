"""The limits that the earliest schedule of a problem may break."""

from __future__ import annotations

from irc.problem import Problem


def too_late(problem: Problem, i: int, start: int, end: int, since: int = 0) -> str | None:
    """The reason why an activity cannot start or end this late; None if it can.

    `since` is when the problem's time begins, in ticks.
    """
    activity, deadline = problem.activities[i], problem.effective_deadline(i)
    if deadline is not None and end > deadline:
        if deadline < 0:
            return f"{activity.id!r} must have ended by now, but has not begun"
        earliest, limit = problem.time_text(since + end), problem.time_text(since + deadline)
        return f"{activity.id!r} must end by {limit}, but cannot end before {earliest}"
    if activity.start is not None and start > activity.start:
        earliest, fixed = (
            problem.time_text(since + start),
            problem.time_text(since + activity.start),
        )
        return f"{activity.id!r} must start at {fixed}, but cannot start before {earliest}"
    if activity.latest_start is not None and start > activity.latest_start:
        earliest, latest = (
            problem.time_text(since + start),
            problem.time_text(since + activity.latest_start),
        )
        return f"{activity.id!r} must start by {latest}, but cannot start before {earliest}"
    return None
