"""Loads of batch resources in re-timing: members of a load start together and end together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from irc.problem import Activity, Problem
from irc.problem.decisions import Decision, Moment
from irc.problem.temporal_network import Network
from irc.problem.time_points import PointMap


def add_loads(
    problem: Problem,
    decisions: Sequence[Decision],
    chosen: Sequence[tuple[int, ...]],
    points: PointMap,
    network: Network,
    tolerance: Moment = 0,
) -> None:
    """Adds that what overlaps in a batch resource has one start and one end.

    `decisions` may count moments of ranks; what lasts no longer than the `tolerance` uses nothing.
    """
    if not problem.has_batches:
        return
    starts = [(point, 0) for point in points.start]
    ends = list(zip(points.end, points.end_offset, strict=True))
    for load in _loads(problem, decisions, chosen, tolerance):
        for one, other in pairwise(load):
            if _is_history(problem.activities[one]) and _is_history(problem.activities[other]):
                continue
            for side in (starts, ends):
                (a, behind_a), (b, behind_b) = side[one], side[other]
                network.add(a, b, behind_a - behind_b)
                network.add(b, a, behind_b - behind_a)


def _is_history(activity: Activity) -> bool:
    """Whether both of its ends are known, so that nothing has to keep it in its load."""
    return activity.start is not None and activity.is_fixed


def _loads(
    problem: Problem,
    decisions: Sequence[Decision],
    chosen: Sequence[tuple[int, ...]],
    tolerance: Moment,
) -> Iterator[list[int]]:
    """The activities of each load, in the order of their starts."""
    users: dict[int, list[int]] = {}
    for i, resources in enumerate(chosen):
        if decisions[i].end - decisions[i].start > tolerance:
            for r in dict.fromkeys(resources):
                if problem.resources[r].batch:
                    users.setdefault(r, []).append(i)
    for _, members in sorted(users.items()):
        load: list[int] = []
        latest: Moment = 0
        for i in sorted(members, key=lambda i: (decisions[i].start, decisions[i].end, i)):
            if load and decisions[i].start + tolerance >= latest:
                yield load
                load, latest = [], 0
            load.append(i)
            latest = max(latest, decisions[i].end)
        yield load
