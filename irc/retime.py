"""Choices and order → the exact earliest schedule.

An engine's answer is read for what it decided: the resources chosen, and which of two occurrences
that share a resource comes first. Everything then moves as early as that allows, so equal choices
give equal schedules, and an engine's own times (its epsilons, its rounding) are never reported.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from irc.network import earliest
from irc.problem import Problem
from irc.timing import PointMap, timing_network

Moment = int | Fraction


class AnswerError(Exception):
    """An engine's answer that no exact schedule of the task corresponds to.

    `line` is where in the answer's text, from 1, that shows, if it shows somewhere.
    """

    def __init__(self, message: str, line: int | None = None) -> None:
        super().__init__(message)
        self.line = line


@dataclass(frozen=True, slots=True)
class Decision:
    """What an engine decided about one activity. Times are in ticks, perhaps not whole.

    `chosen[u]` is the resource (index) taken for use u, or None where the engine did not say.
    Happenings of equal time come in the order of their ranks, as far as the engine gives any.
    """

    start: Moment
    end: Moment
    chosen: tuple[int | None, ...] = ()
    present: bool = True
    mode: int | None = None
    rank: int = 0
    end_rank: int = 0


ABSENT = Decision(0, 0, (), present=False)


@dataclass(frozen=True, slots=True)
class Placed:
    """One activity's place in the exact schedule: whole ticks, one resource for each use.

    (None for the uses of modes that were not chosen.)
    """

    start: int
    end: int
    resources: tuple[int | None, ...]
    present: bool = True
    mode: int | None = None
    rank: int = 0
    end_rank: int = 0


ABSENT_PLACE = Placed(0, 0, (), present=False)


def retime(
    problem: Problem, decisions: Sequence[Decision], tolerance: Fraction | int = 0
) -> tuple[Placed, ...]:
    """The earliest schedule with the same choices and the same order on every resource,
    reservoir and state variable. What has not moved since an earlier schedule stays.

    `tolerance` (ticks) is how far the engine's times may be off: an end that is later than the
    next start by no more than that still counts as before it. Repeated actions must have been
    unrolled. Raises `AnswerError` where choices and order contradict the task's lags, the choices
    leave no resource to take, or a condition finds another value than it needs.
    """
    if any(problem.earlier) and not tolerance:
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
    """The problem in which what starts when it did before, in the same mode, starts just then."""
    activities = list(problem.activities)
    for i, (earlier, decision) in enumerate(zip(problem.earlier, decisions, strict=True)):
        if (
            earlier is not None
            and decision.present
            and (decision.start, decision.mode) == (earlier.start, earlier.mode)
            and activities[i].start is None
        ):
            activities[i] = replace(activities[i], start=earlier.start)
    return replace(problem, activities=tuple(activities))


def _is_simple(problem: Problem) -> bool:
    """Whether only lags and resources of constant capacity say what comes after what."""
    return problem.is_plain and not problem.sequel and not problem.has_calendars


def long_enough(problem: Problem, decisions: Sequence[Decision]) -> list[Decision]:
    """No answer can make an action shorter than the task says (some print no durations at all)."""
    return [
        d if d.end - d.start >= a.duration_min else replace(d, end=d.start + a.duration_min)
        for a, d in zip(problem.activities, decisions, strict=True)
    ]


def placed_at(
    problem: Problem, times: Sequence[int], points: PointMap, chosen: Sequence[tuple[int, ...]]
) -> list[Placed]:
    """The activities at the times of their points.

    Raises `AnswerError` where one misses its fixed start or deadline, or a resource runs out.
    """
    placed = []
    for i, resources in enumerate(chosen):
        start = times[points.start[i]]
        end = times[points.end[i]] + points.end_offset[i]
        fixed = problem.activities[i].start
        if fixed is not None and start > fixed:
            raise AnswerError(f"{problem.activities[i].id!r} cannot start at its fixed time")
        deadline = problem.effective_deadline(i)
        if deadline is not None and end > deadline:
            raise AnswerError(f"{problem.activities[i].id!r} cannot end by its deadline")
        placed.append(Placed(start, end, resources))
    _require_capacity(problem, placed)
    return placed


def _require_capacity(problem: Problem, placed: Sequence[Placed]) -> None:
    """Raises `AnswerError` where an answer holds more of a resource than there is.

    Order alone does not show it: what overlaps in the answer overlaps in the schedule.
    """
    changes: dict[int, list[tuple[int, int]]] = {}
    for activity, place in zip(problem.activities, placed, strict=True):
        for use, r in zip(activity.uses, place.resources, strict=True):
            if r is not None and place.end > place.start:
                changes.setdefault(r, []).append((place.start, use.amount))
                changes[r].append((place.end, -use.amount))
    for r, steps in changes.items():
        capacity, taken = _capacity(problem, r)
        for start, end, amount in taken:
            steps += [(start, amount), (end, -amount)]
        level = 0
        for _, amount in sorted(steps):  # At one instant what is freed comes first.
            level += amount
            if level > capacity:
                raise AnswerError(f"more of {problem.resources[r].id!r} is held than there is")


def _capacity(problem: Problem, r: int) -> tuple[int, list[tuple[int, int, int]]]:
    """The greatest capacity of a resource, and what its calendar takes away of it."""
    resource = problem.resources[r]
    if not resource.windows:
        return resource.capacity, []
    from irc.retiming.calendar import calendar_load

    return calendar_load(resource)


def earliest_schedule(problem: Problem) -> tuple[Placed, ...]:
    """The exact optimum of a problem without contention: everything as early as it can be."""
    if problem.heads and all(activity.is_fixed for activity in problem.activities):
        ready = [
            Decision(head, head + activity.duration_min)
            for head, activity in zip(problem.heads, problem.activities, strict=True)
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
    if not problem.sequel:
        return placed
    from irc.retiming.ranks import with_ranks

    return with_ranks(problem, placed, ())


def resource_orders(
    problem: Problem,
    decisions: Sequence[Decision],
    chosen: Sequence[tuple[int, ...]],
    tolerance: Fraction | int,
) -> list[tuple[int, int]]:
    """Pairs (i, j) with i wholly before j on a shared resource, without those that follow.

    j needs an arc only from those that were still running when the last one that ended before j
    began; the others come before that one already. At most `capacity` of them for each j.
    """
    users: dict[int, set[int]] = {}
    for i, resources in enumerate(chosen):
        for r in resources:
            users.setdefault(r, set()).add(i)
    orders: list[tuple[int, int]] = []
    for members in users.values():
        # What has no length takes no room, so it neither waits nor lets wait.
        busy = [i for i in members if decisions[i].end - decisions[i].start > tolerance]
        by_end = sorted((decisions[i].end, decisions[i].start, i) for i in busy)
        ends = [e for e, _, _ in by_end]
        latest_start: list[Moment] = []
        for _, start, _ in by_end:
            latest_start.append(max(start, latest_start[-1]) if latest_start else start)
        for j in busy:
            ended = bisect_right(ends, decisions[j].start + tolerance)
            if not ended:
                continue
            first = bisect_right(ends, latest_start[ended - 1] + tolerance)
            orders += [(i, j) for _, _, i in by_end[first:ended]]
    return orders


def assign(
    problem: Problem,
    decisions: Sequence[Decision],
    tolerance: Fraction | int = 0,
    moments: int = 1,
) -> list[tuple[int, ...]]:
    """One resource for each use: the engine's choices first, then what is free by start time.

    Members of a pool are handed out greedily in order of start, which never runs out where the
    pool's summed capacity is kept. The times of `decisions` may be in so many `moments` a tick,
    which tell ranks apart. Raises `AnswerError` where nothing is free.
    """
    result: list[list[int | None]] = []
    undecided: list[tuple[Moment, int]] = []
    for i, activity in enumerate(problem.activities):
        if not activity.uses:
            result.append([])
            continue
        chosen: list[int | None] = list(decisions[i].chosen) or [None] * len(activity.uses)
        for u, use in enumerate(activity.uses):
            if len(use.alternatives) == 1:
                chosen[u] = use.alternatives[0]
            elif chosen[u] is None:
                chosen[u] = problem.settled.get((i, u))
        result.append(chosen)
        if None in chosen:
            undecided.append((decisions[i].start, i))
    if undecided:
        _hand_out(problem, decisions, result, undecided, tolerance, moments)
    return [tuple(r for r in chosen if r is not None) for chosen in result]


def _hand_out(
    problem: Problem,
    decisions: Sequence[Decision],
    result: list[list[int | None]],
    undecided: list[tuple[Moment, int]],
    tolerance: Fraction | int,
    moments: int,
) -> None:
    held: dict[int, list[tuple[Moment, Moment, int]]] = {}
    capacity = [resource.capacity for resource in problem.resources]
    for k, resource in enumerate(problem.resources):
        if resource.windows:
            capacity[k], load = _capacity(problem, k)
            # (What falls within an instant falls behind all its ranks.)
            held[k] = [((s + 1) * moments - 1, e * moments, amount) for s, e, amount in load]
    for i, chosen in enumerate(result):
        for u, r in enumerate(chosen):
            if r is not None:
                insort(
                    held.setdefault(r, []),
                    (decisions[i].start, decisions[i].end, problem.activities[i].uses[u].amount),
                )
    for _, i in sorted(undecided):
        activity, decision = problem.activities[i], decisions[i]
        held_over = Decision(decision.start + tolerance, decision.end - tolerance)
        for u, use in enumerate(activity.uses):
            if result[i][u] is not None:
                continue
            taken = next(
                (
                    r
                    for r in _in_order(problem, i, u)
                    if held_over.end <= decision.start
                    or _free(held.get(r, []), held_over, capacity[r]) >= use.amount
                ),
                None,
            )
            if taken is None:
                raise AnswerError(f"nothing is left for {activity.id!r} to use")
            result[i][u] = taken
            insort(held.setdefault(taken, []), (decision.start, decision.end, use.amount))


def _in_order(problem: Problem, i: int, u: int) -> tuple[int, ...]:
    """The alternatives of a use; first the one that an earlier schedule took."""
    alternatives = problem.activities[i].uses[u].alternatives
    earlier = problem.earlier[i] if problem.earlier else None
    if earlier is None or (first := earlier.resources[u]) not in alternatives:
        return alternatives
    return (first, *(r for r in alternatives if r != first))


def _free(held: list[tuple[Moment, Moment, int]], decision: Decision, capacity: int) -> int:
    """Units free throughout a decision's interval.

    Called in order of start, so what has ended by now is forgotten.
    """
    held[:] = [h for h in held if h[1] > decision.start]
    until = bisect_left(held, (decision.end,))
    changes: Counter[Moment] = Counter()
    for start, end, amount in held[:until]:
        changes[max(start, decision.start)] += amount
        changes[end] -= amount
    level = peak = 0
    for moment in sorted(changes):
        level += changes[moment]
        peak = max(peak, level)
    return capacity - peak
