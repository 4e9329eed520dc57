"""World changes: changes of state variables by events.

A world change is an action of duration 0 with a fixed start and one effect. It is validated,
re-timed and encoded like any other action, and needs no rule of its own.
"""

from __future__ import annotations

from collections.abc import Mapping

from irc.model import Action, Precedence, StateVariable
from irc.model.base import AnyValue
from irc.model.quantities import Number
from irc.model.times import Clock
from irc.model.world_changes import is_world_change, world_change_id


def world_change(
    variable: StateVariable,
    value: AnyValue,
    at: Number,
    actions: Mapping[str, Action],
    clock: Clock,
) -> tuple[Action, Precedence | None]:
    """(the action that makes the variable `value` at `at`, its precedence if it needs one).

    Its id is "its name at `at`", with a number if that id is taken. It comes after an earlier
    change of the same variable at the same instant: events of one instant keep their order.
    """
    var = variable.id
    name = stem = world_change_id(var, at)
    number, earlier = 1, None
    while name in actions:
        if _is_change(actions[name], var, at, clock):
            earlier = name
        number += 1
        name = f"{stem} ({number})"
    field = "set" if variable.is_number else "value"
    effect = {"at": "start", "var": var, field: variable.read(value)}
    action = Action(id=name, duration=0, start=at, effects=(effect,))
    return action, None if earlier is None else Precedence(before=earlier, after=name)


def _is_change(action: Action, var: str, at: Number, clock: Clock) -> bool:
    """Whether the action is a world change of `var` at this instant."""
    if not is_world_change(action, clock) or action.start is None:
        return False
    return action.effects[0].var == var and clock.number(action.start) == at
