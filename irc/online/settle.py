"""Moving fewer actions without a worse answer: for engines that do not count changes themselves.

Starting from an answer, what can start when it did before is put there, all at once if possible,
else half by half. Orders and choices stay as the answer has them, so this finds no optimum; it
takes back what moved for no reason.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from irc.compiler import schedule_of
from irc.online.facts import choices_of, ticks_of
from irc.problem import Problem
from irc.retime import ABSENT, AnswerError, Decision, retime
from irc.schedule import Entry, Schedule
from irc.times import Number
from irc.worth import worth

PATIENCE = 1.0
"""Seconds."""


def settled(problem: Problem, schedule: Schedule, stability: Fraction) -> Schedule:
    """The schedule with as many activities as possible at their earlier starts.

    No objective gets worse, but for the last one, by the part `stability` of it at most.
    Occurrences of actions that repeat have no earlier place, and with some the schedule is left
    as it is.
    """
    if not any(problem.earlier) or any(a.details.repeats is not None for a in problem.activities):
        return schedule
    decisions = _decisions(problem, schedule)
    can_stay = [
        i
        for i, earlier in enumerate(problem.earlier)
        if earlier is not None
        and decisions[i].present
        and decisions[i].start != earlier.start
        and decisions[i].mode == earlier.mode
    ]
    search = _Settling(problem, decisions, _limits(problem, schedule, stability), schedule)
    search.keep_most_of(sorted(can_stay, key=lambda i: decisions[i].start))
    return search.best


def _decisions(problem: Problem, schedule: Schedule) -> list[Decision]:
    entries: dict[tuple[str, int], Entry] = {(e.id, e.occurrence): e for e in schedule.entries}
    decisions = []
    for activity in problem.activities:
        entry = entries.get((activity.id, activity.details.occurrence))
        if entry is None:
            decisions.append(ABSENT)
            continue
        mode, chosen = choices_of(problem, activity, entry)
        decisions.append(
            Decision(
                ticks_of(problem, entry.start),
                ticks_of(problem, entry.end),
                chosen or (),
                mode=mode,
                rank=entry.rank,
                end_rank=entry.rank if entry.end_rank is None else entry.end_rank,
            )
        )
    return decisions


def _limits(problem: Problem, schedule: Schedule, stability: Fraction) -> dict[str, Number]:
    """What each objective, as something to be small, may come to."""
    values = dict(_costs(problem, schedule))
    if values and stability:
        last = [*values][-1]
        size = max(values[last], -values[last])
        values[last] += size * stability
    return values


def _costs(problem: Problem, schedule: Schedule) -> dict[str, Number]:
    values = worth(problem, schedule)
    return {
        name: -values[name] if name == "reward" else values[name]
        for name in problem.objectives
        if name != "changes"
    }


@dataclass
class _Settling:
    problem: Problem
    decisions: list[Decision]
    limits: dict[str, Number]
    best: Schedule

    def __post_init__(self) -> None:
        self.until = time.perf_counter() + PATIENCE

    def keep_most_of(self, candidates: Sequence[int]) -> None:
        """Puts activities back where they were, as many as can be."""
        if not candidates or time.perf_counter() > self.until or self._keep(candidates):
            return
        if len(candidates) > 1:
            half = len(candidates) // 2
            self.keep_most_of(candidates[:half])
            self.keep_most_of(candidates[half:])

    def _keep(self, candidates: Sequence[int]) -> bool:
        activities = list(self.problem.activities)
        for i in candidates:
            earlier = self.problem.earlier[i]
            assert earlier is not None
            activities[i] = replace(activities[i], start=earlier.start)
        problem = replace(self.problem, activities=tuple(activities), earlier=())
        try:
            placed = retime(problem, self.decisions)
        except AnswerError:
            return False
        schedule = schedule_of(self.problem, placed)
        costs = _costs(self.problem, schedule)
        if any(costs[name] > limit for name, limit in self.limits.items()):
            return False
        self.problem = replace(problem, earlier=self.problem.earlier)
        self.best = schedule
        return True
