"""What a planner printed → the exact schedule that its best plan stands for."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from irc.compiler import schedule_of
from irc.problem import Problem
from irc.retime import AnswerError, Decision, retime
from irc.schedule import Schedule
from irc_pddl21.plan_reader import PlanBlock, PlanLog, read_plans

_TOLERANCE = Fraction(3, 2000)
"""Planner time by which printed times may be off: two times rounded to three decimals."""


def decode_plans(problem: Problem, names: Mapping[str, Any], answer: str) -> Schedule:
    """The shortest schedule among all undamaged plans in the text, each re-timed exactly.

    Raises `AnswerError` where there is no plan, or none that the task allows.
    """
    return best_of(problem, names, read_plans(answer))


def best_of(problem: Problem, names: Mapping[str, Any], log: PlanLog) -> Schedule:
    """As `decode_plans`, of a text that has been read."""
    best: Schedule | None = None
    reasons: list[tuple[str, int]] = []
    for block in log.plans:
        if not block.complete:
            first = block.damage[0]
            reason = f"line {first.line} is damaged ({first.reason}): {first.text!r}"
            reasons.append((reason, first.line))
            continue
        try:
            schedule = _schedule(problem, names, block)
        except AnswerError as error:
            reasons.append((f"the plan of line {block.line}: {error}", error.line or block.line))
            continue
        if best is None or schedule.makespan <= best.makespan:
            best = schedule
    if best is not None:
        return best
    if reasons:
        reason, line = reasons[-1]
        raise AnswerError(f"no plan can be used; {reason}", line)
    if log.unsolvable:
        raise AnswerError("the planner says that there is no plan (its word is not a proof)")
    raise AnswerError("there is no plan in the text")


def _schedule(problem: Problem, names: Mapping[str, Any], block: PlanBlock) -> Schedule:
    scale = names["planner_units_per_tick"]
    known, helpers = names["actions"], names["planner_only"]
    index = {activity.id: i for i, activity in enumerate(problem.activities)}
    decisions: dict[int, Decision] = {}
    for step in block.steps:
        if step.name in helpers:
            continue
        meaning = known.get(step.name)
        if meaning is None or step.args or meaning["action"] not in index:
            raise AnswerError(
                f"line {step.line}: the program has no action {step.name!r}", step.line
            )
        i = index[meaning["action"]]
        if i in decisions:
            raise AnswerError(f"line {step.line}: {meaning['action']!r} happens twice", step.line)
        decisions[i] = Decision(
            step.start / scale, step.end / scale, _chosen(problem, i, meaning.get("uses", {}))
        )
    missing = [a.id for i, a in enumerate(problem.activities) if i not in decisions]
    if missing:
        more = f", and so are {len(missing) - 1} more" if len(missing) > 1 else ""
        raise AnswerError(f"{missing[0]!r} is missing{more}")
    ordered = [decisions[i] for i in range(len(problem.activities))]
    return schedule_of(problem, retime(problem, ordered, _TOLERANCE / scale))


def _chosen(problem: Problem, i: int, uses: Mapping[str, str]) -> tuple[int | None, ...]:
    activity = problem.activities[i]
    chosen: list[int | None] = [None] * len(activity.uses)
    for claim in activity.claims:
        named = uses.get(str(claim.use))
        taken = [r for r in claim.alternatives if problem.shared[r].id == named]
        if not taken:
            raise AnswerError(f"{activity.id!r} takes something it cannot use")
        members = problem.shared[taken[0]].members
        chosen[claim.use] = members[0] if len(members) == 1 else None
    return tuple(chosen)
