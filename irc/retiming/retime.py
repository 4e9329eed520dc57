"""Re-times an answer: from choices and order to the exact earliest schedule.

Only the decisions of an engine's answer count: the chosen resources, and the order of occurrences
that share a resource. All activities then move as early as these allow. So equal choices give equal
schedules, and an engine's own times (its epsilons, its rounding) are never reported.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from irc.problem import Problem
from irc.problem.decisions import AnswerError, Decision, Placed
from irc.problem.temporal_network import earliest
from irc.problem.time_points import timing_network
from irc.retiming.resources import (
    add_setups,
    assign,
    long_enough,
    placed_at,
    resource_orders,
)


def retime(
    problem: Problem, decisions: Sequence[Decision], tolerance: Fraction | int = 0
) -> tuple[Placed, ...]:
    """The earliest schedule with the same choices and orders on resources, stock and state.

    Activities that have not moved since the previous plan stay; under an objective that a later end
    can make better, all stay where the engine has them. `tolerance` (ticks) is the error of
    the engine's times: an end that is later than the next start by no more than that still counts
    as before it. Repeated actions must have been unrolled. Raises `AnswerError` where choices and
    order contradict the task's lags, no resource is free, or a condition finds another value than
    it needs.
    """
    if not problem.is_regular and not tolerance:
        problem = _with_times_kept(problem, decisions)
    if any(problem.previous.places) and not tolerance:
        problem = _with_unmoved_fixed(problem, decisions)
    if not _is_simple(problem):
        from irc.retiming.rich import retime_rich

        return retime_rich(problem, decisions, tolerance)
    decisions = long_enough(problem, decisions)
    chosen = assign(problem, decisions, tolerance)
    timing = timing_network(problem)
    points, network = timing.points, timing.network
    for before, after in resource_orders(problem, decisions, chosen, tolerance):
        network.add(points.end[before], points.start[after], points.end_offset[before])
    add_setups(problem, decisions, chosen, points, network, timing.floors, tolerance)
    for i, decision in enumerate(decisions):
        if points.start[i] != points.end[i] and decision.end - decision.start <= tolerance:
            # Chosen to have no length: it must not grow into somebody else's time.
            network.add(points.end[i], points.start[i], 0)
    times = earliest(network, timing.floors)
    if times.cycles:
        raise AnswerError("the order of the answer contradicts the lags of the task")
    placed = placed_at(problem, times.t, points, chosen)
    shrunk = (
        p.resources and p.start == p.end and d.end - d.start > tolerance
        for p, d in zip(placed, decisions, strict=True)
    )
    if any(shrunk):
        # What has no length now takes no room, so nobody waits for it any longer.
        return retime(problem, [Decision(p.start, p.end, p.resources) for p in placed])
    return tuple(placed)


def _with_unmoved_fixed(problem: Problem, decisions: Sequence[Decision]) -> Problem:
    """The problem in which activities with the previous start and mode have that start fixed."""
    activities = list(problem.activities)
    for i, (place, decision) in enumerate(zip(problem.previous.places, decisions, strict=True)):
        if (
            place is not None
            and decision.present
            and (decision.start, decision.mode) == (place.start, place.mode)
            and activities[i].start is None
        ):
            activities[i] = replace(activities[i], start=place.start)
    return replace(problem, activities=tuple(activities))


def _with_times_kept(problem: Problem, decisions: Sequence[Decision]) -> Problem:
    """The problem in which each activity has the times that the engine chose, at whole ticks."""
    activities = list(problem.activities)
    for i, decision in enumerate(decisions):
        if decision.present:
            start, end = int(decision.start), int(decision.end)
            activities[i] = replace(activities[i], start=start, earliest_end=end)
    return replace(problem, activities=tuple(activities))


def _is_simple(problem: Problem) -> bool:
    """Whether only lags and resources of constant capacity order activities."""
    return problem.is_plain and not problem.state_precedences and not problem.has_calendars


def earliest_schedule(problem: Problem) -> tuple[Placed, ...]:
    """The exact optimum of a problem without contention: every activity as early as possible."""
    if problem.bounds.heads and all(activity.is_fixed for activity in problem.activities):
        ready = [
            Decision(head, head + activity.duration_min)
            for head, activity in zip(problem.bounds.heads, problem.activities, strict=True)
        ]
        return _placed(problem, ready)
    timing = timing_network(problem)
    times = earliest(timing.network, timing.floors)
    if times.cycles:
        raise AnswerError("the temporal network of the task contradicts itself")
    points = timing.points
    decisions = [
        Decision(times.t[s], times.t[e] + offset)
        for s, e, offset in zip(points.start, points.end, points.end_offset, strict=True)
    ]
    return _placed(problem, decisions)


def _placed(problem: Problem, decisions: Sequence[Decision]) -> tuple[Placed, ...]:
    """Decisions at whole ticks as they are, with a resource for each use."""
    chosen = assign(problem, decisions)
    placed = tuple(
        Placed(int(d.start), int(d.end), resources)
        for d, resources in zip(decisions, chosen, strict=True)
    )
    if not problem.state_precedences:
        return placed
    from irc.retiming.ranks import with_ranks

    return with_ranks(problem, placed, ())
