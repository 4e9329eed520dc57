"""Searches for a schedule as good as an answer in which fewer activities move.

The search (`irc.passes.fewer_moves`) goes from the answer back towards the previous plan. It proves
nothing: a bound on the changes is the engine's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from irc.model.quantities import Number
from irc.passes.fewer_moves import fewer_moves, knows_moves
from irc.passes.serial_sgs import Found
from irc.problem import Problem
from irc.problem.choices import UnexplainedError, decision_of
from irc.problem.decisions import AnswerError
from irc.problem.objective_values import schedule_values
from irc.retiming.listed import listed_schedule
from irc.schedule import Schedule
from irc.targets import Budget, Outcome

LEAST_SECONDS = 0.5
LIMIT_SHARE = 0.1
"""The time for it is as long as the answer took, or one of these if that is more: seconds, and a
part of the limit.
"""

AFTERWARDS_SHARE = 0.3
"""The time that is kept for re-timing and the judge, as a part of that which the answer took."""


def with_fewer_moves(
    problem: Problem, outcome: Outcome, is_valid: Callable[[Schedule], bool], budget: Budget
) -> Outcome:
    """The outcome with a schedule in which fewer activities move, if one is found in the time.

    The makespan is no longer than before. Where the problem has more than lags, windows, resources
    and the makespan, where the makespan may be given up for fewer moves, or where the number of
    moves is proven the least, it is the outcome as it is.
    """
    schedule = outcome.schedule
    if schedule is None or budget.is_over or problem.previous.stability:
        return outcome
    if not knows_moves(problem):
        return outcome
    before = schedule_values(problem, schedule)
    if _is_least(outcome, before["changes"]):
        return outcome
    known = _listed(problem, schedule)
    if known is None:
        return outcome
    part = budget.at_most(_seconds(budget))
    found = fewer_moves(problem, known, lambda: part.is_over)
    if found is None:
        return outcome
    try:
        moved = listed_schedule(problem, found)
    except AnswerError:
        return outcome  # Exact times may break a limit that holds in whole ticks.
    values = schedule_values(problem, moved)
    is_better = values["makespan"] <= before["makespan"] and values["changes"] < before["changes"]
    if not is_better or not is_valid(moved):
        return outcome
    levels = tuple(replace(level, value=values[level.name]) for level in outcome.levels)
    return replace(outcome, schedule=moved, levels=levels)


def _seconds(budget: Budget) -> float:
    """The time for the search."""
    share = LIMIT_SHARE * budget.limit if budget.is_limited else 0.0
    wanted = max(LEAST_SECONDS, budget.elapsed, share)
    return max(0.0, min(wanted, budget.left - AFTERWARDS_SHARE * budget.elapsed))


def _is_least(outcome: Outcome, changes: Number) -> bool:
    """Whether nothing moves, or the engine has proven that no fewer activities can move."""
    proven = any(level.name == "changes" and level.bound == changes for level in outcome.levels)
    return proven or not changes


def _listed(problem: Problem, schedule: Schedule) -> Found | None:
    """A schedule as a list schedule; None where its times are not whole ticks."""
    entries = {entry.id: entry for entry in schedule.entries}
    pools = problem.contention.pools
    decisions, choices = [], []
    for activity in problem.activities:
        try:
            decision = decision_of(problem, activity, entries[activity.id])
        except UnexplainedError:
            return None
        if not isinstance(decision.start, int) or not isinstance(decision.end, int):
            return None
        taken = [decision.chosen[d.use] if decision.chosen else None for d in activity.open_demands]
        decisions.append(decision)
        choices.append(
            tuple(
                next((r for r in d.alternatives if chosen in pools[r].members), d.alternatives[0])
                for d, chosen in zip(activity.open_demands, taken, strict=True)
            )
        )
    return decisions, choices
