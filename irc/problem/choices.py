"""Reads the entries of a schedule as decisions about activities, in ticks and indexes."""

from __future__ import annotations

from collections.abc import Sequence

from irc.errors import IrcError
from irc.problem.activity import Activity
from irc.problem.decisions import Decision
from irc.problem.problem import Problem
from irc.schedule import Entry


class UnexplainedError(IrcError):
    """An entry names resources, or a mode, that its action cannot have."""

    def __init__(self, entry: Entry) -> None:
        super().__init__(entry.id)
        self.entry = entry


def decision_of(
    problem: Problem, activity: Activity, entry: Entry, *, now: int = 0, rank: int = 0
) -> Decision:
    """An entry as a decision about its activity.

    The entry's times are counted from `now` (ticks), its ranks from `rank`. Choices that the entry
    does not give stay open. Raises `UnexplainedError`.
    """
    mode, chosen = choices_of(problem, activity, entry)
    return Decision(
        now + problem.to_ticks(entry.start),
        now + problem.to_ticks(entry.end),
        chosen or (),
        mode=mode,
        rank=rank + entry.rank,
        end_rank=rank + entry.last_rank,
    )


def choices_of(
    problem: Problem, activity: Activity, entry: Entry
) -> tuple[int | None, tuple[int | None, ...] | None]:
    """The mode and the resource of each use; None for choices that the entry leaves open.

    Raises `UnexplainedError` where the activity cannot have the entry's mode or resources.
    """
    details = activity.details
    mode: int | None = None
    if details.modes:
        if entry.mode is None:
            return None, None
        names = [m.id for m in details.modes]
        if entry.mode not in names:
            raise UnexplainedError(entry)
        mode = names.index(entry.mode)
    relevant = activity.uses_in(mode)
    if not entry.resources and relevant:
        return mode, None
    index = {resource.id: k for k, resource in enumerate(problem.resources)}
    held: dict[int, int] = {}
    for name, amount in entry.resources.items():
        if name not in index:
            raise UnexplainedError(entry)
        held[index[name]] = amount
    chosen: list[int | None] = [None] * len(activity.uses)
    # Uses with the fewest alternatives first: there is less to take back.
    order = sorted(relevant, key=lambda u: len(activity.uses[u].alternatives))
    if not _explain(activity, order, 0, held, chosen):
        raise UnexplainedError(entry)
    return mode, tuple(chosen)


def _explain(
    activity: Activity,
    order: Sequence[int],
    at: int,
    held: dict[int, int],
    chosen: list[int | None],
) -> bool:
    """Chooses a resource for each use so that they take exactly the amounts that are held."""
    if at == len(order):
        return not any(held.values())
    use = activity.uses[order[at]]
    for r in use.alternatives:
        if held.get(r, 0) >= use.amount:
            held[r] -= use.amount
            chosen[order[at]] = r
            if _explain(activity, order, at + 1, held, chosen):
                return True
            held[r] += use.amount
    chosen[order[at]] = None
    return False


def members_taken(
    problem: Problem, activity: Activity, pools: Sequence[int]
) -> tuple[int | None, ...]:
    """The resource of each use of an activity whose open demands took these pools.

    None where the pool has several members and none has been chosen yet.
    """
    chosen: list[int | None] = [None] * len(activity.uses)
    for demand, pool in zip(activity.open_demands, pools, strict=True):
        members = problem.contention.pools[pool].members
        chosen[demand.use] = members[0] if len(members) == 1 else None
    return tuple(chosen)


def pools_taken(problem: Problem, activity: Activity, decision: Decision) -> tuple[int, ...]:
    """The pool that each open demand of an activity took; its first where that is not known."""
    pools = problem.contention.pools
    taken = decision.chosen or (None,) * len(activity.uses)
    return tuple(
        next(
            (r for r in demand.alternatives if taken[demand.use] in pools[r].members),
            demand.alternatives[0],
        )
        for demand in activity.open_demands
    )
