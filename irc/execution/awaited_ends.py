"""Conditions that wait for the end of what runs.

Some targets cannot say "not while this runs, if it has the value that this needs". There a variable
of its own says whether the activity is over, and what must not happen before waits for that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TypeVar

from irc.execution.fresh_names import fresh_name
from irc.problem import Activity, Condition, Details, Effect, Mode, Problem, Variable

Need = TypeVar("Need")
"""A value or a limit that an activity needs while it runs."""


def with_end_variables(
    problem: Problem, needs: Iterable[tuple[Need, int, str]]
) -> tuple[Problem, Mapping[Need, int]]:
    """The problem with a variable for each need that says whether its activity is over.

    A need comes with its activity and the name of what it needs. Returns also the index of the
    variable of each; its value 1 is "over".
    """
    activities, variables = list(problem.activities), list(problem.variables)
    names = {v.id for v in variables}
    over: dict[Need, int] = {}
    for need, i, what in needs:
        if need in over:
            continue
        over[need] = len(variables)
        who = activities[i]
        name = fresh_name(f"{who.id} is over: {what}", names)
        names.add(name)
        variables.append(Variable(name, (False, True), 0))
        ends = (*who.details.effects, Effect(over[need], 1, at_end=True))
        activities[i] = replace(who, details=replace(who.details, effects=ends))
    return replace(problem, activities=tuple(activities), variables=tuple(variables)), over


def with_conditions(
    activity: Activity, needed: Callable[[Details | Mode], tuple[Condition, ...]]
) -> Activity:
    """An activity with more conditions: those that its own effects, and those of a mode, need."""
    details = activity.details
    modes = tuple(m._replace(conditions=m.conditions + needed(m)) for m in details.modes)
    conditions = tuple(dict.fromkeys(details.conditions + needed(details)))
    return replace(activity, details=replace(details, conditions=conditions, modes=modes))
