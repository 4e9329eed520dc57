"""Ranks for a schedule in force that leaves them open, so that its past has the right ones."""

from __future__ import annotations

from dataclasses import replace

from irc.model import Task
from irc.schedule import Schedule


def with_found_ranks(task: Task, schedule: Schedule) -> Schedule:
    """The schedule with ranks under which it is valid, where it gives none and state needs some.

    The schedule itself where it gives ranks, where rank 0 suits all, and where it is not valid.
    """
    entries = schedule.entries
    if not task.state or any(e.rank or e.end_rank for e in entries):
        return schedule
    from irc.validation.bound_schedule import UncheckedTaskError
    from irc.validation.ranked import NoRanksError, ranks_of

    try:
        found = ranks_of(task, schedule)
    except (NoRanksError, UncheckedTaskError):
        return schedule  # What is wrong with them is found when the rest is planned.
    used = sorted({found.ranks[node] for nodes in found.nodes for node in nodes})
    place = {rank: k for k, rank in enumerate(used)}
    ranked = []
    for entry, (start, end) in zip(entries, found.nodes, strict=True):
        rank, end_rank = place[found.ranks[start]], place[found.ranks[end]]
        ranked.append(replace(entry, rank=rank, end_rank=None if end_rank == rank else end_rank))
    return replace(schedule, entries=tuple(ranked))
