"""What can be said of a selection without a walk: hopeless ones, earliest and latest starts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product

from oracles.state_task import Job, Plain, Range


def promises(plain: Plain, counts: Sequence[int]) -> bool:
    """False only where no schedule of this selection is valid, whatever its times.

    Looks at the last level of each stock, and at values that nothing ever gives a variable.
    """
    present = [job for job, count in zip(plain.jobs, counts, strict=True) if count]
    for name, stock in plain.stocks.items():
        change = sum(
            amount * count
            for job, count in zip(plain.jobs, counts, strict=True)
            for resource, amount, _ in job.stock
            if resource == name
        )
        if not stock.holds(stock.initial + change):
            return False
    return _goals_have_givers(plain, present) and _conditions_can_be_met(plain, present)


def _goals_have_givers(plain: Plain, present: Sequence[Job]) -> bool:
    for var, value in plain.value_goals:
        if isinstance(value, Range):
            continue
        given = {v for job in present for _, x, v in job.effects if x == var}
        if value not in given and (given or plain.initial[var] != value):
            return False
    return True


def _conditions_can_be_met(plain: Plain, present: Sequence[Job]) -> bool:
    """Pretends that a variable keeps all values it ever had; then all jobs must get their turn.

    An effect at the start of a job needs only its start conditions, and may serve its others.
    """
    reached: set[tuple[str, object]] = {(var, value) for var, value in plain.initial.items()}
    started: set[str] = set()
    ended: set[str] = set()
    while True:
        before = len(started) + len(ended)
        for job in present:
            needs = {at: _values(job, at) for at in _PLACES}
            if needs["start"] <= reached:
                started.add(job.id)
                reached |= {(x, v) for at, x, v in job.effects if at == "start"}
            if job.id in started and (needs["all"] | needs["end"]) <= reached:
                ended.add(job.id)
                reached |= {(x, v) for at, x, v in job.effects if at == "end"}
        if len(started) + len(ended) == before:
            return len(ended) == len({job.id for job in present})


def _values(job: Job, at: str) -> set[tuple[str, object]]:
    """What a job needs of variables; what it needs of numbers is left out."""
    return {(x, v) for a, x, v in job.conditions if a == at and not isinstance(v, Range)}


_PLACES = ("start", "all", "end")


@dataclass(frozen=True)
class Windows:
    """Bounds on the starts of all occurrences (in the order of jobs, then of their number).

    `tails` says how long after its start at least the whole schedule goes on.
    """

    earliest: tuple[int, ...]
    latest: tuple[float, ...]
    tails: tuple[int, ...]
    makespan: int
    tardiness: int


def occurrences(counts: Sequence[int]) -> tuple[int, ...]:
    """The job of each occurrence, occurrences of one job together."""
    return tuple(j for j, count in enumerate(counts) for _ in range(count))


def relaxed_windows(plain: Plain, counts: Sequence[int]) -> Windows | None:
    """Longest paths through durations, lags and dates; None where these contradict each other."""
    owners = occurrences(counts)
    first = {j: owners.index(j) for j in set(owners)}
    origin = 2 * len(owners)
    longest = [[0.0 if u == v else -math.inf for v in range(origin + 1)] for u in range(origin + 1)]

    def edge(u: int, v: int, weight: int) -> None:
        longest[u][v] = max(longest[u][v], weight)

    for i, j in enumerate(owners):
        job = plain.jobs[j]
        edge(2 * i, 2 * i + 1, min(option.least for option in job.options))
        edge(2 * i + 1, 2 * i, -max(option.most for option in job.options))
        edge(origin, 2 * i, job.release)
        if job.deadline is not None:
            edge(2 * i + 1, origin, -job.deadline)
        if job.latest_start is not None:
            edge(2 * i, origin, -job.latest_start)
        if job.earliest_end is not None:
            edge(origin, 2 * i + 1, job.earliest_end)
        if job.start is not None:
            edge(origin, 2 * i, job.start)
            edge(2 * i, origin, -job.start)
    for one, two in pairwise(range(len(owners))):
        if owners[one] == owners[two]:
            edge(2 * one + 1, 2 * two, 0)
    for arc in plain.arcs:
        if counts[arc.before] and counts[arc.after]:
            u = 2 * first[arc.before] + arc.from_end
            v = 2 * first[arc.after] + arc.to_end
            edge(u, v, arc.least)
            if arc.most is not None:
                edge(v, u, -arc.most)
    for via, u, v in product(range(origin + 1), repeat=3):
        longest[u][v] = max(longest[u][v], longest[u][via] + longest[via][v])
    if any(longest[u][u] > 0 for u in range(origin + 1)):
        return None
    ends = [2 * i + 1 for i in range(len(owners))]
    return Windows(
        earliest=tuple(int(longest[origin][2 * i]) for i in range(len(owners))),
        latest=tuple(-longest[2 * i][origin] for i in range(len(owners))),
        tails=tuple(int(max(longest[2 * i][end] for end in ends)) for i in range(len(owners))),
        makespan=int(max((longest[origin][end] for end in ends), default=0)),
        tardiness=_tardiness(plain, counts, [int(longest[origin][end]) for end in ends]),
    )


def _tardiness(plain: Plain, counts: Sequence[int], ends: Sequence[int]) -> int:
    owners = occurrences(counts)
    total = 0
    for j, end in zip(owners, ends, strict=True):
        job = plain.jobs[j]
        total += 0 if job.due is None else job.weight * max(0, end - job.due)
    for party in plain.parties:
        if party.due is not None and party.members and counts[party.members[0]]:
            last = max(ends[owners.index(m)] for m in party.members)
            total += party.weight * max(0, last - party.due)
    return total
