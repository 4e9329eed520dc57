"""World changes: how a task represents changes of a state variable by events.

Such a change is an action of no duration, with a fixed start and one effect. Its id names it:
"`var` at `time`", with a number where that is taken.
"""

from __future__ import annotations

import re

from irc.model import Action, DurationRange
from irc.model.quantities import Number
from irc.model.times import Clock, format_number

_NUMBER = re.compile(r"( \(\d+\))?")

_FIELDS = frozenset(["id", "duration", "start", "effects"])


def world_change_id(var: str, at: Number) -> str:
    """The id of a world change of `var` at `at`, without a number."""
    return f"{var} at {format_number(at)}"


def is_world_change(action: Action, clock: Clock) -> bool:
    """Whether an action is a world change: it only changes one variable, at the time in its id."""
    if action.start is None or len(action.effects) != 1 or not action.model_fields_set <= _FIELDS:
        return False
    (effect,) = action.effects
    duration = action.duration
    if (
        effect.at != "start"
        or effect.add is not None
        or isinstance(duration, DurationRange)
        or duration is None
    ):
        return False
    stem = world_change_id(effect.var, clock.number(action.start))
    return (
        clock.number(duration) == 0
        and action.id.startswith(stem)
        and _NUMBER.fullmatch(action.id, len(stem)) is not None
    )
