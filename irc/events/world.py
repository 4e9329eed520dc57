"""World changes: changes of state variables by events.

A world change is an action of duration 0 with a fixed start and one effect. It is validated,
re-timed and encoded like any other action, and needs no rule of its own.
"""

from __future__ import annotations

from collections.abc import Mapping

from irc.model import Action, Precedence
from irc.model.quantities import Number
from irc.model.times import Clock, format_number


def world_change(
    var: str, value: bool | str, at: Number, actions: Mapping[str, Action], clock: Clock
) -> tuple[Action, Precedence | None]:
    """(the action that makes `var` become `value` at `at`, its precedence if it needs one).

    Its id is "`var` at `at`", with a number if that id is taken. It comes after an earlier change
    of the same variable at the same instant: events of one instant keep their order.
    """
    name = stem = f"{var} at {format_number(at)}"
    number, earlier = 1, None
    while name in actions:
        if _is_change(actions[name], var, at, clock):
            earlier = name
        number += 1
        name = f"{stem} ({number})"
    action = Action(
        id=name,
        duration=0,
        start=at,
        effects=({"at": "start", "var": var, "value": value},),
    )
    return action, None if earlier is None else Precedence(before=earlier, after=name)


def _is_change(action: Action, var: str, at: Number, clock: Clock) -> bool:
    """Whether the action only changes `var` at this instant."""
    if action.model_fields_set != {"id", "duration", "start", "effects"} or action.start is None:
        return False
    (effect, *more) = action.effects
    return not more and effect.var == var and clock.number(action.start) == at
