"""Reads a planner's text as the exact schedule of its best plan."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from irc.passes.unroll import unroll
from irc.problem import Activity, Problem
from irc.problem.decisions import ABSENT, AnswerError, Decision
from irc.problem.projection import restricted
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Schedule
from irc_pddl21.decoding.plan_log import PlanBlock, PlanLog, PlanStep
from irc_pddl21.decoding.plan_reader import read_plans
from irc_pddl21.decoding.rounding import rounded
from irc_pddl21.objective_values import ObjectiveValues, objective_values

TOLERANCE = Fraction(3, 2000)
"""Planner time by which printed times may be off: two times rounded to three decimals."""

Accept = Callable[[Schedule], str | None]
"""The reason why a schedule cannot be used, or None."""


def decode_plans(problem: Problem, names: Mapping[str, Any], answer: str) -> Schedule:
    """The best schedule among all undamaged plans in the text, each re-timed exactly.

    Raises `AnswerError` where there is no plan, or none that the task allows.
    """
    return best_of(problem, names, read_plans(answer))


def best_of(
    problem: Problem, names: Mapping[str, Any], log: PlanLog, accept: Accept | None = None
) -> Schedule:
    """The best schedule of a text that has been read, among those that `accept` lets pass.

    Raises `AnswerError` like `decode_plans`.
    """
    best: tuple[ObjectiveValues, Schedule] | None = None
    reasons: list[tuple[str, int]] = []
    for block in log.plans:
        if not block.complete:
            first = block.damage[0]
            reason = f"line {first.line} is damaged ({first.reason}): {first.text!r}"
            reasons.append((reason, first.line))
            continue
        schedule = None
        for tolerance in names.get("tolerances", (TOLERANCE,)):
            try:
                schedule = _accepted(_schedule(problem, names, block, tolerance), accept)
            except AnswerError as error:
                where = error.line or block.line
                reasons.append((f"the plan of line {block.line}: {error}", where))
            else:
                break
        if schedule is None:
            continue
        values = objective_values(problem, schedule)
        if best is None or values <= best[0]:
            best = values, schedule
    if best is not None:
        return best[1]
    if reasons:
        reason, line = reasons[-1]
        raise AnswerError(f"no plan can be used; {reason}", line)
    if log.unsolvable:
        raise AnswerError("the planner says that there is no plan (its word is not a proof)")
    raise AnswerError("there is no plan in the text")


def _accepted(schedule: Schedule, accept: Accept | None) -> Schedule:
    objection = None if accept is None else accept(schedule)
    if objection is not None:
        raise AnswerError(objection)
    return schedule


class _OccurrenceStep(NamedTuple):
    """A step of the plan that stands for an occurrence, and the meaning of its operator."""

    step: PlanStep
    meaning: Mapping[str, Any]


def _schedule(
    problem: Problem, names: Mapping[str, Any], block: PlanBlock, tolerance: Fraction
) -> Schedule:
    scale = names["planner_units_per_tick"]
    happened = _occurrences(problem, names, block)
    problem = _without_absent(problem, happened)
    depth = max((len(steps) for steps in happened.values()), default=0)
    unrolled = unroll(problem, depth)
    decisions: list[Decision] = []
    missing: list[str] = []
    for i, activity in enumerate(unrolled.activities):
        steps = happened.get(activity.id, [])
        if activity.details.occurrence > len(steps):
            decisions.append(ABSENT)
            missing += [] if activity.details.optional else [activity.id]
            continue
        step, meaning = steps[activity.details.occurrence - 1]
        mode = _mode(unrolled, i, meaning)
        chosen = _chosen(unrolled, i, meaning.get("uses", {}))
        decisions.append(Decision(step.start / scale, step.end / scale, chosen, mode=mode))
    if missing:
        more = f", and so are {len(missing) - 1} more" if len(missing) > 1 else ""
        raise AnswerError(f"{missing[0]!r} is missing{more}")
    if names.get("shortened"):
        return schedule_of(unrolled, retime(unrolled, rounded(unrolled, decisions)))
    return schedule_of(unrolled, retime(unrolled, decisions, tolerance / scale))


def _without_absent(problem: Problem, happened: Collection[str]) -> Problem:
    """The problem without the activities that nothing asks for and that did not happen.

    (Of thousands of actions that may be repeated a plan has a few.)
    """
    if problem.groups or problem.selections or problem.couplings or problem.previous.places:
        return problem
    asked = set(problem.required)
    kept = [
        i
        for i, activity in enumerate(problem.activities)
        if activity.id in happened or i in asked or not _may_be_absent(activity)
    ]
    if len(kept) == len(problem.activities):
        return problem
    return restricted(problem, activities=kept)[0]


def _may_be_absent(activity: Activity) -> bool:
    repeats = activity.details.repeats
    return activity.details.optional if repeats is None else repeats[0] == 0


def _occurrences(
    problem: Problem, names: Mapping[str, Any], block: PlanBlock
) -> dict[str, list[_OccurrenceStep]]:
    """The steps of each action in order of start, without the planner-only ones."""
    known, helpers = names["actions"], names["planner_only"]
    most = {a.id: _greatest_number(problem, i) for i, a in enumerate(problem.activities)}
    happened: dict[str, list[_OccurrenceStep]] = {}
    for step in block.steps:
        if step.name in helpers:
            continue
        meaning = known.get(step.name)
        if meaning is None or step.args or meaning["action"] not in most:
            raise AnswerError(
                f"line {step.line}: the program has no action {step.name!r}", step.line
            )
        steps = happened.setdefault(meaning["action"], [])
        steps.append(_OccurrenceStep(step, meaning))
        greatest = most[meaning["action"]]
        if greatest is not None and len(steps) > greatest:
            times = "twice" if greatest == 1 else f"more than {greatest} times"
            raise AnswerError(f"line {step.line}: {meaning['action']!r} happens {times}", step.line)
    for steps in happened.values():
        steps.sort(key=lambda s: (s.step.start, s.step.end))
    return happened


def _greatest_number(problem: Problem, i: int) -> int | None:
    repeats = problem.activities[i].details.repeats
    return 1 if repeats is None else repeats[1]


def _mode(problem: Problem, i: int, meaning: Mapping[str, Any]) -> int | None:
    activity = problem.activities[i]
    modes = [mode.id for mode in activity.details.modes]
    named = meaning.get("mode")
    if not modes and named is None:
        return None
    if named not in modes:
        raise AnswerError(f"{activity.id!r} has no mode {named!r}")
    return modes.index(named)


def _chosen(problem: Problem, i: int, uses: Mapping[str, str]) -> tuple[int | None, ...]:
    """The resources that a plan names; the others are for the re-timing to find."""
    activity = problem.activities[i]
    chosen: list[int | None] = [None] * len(activity.uses)
    for demand in activity.open_demands:
        named = uses.get(str(demand.use))
        if named is None:
            continue  # Not held in this mode, or ample in the problem that was asked.
        taken = [r for r in demand.alternatives if problem.contention.pools[r].id == named]
        if not taken:
            raise AnswerError(f"{activity.id!r} takes something it cannot use")
        members = problem.contention.pools[taken[0]].members
        chosen[demand.use] = members[0] if len(members) == 1 else None
    return tuple(chosen)
