"""Cancelled actions: how the task in force represents them.

A cancelled action may already have run, so it stays in the task; otherwise the history could not be
validated. It becomes optional with a deadline at the event: occurrences that ended by then stay
valid, and none can happen later. What it had lapses, and stands in the task's `lapsed` for a
repetition.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import TYPE_CHECKING

from irc.model import Action
from irc.model.quantities import Number
from irc.model.times import Clock

if TYPE_CHECKING:
    from irc.model.details import Lapsed


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


def latest(name: str, lapsed: Mapping[str, Lapsed]) -> str:
    """The last repetition of an action, which may be the action itself."""
    while (had := lapsed.get(name)) is not None and had.repetition is not None:
        name = had.repetition
    return name


def repetition_id(action: str, taken: Collection[str], lapsed: Iterable[Lapsed]) -> str:
    """The id of a repetition: "weld (2)", and "weld (3)" for the repetition of that one."""
    repeats = {had.repetition: had.action for had in lapsed if had.repetition is not None}
    first = action
    while first in repeats:
        first = repeats[first]
    number = 2
    while f"{first} ({number})" in taken:
        number += 1
    return f"{first} ({number})"
