"""Plans of the PDDL that a task was made of, as plans of its actions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

from irc.diagnostics import InputError
from irc.model.original import Original, OriginalStep
from irc.problem import Problem
from irc_pddl21.decoding.decode import TOLERANCE
from irc_pddl21.decoding.plan_log import Damage, PlanBlock, PlanLog, PlanStep


def names_of_original(problem: Problem) -> Mapping[str, Any]:
    """The meaning of the names in such plans, once they are those of the task's actions."""
    # (Its ends come an epsilon before what they make possible, or after what they must not disturb.
    # So first the times are taken as they are printed, and only then as rounded.)
    return {
        "tolerances": (Fraction(0), TOLERANCE),
        "planner_units_per_tick": Fraction(problem.to_units(1)),
        "planner_only": {},
        "actions": {activity.id: {"action": activity.id} for activity in problem.activities},
    }


def with_actions_of(original: Original, log: PlanLog) -> PlanLog:
    """The plans with the ids of the task's actions; damaged where there is no such action.

    Each comes twice: as it is, and with what happens at one time one after the other. (Two actions
    may add to one number at one time, while the task's actions go from one value to the next.)
    """
    plans = [made for block in log.plans for made in _renamed(original, block)]
    return replace(log, plans=tuple(plans))


def _renamed(original: Original, block: PlanBlock) -> list[PlanBlock]:
    if not block.complete:
        return [block]
    given = [
        OriginalStep(f"({' '.join((step.name, *step.args))})", step.start, step.end)
        for step in block.steps
    ]
    try:
        steps = original.steps_of(given)
    except InputError as error:
        first = error.report.diagnostics[0]
        return [replace(block, damage=(Damage(block.line, "", first.message),))]
    both = (steps, _one_after_the_other(steps))
    return [
        replace(
            block,
            steps=tuple(PlanStep(s.start, s.action, (), s.end - s.start, block.line) for s in one),
        )
        for one in both
    ]


def _one_after_the_other(steps: Sequence[OriginalStep]) -> list[OriginalStep]:
    """The steps with happenings of one time a little apart, ends first, in the plan's order."""
    happenings = sorted(
        [(step.start, 1, k) for k, step in enumerate(steps)]
        + [(step.end, 0 if step.end > step.start else 2, k) for k, step in enumerate(steps)]
    )
    times = sorted({time for time, _, _ in happenings})
    gap = min((later - earlier for earlier, later in pairwise(times)), default=Fraction(1))
    moved = {
        (stage == 1, k): time + gap * place / (len(happenings) + 1)
        for place, (time, stage, k) in enumerate(happenings)
    }
    return [
        OriginalStep(step.action, moved[True, k], moved[False, k]) for k, step in enumerate(steps)
    ]
