"""Checks of number variables: kinds of operators, bounds, and levels that nothing can reach."""

from __future__ import annotations

from collections import defaultdict
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING, Any

from irc.checks.required import greatest_occurrences
from irc.diagnostics import Code, Findings
from irc.diagnostics.source import Pointer
from irc.model.base import write_time
from irc.model.details import Condition, Effect, NumberTest, StateGoal, StateVariable
from irc.model.quantities import Number, exact
from irc.model.state_values import limits_text, value_text
from irc.model.times import format_number
from irc.problem import NumberEffect, NumberVariable, Problem

if TYPE_CHECKING:
    from irc.model import Task
    from irc.model.events import SetState

_TEST_FIELDS = ("at_least", "at_most", "equals")
_CHANGE_FIELDS = ("add", "set")
_Asked = tuple[int | None, int | None]
"""The least and the greatest level that are asked for; None: no limit."""


def check_number(variable: StateVariable, at: Pointer, findings: Findings) -> None:
    """Reports a number variable whose bounds, initial level or timed changes cannot be."""
    name = f"number variable {variable.id!r}"
    if "values" in variable.model_fields_set:
        findings.add(
            Code.WITHOUT_EFFECT,
            "'values' has no meaning for a number variable",
            (*at, "values"),
            at_key=True,
            hint='remove it; a number variable has "initial", "min" and "max"',
        )
    least, greatest = variable.min, variable.max
    if least is not None and greatest is not None and least > greatest:
        findings.add(
            Code.EMPTY_RANGE,
            f"{name}: min {format_number(least)} is above max {format_number(greatest)}",
            (*at, "min"),
            hint="swap them",
        )
        return
    _check_level(variable, variable.start_value, "starts at", (*at, "initial"), findings)
    for i, change in enumerate(variable.changes):
        place = (*at, "changes", i, "value")
        when = f"becomes at {write_time(change.at)}"
        _check_level(variable, change.value, when, place, findings)


def _check_level(
    variable: StateVariable, level: Any, verb: str, at: Pointer, findings: Findings
) -> None:
    name = f"number variable {variable.id!r}"
    if isinstance(level, (bool, str)):
        findings.add(
            Code.UNKNOWN_VALUE,
            f"{name} cannot be {value_text(level)}",
            at,
            hint='write a number, such as 40, 2.5 or "1/3"',
        )
    elif level is not None and not within(variable, level):
        findings.add(
            Code.EMPTY_RANGE,
            f"{name}: the level that it {verb}, {format_number(level)}, is outside its bounds",
            at,
            hint=f"write a number of {limits_text(variable.min, variable.max)}",
        )


def within(variable: StateVariable, level: Number) -> bool:
    """Whether a level is within the bounds of a number variable."""
    return (variable.min is None or level >= variable.min) and (
        variable.max is None or level <= variable.max
    )


def check_not_a_number(variable: StateVariable, at: Pointer, findings: Findings) -> None:
    """Reports bounds of a variable that is no number."""
    for name in sorted({"min", "max"} & variable.model_fields_set):
        findings.add(
            Code.WITHOUT_EFFECT,
            f"{name!r} has no meaning for state variable {variable.id!r}, which is no number",
            (*at, name),
            at_key=True,
            hint='remove it, or write "kind": "number"',
        )


def suits_kind(
    fact: Condition | Effect | StateGoal | SetState,
    variable: StateVariable,
    at: Pointer,
    findings: Findings,
) -> bool:
    """Whether a fact about a number variable speaks of numbers, and one about another does not.

    Reports it if not, and what of a number variable is asked or given in a way that cannot be.
    """
    numeric = set(_CHANGE_FIELDS if isinstance(fact, Effect) else _TEST_FIELDS)
    said = fact.model_fields_set & (numeric | {"value"})
    if not variable.is_number:
        for name in sorted(said & numeric):
            findings.add(
                Code.WRONG_KIND,
                f"state variable {variable.id!r} is no number, so it has no {name!r}",
                (*at, name),
                at_key=True,
                hint='write "value", or declare the variable with "kind": "number"',
            )
        return not said & numeric
    if isinstance(fact, (Condition, StateGoal, Effect)):
        return _suits_number(fact, said & numeric, variable, at, findings)
    _check_level(variable, variable.read(fact.value), "becomes", (*at, "value"), findings)
    return True


def _suits_number(
    fact: Condition | Effect | StateGoal,
    said: set[str],
    variable: StateVariable,
    at: Pointer,
    findings: Findings,
) -> bool:
    changes = isinstance(fact, Effect)
    if "value" in fact.model_fields_set or not said:
        place = (*at, "value") if "value" in fact.model_fields_set else at
        findings.add(
            Code.WRONG_KIND,
            f"{variable.id!r} is a number, so it has no 'value'"
            if "value" in fact.model_fields_set
            else f"{variable.id!r} is a number, and this does not say "
            + ("how it changes" if changes else "which levels are meant"),
            place,
            hint='write "add" or "set"' if changes else 'write "at_least", "at_most" or "equals"',
        )
        return False
    if isinstance(fact, Effect):
        if len(said) > 1:
            findings.add(
                Code.AT_ODDS,
                f"this effect adds to {variable.id!r} and sets it",
                at,
                hint='keep one of "add" and "set"',
            )
        elif fact.set is not None:
            _check_level(variable, fact.set, "becomes", (*at, "set"), findings)
    return True


# --- levels that nothing can reach --------------------------------------------------------------


def check_levels(
    task: Task, problem: Problem, required: frozenset[int], findings: Findings
) -> None:
    """Adds conditions of required actions, and goals, whose levels no changes can bring about."""
    for i in sorted(required):
        _check_effects(problem, i, findings)
    reach = [_reach(problem, k) for k in range(len(problem.numbers))]
    index = {n.id: k for k, n in enumerate(problem.numbers)}
    for i in sorted(required):
        activity = problem.activities[i]
        node = task.actions[int(activity.origin[1])]
        for c, condition in enumerate(node.conditions):
            if condition.var in index:
                k, at = index[condition.var], (*activity.origin, "conditions", c)
                who = f"action {activity.id!r} needs"
                _check_asked(problem.numbers[k], condition, reach[k], who, at, findings)
    for g, goal in enumerate(task.goals):
        if not isinstance(goal, str) and goal.var in index:
            k = index[goal.var]
            _check_asked(problem.numbers[k], goal, reach[k], "a goal needs", ("goals", g), findings)


def _check_effects(problem: Problem, i: int, findings: Findings) -> None:
    """Two levels for one number at one happening, or a level and an amount (rule 6.2)."""
    activity = problem.activities[i]
    found: dict[tuple[int, bool], NumberEffect] = {}
    for effect in activity.details.number_effects:
        place = effect.number, effect.at_end and activity.duration_max > 0
        first = found.setdefault(place, effect)
        if first[1:3] != effect[1:3] and (first.sets or effect.sets):
            number = problem.numbers[effect.number]
            findings.add(
                Code.AT_ODDS,
                f"action {activity.id!r} gives {number.id!r} two levels at "
                + ("its end" if place[1] else "its start"),
                (*activity.origin, "effects"),
                hint='let it either "set" the number once there, or only "add" to it',
            )


def _reach(problem: Problem, k: int) -> tuple[float, float]:
    """The least and the greatest level that a number could ever have, if effects had any order."""
    number = problem.numbers[k]
    starts = [number.initial, *(change.value for change in number.changes)]
    ups: dict[bool, float] = defaultdict(float)
    for activity in problem.activities:
        count = greatest_occurrences(activity)
        times = inf if count is None else count
        own = [e for e in activity.details.all_number_effects if e.number == k]
        for effect in own if times else ():
            if effect.sets:
                starts.append(effect.amount)
            elif effect.amount:
                ups[effect.amount > 0] += times * effect.amount
    lowest = -inf if number.least is None else number.least
    highest = inf if number.greatest is None else number.greatest
    return max(lowest, min(starts) + ups[False]), min(highest, max(starts) + ups[True])


def _check_asked(
    number: NumberVariable,
    test: NumberTest,
    reach: tuple[float, float],
    who: str,
    at: Pointer,
    findings: Findings,
) -> None:
    least, greatest = test.limits
    if not test.asks_for_a_level:
        return
    wanted = limits_text(least, greatest)
    if least is not None and greatest is not None and least > greatest:
        findings.add(
            Code.AT_ODDS,
            f"{who} {number.id!r} to be {wanted}, which no number is",
            at,
            hint="correct one of the two limits",
        )
        return
    lowest, highest = reach
    if least is not None and least * number.scale > highest:
        extreme, verb = highest, "at most"
    elif greatest is not None and greatest * number.scale < lowest:
        extreme, verb = lowest, "at least"
    else:
        return
    shown = format_number(exact(Fraction(int(extreme), number.scale)))
    findings.add(
        Code.UNREACHABLE,
        f"{who} {number.id!r} to be {wanted}, but it can be {verb} {shown}",
        at,
        hint='change the limit, the "initial" level or its bounds, or add an effect that helps',
    )
