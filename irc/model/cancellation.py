"""Actions that an event ends: how a task says that they may not happen any more.

What was cancelled may already have run, so its action stays in the task, or the history could not
be judged by it. It becomes optional with a deadline at the event: what ended by then is still
valid, and nothing of it can happen later.
"""

from __future__ import annotations

from irc.model import Action
from irc.model.quantities import Number
from irc.model.times import Clock


def ended(action: Action, at: Number, clock: Clock) -> Action:
    """The action as it is once it has been cancelled at `at`, in the task's unit."""
    deadline = at if action.deadline is None else min(at, clock.number(action.deadline))
    greatest = action.occurrence_bounds[1]
    occurs = "optional" if greatest == 1 else {"min": 0, "max": greatest}
    fields = {name: getattr(action, name) for name in action.model_fields_set}
    return Action(**{**fields, "occurs": occurs, "deadline": deadline})


def is_over(action: Action, at: Number, clock: Clock) -> bool:
    """Whether the action was cancelled, or need not happen and its deadline has passed."""
    least, _ = action.occurrence_bounds
    if least > 0 or action.deadline is None:
        return False
    return clock.number(action.deadline) <= at
