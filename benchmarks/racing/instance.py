"""An instance of the league: what all competitors are given, and what judges their answers.

It is kept as JSON, so that a competitor pays for reading it and for nothing of another competitor.
Times are whole numbers; jobs, resources and budgets are indexes.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path

Amounts = list[tuple[int, int]]
"""(index, amount) of each resource that is held, or of each budget that is used up."""


@dataclass(frozen=True)
class Way:
    """One way to do a job: the name of its mode or resource, and what it takes."""

    id: str
    duration: int
    holds: Amounts
    spends: Amounts


@dataclass(frozen=True)
class Lag:
    """`after` starts at least `least` behind the end of `before`, or behind its start."""

    before: int
    after: int
    least: int
    from_end: bool


@dataclass(frozen=True)
class Instance:
    """Jobs with one way or several, lags between them, capacities and budgets."""

    name: str
    family: str
    ids: list[str]
    jobs: list[list[Way]]
    lags: list[Lag]
    capacities: list[int]
    budgets: list[int]

    def text(self) -> str:
        """The instance as JSON."""
        return json.dumps(asdict(self))


def family_of(jobs: Sequence[Sequence[Way]], lags: Sequence[Lag], capacities: Sequence[int]) -> str:
    """The family of an instance, which says what model is written for it."""
    several = any(len(ways) > 1 for ways in jobs)
    machines = all(c == 1 for c in capacities) and all(
        len(way.holds) == 1 and not way.spends for ways in jobs for way in ways
    )
    if any(not lag.from_end for lag in lags):
        return "rcpsp-max"
    if machines:
        return "flexible" if several else "job-shop"
    return "multi-mode" if several else "rcpsp"


def read_instance(path: Path) -> Instance:
    """The instance in a file that `Instance.text` wrote."""
    raw = json.loads(path.read_text("utf-8"))
    jobs = [
        [
            Way(w["id"], w["duration"], [(r, n) for r, n in w["holds"]], list(w["spends"]))
            for w in ways
        ]
        for ways in raw["jobs"]
    ]
    lags = [Lag(**lag) for lag in raw["lags"]]
    return Instance(
        raw["name"], raw["family"], raw["ids"], jobs, lags, raw["capacities"], raw["budgets"]
    )


def faults(instance: Instance, starts: Sequence[int], ways: Sequence[int]) -> list[str]:
    """The rules that a schedule breaks: the start and the way of each job are given."""
    taken = [job[k] for job, k in zip(instance.jobs, ways, strict=True)]
    ends = [start + way.duration for start, way in zip(starts, taken, strict=True)]
    found = [f"job {i} starts before 0" for i, start in enumerate(starts) if start < 0]
    for lag in instance.lags:
        since = ends[lag.before] if lag.from_end else starts[lag.before]
        if starts[lag.after] < since + lag.least:
            found.append(f"job {lag.after} starts too early behind job {lag.before}")
    for r, capacity in enumerate(instance.capacities):
        changes = [
            change
            for start, end, way in zip(starts, ends, taken, strict=True)
            for held, amount in way.holds
            if held == r and end > start
            for change in ((start, amount), (end, -amount))
        ]
        level = 0
        for (time, change), following in pairwise([*sorted(changes), (-1, 0)]):
            level += change
            if level > capacity:
                found.append(f"resource {r} is overloaded at {time}, before {following[0]}")
                break
    for k, budget in enumerate(instance.budgets):
        if sum(n for way in taken for spent, n in way.spends if spent == k) > budget:
            found.append(f"budget {k} is exceeded")
    return found


def length(instance: Instance, starts: Sequence[int], ways: Sequence[int]) -> int:
    """The makespan of a schedule."""
    jobs = zip(starts, ways, instance.jobs, strict=True)
    return max((start + job[k].duration for start, k, job in jobs), default=0)
