"""Resources in re-timing: their assignment to uses, their order, and a check of the capacity."""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from irc.problem import Problem, Setups
from irc.problem.decisions import AnswerError, Decision, Moment, Placed
from irc.problem.setups import SetupLink, setup_links
from irc.problem.temporal_network import Network
from irc.problem.time_points import PointMap


def long_enough(problem: Problem, decisions: Sequence[Decision]) -> list[Decision]:
    """Decisions with at least the task's least durations (some engines print no durations)."""
    return [
        d if d.end - d.start >= a.duration_min else replace(d, end=d.start + a.duration_min)
        for a, d in zip(problem.activities, decisions, strict=True)
    ]


def placed_at(
    problem: Problem, times: Sequence[int], points: PointMap, chosen: Sequence[tuple[int, ...]]
) -> list[Placed]:
    """The activities at the times of their points.

    Raises `AnswerError` where one misses its fixed start, latest start or deadline, or a resource
    runs out.
    """
    placed = []
    for i, resources in enumerate(chosen):
        start = times[points.start[i]]
        end = times[points.end[i]] + points.end_offset[i]
        fixed = problem.activities[i].start
        if fixed is not None and start > fixed:
            raise AnswerError(f"{problem.activities[i].id!r} cannot start at its fixed time")
        latest = problem.activities[i].latest_start
        if latest is not None and start > latest:
            raise AnswerError(f"{problem.activities[i].id!r} cannot start by its latest start")
        deadline = problem.effective_deadline(i)
        if deadline is not None and end > deadline:
            raise AnswerError(f"{problem.activities[i].id!r} cannot end by its deadline")
        placed.append(Placed(start, end, resources))
    _require_capacity(problem, placed)
    return placed


def _require_capacity(problem: Problem, placed: Sequence[Placed]) -> None:
    """Raises `AnswerError` where an answer holds more of a resource than its capacity.

    The order alone does not show it: activities that overlap in the answer overlap in the schedule.
    """
    changes: dict[int, list[tuple[int, int]]] = {}
    unpaused: dict[int, list[tuple[int, int]]] = {}
    for activity, place in zip(problem.activities, placed, strict=True):
        for use, r in zip(activity.uses, place.resources, strict=True):
            if r is not None and place.end > place.start:
                own = [(place.start, use.amount), (place.end, -use.amount)]
                changes.setdefault(r, []).extend(own)
                unpaused.setdefault(r, []).extend(() if activity.details.keeps_units else own)
    for r, steps in changes.items():
        capacity, taken = _capacity(problem, r)
        if len(unpaused[r]) < len(steps):
            # What pauses keeps its units while there is no capacity.
            _require_room(problem, r, unpaused[r], capacity, taken)
            taken = [part for part in taken if part[2] < capacity]
        _require_room(problem, r, steps, capacity, taken)


def _require_room(
    problem: Problem,
    r: int,
    steps: Sequence[tuple[int, int]],
    capacity: int,
    taken: Sequence[tuple[int, int, int]],
) -> None:
    """Raises `AnswerError` where changes of what is held, and what is taken away, are too much."""
    level, both = 0, list(steps)
    for start, end, amount in taken:
        both += [(start, amount), (end, -amount)]
    for _, amount in sorted(both):  # At one instant what is freed comes first.
        level += amount
        if level > capacity:
            raise AnswerError(f"more of {problem.resources[r].id!r} is held than its capacity")


def _capacity(problem: Problem, r: int) -> tuple[int, list[tuple[int, int, int]]]:
    """The greatest capacity of a resource, and the units that its calendar takes away."""
    resource = problem.resources[r]
    if not resource.windows:
        return resource.capacity, []
    from irc.retiming.calendar import calendar_load

    return calendar_load(resource)


def add_setups(
    problem: Problem,
    decisions: Sequence[Decision],
    chosen: Sequence[tuple[int, ...]],
    points: PointMap,
    network: Network,
    floors: list[int],
    tolerance: Moment,
) -> None:
    """Adds the time of each set-up between two consecutive uses of a resource, in their order.

    `decisions` may count moments of ranks. What is used for some time goes on to be: without it
    another set-up would take place.
    """
    if not problem.has_setups:
        return
    for link in setup_links(problem.resources, problem.activities, decisions, chosen, tolerance):
        after = points.start[link.after]
        setups = problem.resources[link.resource].setups
        if points.end[link.after] != after:
            network.add(after, points.end[link.after], 1)
        fixed = problem.activities[link.after].start
        if setups is None or (fixed is not None and fixed < setups.waived_before):
            continue
        if link.before is not None:
            gap = points.end_offset[link.before] + link.setup.time
            network.add(points.end[link.before], after, gap)
            if setups.tight and not _has_waited(problem, link, setups):
                network.add(after, points.end[link.before], -gap)
        elif link.setup.time:
            floors[after] = max(floors[after], setups.since + link.setup.time)


def _has_waited(problem: Problem, link: SetupLink, setups: Setups) -> bool:
    """Whether a gap before a use is history: nothing was done between then and now."""
    if link.before is None:
        return False
    before = problem.activities[link.before]
    if before.start is None or not before.is_fixed:
        return False
    return before.start + before.duration_min + link.setup.time < setups.now


def resource_orders(
    problem: Problem,
    decisions: Sequence[Decision],
    chosen: Sequence[tuple[int, ...]],
    tolerance: Fraction | int,
) -> list[tuple[int, int]]:
    """Pairs (i, j) with i wholly before j on a pool, without pairs that follow from others.

    j needs an arc only from the activities that still ran when the last one that ended before j
    began; the others come before that one already. There are at most `capacity` of them for each j.
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

    Members of a pool are assigned greedily in order of start, which always succeeds where the
    pool's summed capacity is kept. `decisions` may count `moments` to a tick, to separate ranks.
    Raises `AnswerError` where nothing is free.
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
                chosen[u] = problem.contention.fixed_choices.get((i, u))
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
                raise AnswerError(f"no resource is free for {activity.id!r}")
            result[i][u] = taken
            insort(held.setdefault(taken, []), (decision.start, decision.end, use.amount))


def _in_order(problem: Problem, i: int, u: int) -> tuple[int, ...]:
    """The alternatives of a use; first the one that the previous plan took."""
    alternatives = problem.activities[i].uses[u].alternatives
    place = problem.previous.places[i] if problem.previous.places else None
    if place is None or (first := place.resources[u]) not in alternatives:
        return alternatives
    return (first, *(r for r in alternatives if r != first))


def _free(held: list[tuple[Moment, Moment, int]], decision: Decision, capacity: int) -> int:
    """Units free throughout a decision's interval.

    It is called in order of start, so it drops holders that have ended.
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
