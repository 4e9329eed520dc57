"""Cancelled actions: how the task in force represents them.

A cancelled action may already have run, so it stays in the task; otherwise the history could not be
validated. It becomes optional with a deadline at the event: occurrences that ended by then stay
valid, and none can happen later.
"""

from __future__ import annotations

from irc.model import Action
from irc.model.quantities import Number
from irc.model.times import Clock


def ended(action: Action, at: Number, clock: Clock) -> Action:
    """The action after it was cancelled at `at`, in the task's unit."""
    deadline = at if action.deadline is None else min(at, clock.number(action.deadline))
    greatest = action.occurrence_bounds[1]
    occurs = "optional" if greatest == 1 else {"min": 0, "max": greatest}
    fields = {name: getattr(action, name) for name in action.model_fields_set}
    return Action(**{**fields, "occurs": occurs, "deadline": deadline})


def is_over(action: Action, at: Number, clock: Clock) -> bool:
    """Whether the action was cancelled, or is optional and its deadline has passed."""
    least, _ = action.occurrence_bounds
    if least > 0 or action.deadline is None:
        return False
    return clock.number(action.deadline) <= at
