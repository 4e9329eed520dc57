"""Plans of the PDDL that a task was made of, as plans of its actions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Any

from irc.diagnostics import InputError
from irc.model.original import Original, OriginalStep
from irc.problem import Problem
from irc_pddl21.decoding.plan_log import Damage, PlanBlock, PlanLog, PlanStep


def names_of_original(problem: Problem) -> Mapping[str, Any]:
    """The meaning of the names in such plans, once they are those of the task's actions."""
    return {
        "planner_units_per_tick": Fraction(problem.to_units(1)),
        "planner_only": {},
        "actions": {activity.id: {"action": activity.id} for activity in problem.activities},
    }


def with_actions_of(original: Original, log: PlanLog) -> PlanLog:
    """The plans with the ids of the task's actions; damaged where there is no such action."""
    return replace(log, plans=tuple(_renamed(original, block) for block in log.plans))


def _renamed(original: Original, block: PlanBlock) -> PlanBlock:
    if not block.complete:
        return block
    given = [
        OriginalStep(f"({' '.join((step.name, *step.args))})", step.start, step.end)
        for step in block.steps
    ]
    try:
        steps = original.steps_of(given)
    except InputError as error:
        first = error.report.diagnostics[0]
        return replace(block, damage=(Damage(block.line, "", first.message),))
    made = [PlanStep(s.start, s.action, (), s.end - s.start, block.line) for s in steps]
    return replace(block, steps=tuple(made))
