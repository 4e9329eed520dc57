"""Tests and changes of a variable by happenings, whether it has values or is a number.

A need is a value, or the `Between` of a number; a change is a value, or a `NumberChange`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import NamedTuple

from irc.model import Condition, Effect, StateGoal, StateVariable
from irc.model.base import StateValue
from irc.model.quantities import Number
from irc.model.state_values import limits_text, value_text
from irc.model.times import format_number

Value = StateValue | Number | None
"""The value of a state variable; None before any effect has given it one."""


class Between(NamedTuple):
    """The levels within [least, greatest]; None: no limit."""

    least: Number | None
    greatest: Number | None


class NumberChange(NamedTuple):
    """A change of a number by an amount, or, if it `sets`, to an amount."""

    amount: Number
    sets: bool


Need = StateValue | Between | None
"""The test of a variable by a happening."""

Given = StateValue | NumberChange
"""The change of a variable by a happening."""


def meets(value: Value, need: Need) -> bool:
    """Whether a value is what is needed."""
    if not isinstance(need, Between):
        return value == need
    if not isinstance(value, (int, Fraction)):
        return False
    return (need.least is None or value >= need.least) and (
        need.greatest is None or value <= need.greatest
    )


def changed(value: Value, change: Given) -> Value:
    """The value after a change."""
    if not isinstance(change, NumberChange):
        return change
    if change.sets or not isinstance(value, (int, Fraction)):
        return change.amount
    return value + change.amount


def need_of(test: Condition | StateGoal) -> Need:
    """The test of a condition or a goal."""
    return Between(*test.limits) if test.asks_for_a_level else test.value


def bounds_of(variable: StateVariable) -> Between | None:
    """The bounds of a number variable; None for any other, and where there are none."""
    if not variable.is_number or (variable.min is None and variable.max is None):
        return None
    return Between(variable.min, variable.max)


def given_by(effects: Iterable[Effect]) -> Iterator[tuple[str, Given]]:
    """The changes by effects of one happening, by variable: what it adds counts together."""
    added: dict[str, Number] = {}
    for effect in effects:
        if effect.add is not None:
            added[effect.var] = added.get(effect.var, 0) + effect.add
        if effect.set is not None:
            yield effect.var, NumberChange(effect.set, True)
        elif effect.add is None:
            yield effect.var, effect.value
    for var, amount in added.items():
        yield var, NumberChange(amount, False)


def need_text(variable: str, need: Need) -> str:
    """A need as messages show it: "'lit' = true", "'fuel' at least 10"."""
    if isinstance(need, Between):
        return f"{variable!r} {limits_text(*need)}"
    return f"{variable!r} = {value_text(need)}"


def stay_text(need: Need) -> str:
    """The value or limits that a variable is to keep, as messages show them."""
    return limits_text(*need) if isinstance(need, Between) else value_text(need)


def change_text(variable: str, change: Given) -> str:
    """The change of a variable by a happening, as messages show it."""
    if not isinstance(change, NumberChange):
        return f"makes {variable!r} {value_text(change)}"
    if change.sets:
        return f"sets {variable!r} to {format_number(change.amount)}"
    verb, amount = ("takes", -change.amount) if change.amount < 0 else ("adds", change.amount)
    to = "from" if change.amount < 0 else "to"
    return f"{verb} {format_number(amount)} {to} {variable!r}"
