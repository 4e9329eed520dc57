"""Scheduling JSON for a kitchen, solved by irc and written as a plan of the kitchen."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from irc.diagnostics import InputError
from irc.evaluation.kitchen import exact
from irc.frontends.importers.json_answer import find_object
from irc.frontends.importers.plan_lines import KITCHEN_ACTIONS
from irc.frontends.importers.schedule_spec import goals_task
from irc.methods import Answer, PlanLine
from irc.model import Task
from irc.schedule import Schedule


def solved_plan(text: str, answer: Answer, kitchen: Mapping[str, Any]) -> tuple[PlanLine, ...]:
    """The plan that irc finds for an answer; empty where there is none.

    An answer that names goals only takes its actions from the kitchen.
    """
    from irc.driver.solve import solve_task

    try:
        task = _kitchen_task(text, kitchen) if answer.actions_from_gold else answer.task
        schedule = None if task is None else solve_task(task).schedule
    except (InputError, ValueError):
        return ()
    return () if schedule is None else plan_of(schedule, answer, kitchen)


def _kitchen_task(text: str, kitchen: Mapping[str, Any]) -> Task:
    """The kitchen's task with the goals that the answer names."""
    return goals_task(find_object(text) or {}, kitchen)


def plan_of(schedule: Schedule, answer: Answer, kitchen: Mapping[str, Any]) -> tuple[PlanLine, ...]:
    """A schedule as the lines of a plan, with action and item as the answer names them."""
    robots = frozenset(kitchen.get("robots") or ())
    named = {a.id: (a.fields.get("action"), a.fields.get("item")) for a in _actions(answer)}
    lines = []
    for entry in schedule.entries:
        action, item = named.get(entry.id) or _split(entry.id)
        helpers = [name for name in entry.resources if name in robots]
        start, end = exact(str(entry.start)), exact(str(entry.end))
        arguments = (*helpers[:1], str(item))
        lines.append(PlanLine(Fraction(start), str(action), arguments, end - start))
    return tuple(lines)


def _actions(answer: Answer) -> tuple[Any, ...]:
    return () if answer.graph is None else answer.graph.actions


def _split(name: str) -> tuple[str, str]:
    """Action and item of an id `<action>_<item>`."""
    action, _, item = name.partition("_")
    return (action, item) if action in KITCHEN_ACTIONS else (name, "")
