"""The previous schedule, shifted: a warm start wherever its order is still possible.

Presence, modes and the order on every state variable stay; new required activities come last.
Serial schedule generation finds the times, re-timing finds the ranks. Where the previous order is
not possible any more there is no warm start, and the engine begins without one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from irc.execution.executed import ExecutedActivity, frozen_choices
from irc.execution.state import Key
from irc.passes.critical_path import heads_and_tails
from irc.passes.resource_profile import UNREACHABLE_TIME
from irc.passes.serial_sgs import list_schedule
from irc.problem import PLAIN, Arc, PreviousPlan, Problem
from irc.problem.choices import UnexplainedError, decision_of, members_taken
from irc.problem.decisions import ABSENT, AnswerError, Decision, Placed, as_decision
from irc.retiming.retime import retime
from irc.retiming.selection import Selection, select
from irc.retiming.state import HappeningOrder, state_orders
from irc.schedule import Entry


def warm_start(
    problem: Problem, executed: Mapping[int, ExecutedActivity], plan: Mapping[Key, Entry]
) -> tuple[Placed, ...]:
    """A place for each activity of a frozen problem, after the passes; empty where none is found.

    `plan` are the entries as they were planned, before any event changed the history: their times
    give the order.
    """
    if any(a.details.repeats is not None for a in problem.activities):
        return ()
    before = [_before(problem, i, executed.get(i), plan) for i in range(len(problem.activities))]
    if not _keeps_groups(problem, before):
        return ()
    try:
        selection = select(problem, before)
        orders = state_orders(selection.problem, selection.decisions, 0)
        found = _list_scheduled(problem, selection, orders)
        return () if found is None else retime(replace(problem, previous=PreviousPlan()), found)
    except (
        AnswerError,
        UnexplainedError,
        ValueError,
    ):  # The previous order is not possible any more.
        return ()


def _before(
    problem: Problem, i: int, past: ExecutedActivity | None, plan: Mapping[Key, Entry]
) -> Decision:
    """The planned times of an activity; new required activities come last."""
    activity = problem.activities[i]
    entry = plan.get((activity.id, activity.details.occurrence))
    if entry is None and past is not None:
        entry = past.entry
    limits = activity.deadline, activity.latest_start
    possible = all(limit is None or limit >= activity.release for limit in limits)
    if entry is None or not possible:
        if activity.details.optional:
            return ABSENT
        mode = 0 if activity.details.modes else None
        return Decision(UNREACHABLE_TIME, UNREACHABLE_TIME + activity.duration_min, (), mode=mode)
    if past is None:
        return decision_of(problem, activity, entry)
    mode, chosen = frozen_choices(activity)
    return Decision(
        problem.to_ticks(entry.start),
        problem.to_ticks(entry.end),
        chosen,
        mode=mode,
        rank=entry.rank,
        end_rank=entry.last_rank,
    )


def _keeps_groups(problem: Problem, decisions: Sequence[Decision]) -> bool:
    """Whether each group is present in full or absent, and all required activities are present."""
    for group in problem.groups:
        there = [decisions[i].present for i in group.members]
        if not all(there) and (group.required or any(there)):
            return False
    return all(decisions[i].present for i in problem.required)


def _list_scheduled(
    problem: Problem, selection: Selection, orders: Sequence[HappeningOrder]
) -> list[Decision] | None:
    """Decisions about the whole problem, from a serial schedule of the present activities."""
    chosen = selection.problem
    activities = [replace(a, details=PLAIN) for a in chosen.activities]
    arcs = [
        Arc(o.before.activity, o.after.activity, o.before.at_end, o.after.at_end, 0, None, -1)
        for o in orders
    ]
    plain = replace(
        chosen,
        activities=tuple(activities),
        arcs=(*chosen.arcs, *arcs),
        variables=(),
        goals=(),
        groups=(),
        required=(),
        reservoirs=(),
        state_precedences=(),
        previous=PreviousPlan(),
    )
    plain = heads_and_tails(plain)
    starts = [int(d.start) for d in selection.decisions]
    order = [
        s - UNREACHABLE_TIME if a.start is not None else s
        for s, a in zip(starts, activities, strict=True)
    ]
    floors = [0 if start >= UNREACHABLE_TIME else start for start in starts]
    found = [f for f in (list_schedule(plain, order, floors), list_schedule(plain, order)) if f]
    if not found:
        return None
    listed = min(found, key=lambda f: max((int(d.end) for d in f[0]), default=0))
    return _spread(problem, selection, orders, *listed)


def _spread(
    problem: Problem,
    selection: Selection,
    orders: Sequence[HappeningOrder],
    decisions: Sequence[Decision],
    choices: Sequence[tuple[int, ...]],
) -> list[Decision]:
    """A serial schedule of the present activities as decisions, with ranks at equal times."""
    from irc.retiming.ranks import with_ranks

    placed = with_ranks(
        selection.problem,
        [Placed(int(d.start), int(d.end), ()) for d in decisions],
        orders,
    )
    with_resources = [
        replace(place, resources=members_taken(selection.problem, activity, taken))
        for place, activity, taken in zip(
            placed, selection.problem.activities, choices, strict=True
        )
    ]
    return [as_decision(place) for place in selection.spread(problem, with_resources)]
