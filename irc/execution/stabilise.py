"""Stabilises an answer: fewer actions move, for engines that do not count changes themselves.

Where the previous plan is still valid and as good as the answer, it stays. Otherwise, starting from
the answer, moved activities are put back to their previous places, all at once if possible, else
half by half. Order and choices of all others stay, so the result need not be optimal; it only takes
back moves that have no benefit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from irc.execution.state import key_of
from irc.model.quantities import Number
from irc.problem import PreviousPlan, Problem
from irc.problem.choices import UnexplainedError, decision_of
from irc.problem.decisions import ABSENT, AnswerError, Decision, Moment
from irc.problem.objective_values import costs
from irc.retiming.retime import retime
from irc.retiming.to_schedule import schedule_of
from irc.schedule import Entry, Schedule
from irc.targets import Budget

PATIENCE = 1.0
"""Seconds that are spent on it at most; all together is tried once in any case."""


def stabilised(
    problem: Problem,
    schedule: Schedule,
    old: Iterable[Entry],
    stability: Fraction,
    is_valid: Callable[[Schedule], bool],
    budget: Budget,
) -> Schedule:
    """The schedule with as many activities as possible where they were in the `old` one.

    No objective gets worse, except for the last one, by at most the fraction `stability` of it. The
    `old` one as a whole is best if `is_valid` accepts it. For actions that repeat the result is
    either the whole `old` schedule or the schedule as it is.
    """
    if not any(problem.previous.places):
        return schedule
    limits = _limits(problem, schedule, stability)
    whole = Schedule(tuple(sorted(old, key=lambda e: (e.start, e.end, e.id))))
    if _is_within(limits, _costs(problem, whole)) and is_valid(whole):
        return whole
    if any(a.details.repeats is not None for a in problem.activities):
        return schedule
    before, now = _decisions(problem, whole.entries), _decisions(problem, schedule.entries)
    can_stay = [
        i
        for i, place in enumerate(problem.previous.places)
        if place is not None
        and before[i].present
        and now[i].present
        and _place(before[i]) != _place(now[i])
    ]
    search = _Stabilising(problem, before, now, limits, schedule, budget.at_most(PATIENCE))
    search.keep_most_of(sorted(can_stay, key=lambda i: before[i].start))
    return search.best if is_valid(search.best) else schedule


def _place(decision: Decision) -> tuple[object, ...]:
    return decision.start, decision.mode, decision.chosen


def _decisions(problem: Problem, entries: Iterable[Entry]) -> list[Decision]:
    """The decision of a schedule about each activity; "absent" where its entry no longer fits."""
    known = {key_of(entry): entry for entry in entries}
    decisions = []
    for activity in problem.activities:
        entry = known.get((activity.id, activity.details.occurrence))
        try:
            decisions.append(ABSENT if entry is None else decision_of(problem, activity, entry))
        except UnexplainedError:  # An event has taken away the mode or the resource.
            decisions.append(ABSENT)
    return decisions


def _limits(problem: Problem, schedule: Schedule, stability: Fraction) -> dict[str, Number]:
    """The greatest value that each objective, as one to minimise, may reach."""
    values = _costs(problem, schedule)
    if values and stability:
        last = [*values][-1]
        size = max(values[last], -values[last])
        values[last] += size * stability
    return values


def _costs(problem: Problem, schedule: Schedule) -> dict[str, Number]:
    """The objective values except for the changes; less is better."""
    return {k: value for k, value in costs(problem, schedule).items() if k != "changes"}


def _is_within(limits: dict[str, Number], costs: dict[str, Number]) -> bool:
    return all(costs[name] <= limit for name, limit in limits.items())


@dataclass
class _Stabilising:
    problem: Problem
    before: Sequence[Decision]
    now: Sequence[Decision]
    limits: dict[str, Number]
    best: Schedule
    budget: Budget

    def keep_most_of(self, candidates: Sequence[int]) -> None:
        """Puts as many activities as possible back where they were."""
        if not candidates or self._keep(candidates) or len(candidates) == 1:
            return
        half = len(candidates) // 2
        for part in (candidates[:half], candidates[half:]):
            if not self.budget.is_over:
                self.keep_most_of(part)

    def _keep(self, candidates: Sequence[int]) -> bool:
        """Whether these can be where they were, in the previous order or in that of the answer."""
        activities = list(self.problem.activities)
        there = list(self.now)
        for i in candidates:
            place = self.problem.previous.places[i]
            assert place is not None
            activities[i] = replace(activities[i], start=place.start)
            length = self._length(i)
            there[i] = replace(self.before[i], end=self.before[i].start + length)
        problem = replace(self.problem, activities=tuple(activities), previous=PreviousPlan())
        same_choices = all(
            (self.before[i].mode, self.before[i].chosen) == (self.now[i].mode, self.now[i].chosen)
            for i in candidates
        )
        for decisions in (there, self.now) if same_choices else (there,):
            if self._can_be(problem, decisions):
                self.problem = replace(problem, previous=self.problem.previous)
                self.now = decisions
                return True
        return False

    def _length(self, i: int) -> Moment:
        """The previous duration of an activity, as far as the task still allows it."""
        activity, before = self.problem.activities[i], self.before[i]
        least, most = activity.duration_min, activity.duration_max
        if activity.details.modes and before.mode is not None:
            mode = activity.details.modes[before.mode]
            least, most = mode.duration_min, mode.duration_max
        return max(least, min(most, before.end - before.start))

    def _can_be(self, problem: Problem, decisions: Sequence[Decision]) -> bool:
        try:
            schedule = schedule_of(self.problem, retime(problem, decisions))
        except AnswerError:
            return False
        if not _is_within(self.limits, _costs(self.problem, schedule)):
            return False
        self.best = schedule
        return True
