"""Schedules that a planner can be shown: list schedules by many priorities.

Serial list schedules contain an optimal one wherever nothing has to wait on purpose (Kolisch,
EJOR 90, 1996), so a search over priorities comes close to it in little time. It is a hint and no
answer: a planner is asked to follow its order, and what the planner prints counts.
"""

from __future__ import annotations

import random
import time
from dataclasses import replace

from irc.list_schedule import Choice, list_schedule
from irc.problem import Activity, Problem
from irc.retime import Decision
from irc_pddl21.neighbourhood import Known

ROUNDS = 4_000
"""So many priorities are tried at most."""


def hint(problem: Problem, enough: int, seconds: float, rng: random.Random) -> Known | None:
    """The shortest list schedule found; one of makespan `enough` (ticks) ends the search.

    None for problems with more than resources and lags, and where the rule finds none.
    """
    if not problem.is_plain:
        return None
    until = time.perf_counter() + seconds
    anyhow = replace(problem, deadline=None)
    found = list_schedule(anyhow)
    best = _makespan(found)
    priorities = list(problem.tails)
    spread = 1 + max((t + a.duration_min for t, a in _weighed(problem)), default=0)
    for n in range(ROUNDS if problem.activities else 0):
        if (best is not None and best <= enough) or time.perf_counter() > until:
            break
        width = spread * rng.choice((0.05, 0.2, 0.5))
        moved = [
            p if n % 2 and rng.random() < 0.7 else round(p + rng.uniform(-width, width))
            for p in priorities
        ]
        other = list_schedule(replace(anyhow, tails=tuple(moved)))
        makespan = _makespan(other)
        if makespan is not None and (best is None or makespan <= best):
            found, best, priorities = other, makespan, moved
    if found is None:
        return None
    return dict(enumerate(zip(*found, strict=True)))


def hinted_makespan(known: Known) -> int:
    """The makespan of a hint, in ticks."""
    return max((int(decision.end) for decision, _ in known.values()), default=0)


def _weighed(problem: Problem) -> list[tuple[int, Activity]]:
    return list(zip(problem.tails, problem.activities, strict=True))


def _makespan(found: tuple[list[Decision], list[Choice]] | None) -> int | None:
    return None if found is None else max((int(d.end) for d in found[0]), default=0)
