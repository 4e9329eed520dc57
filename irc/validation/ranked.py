"""Finds the ranks of a schedule that gives none: those by which the validator finds it valid."""

from __future__ import annotations

from dataclasses import dataclass

from irc.errors import IrcError
from irc.model import Task
from irc.model.quantities import Number
from irc.schedule import Schedule
from irc.validation.bound_schedule import bind
from irc.validation.happenings import Edge, given_ranks, timelines_of, timing_edges
from irc.validation.rank_graph import StepBudget
from irc.validation.ranks import SEARCH_STEPS, STEPS_PER_OCCURRENCE, find_ranks
from irc.validation.state import rank_changes, ranks_suit
from irc.validation.verdict import Violations


class NoRanksError(IrcError, ValueError):
    """No ranks are known under which state and precedences hold."""


@dataclass(frozen=True)
class ScheduleRanks:
    """The rank nodes of each entry's start and end, the rank of each node, and their constraints.

    With a fixed duration, start and end share one node. `edges` are the constraints of durations
    and precedences that are met with no time to spare: (a, b, least): rank(b) ≥ rank(a) + least.
    `changes` are the times and the nodes of timed changes of state.
    """

    nodes: tuple[tuple[int, int], ...]
    ranks: tuple[int, ...]
    edges: tuple[Edge, ...]
    changes: tuple[tuple[Number, int], ...] = ()


def ranks_of(task: Task, schedule: Schedule) -> ScheduleRanks:
    """Ranks for all entries: the given ranks, else all 0 where these suit, else those of a search.

    Raises `NoRanksError` where no ranks exist, or where that is too hard to decide.
    """
    bound = bind(task, schedule)
    timelines = timelines_of(
        bound,
        {o.number for o in bound.occurrences if o.start == o.end and o.rank != o.end_rank},
    )
    ranks = given_ranks(bound, timelines)
    rank_changes(bound, timelines, ranks)
    if not bound.ranked and not ranks_suit(bound, timelines, ranks):
        budget = StepBudget(SEARCH_STEPS + STEPS_PER_OCCURRENCE * len(bound.occurrences))
        violations = Violations(task.time_unit)
        found = find_ranks(bound, timelines, budget, violations)
        if found is None:
            raise NoRanksError("; ".join(v.message for v in violations.found) or "no ranks found")
        ranks = found
    count = len(bound.occurrences)
    return ScheduleRanks(
        tuple(timelines.nodes[:count]),
        tuple(ranks),
        tuple(timing_edges(bound, timelines)),
        tuple((c.start, timelines.nodes[c.number][0]) for c in bound.changes),
    )
