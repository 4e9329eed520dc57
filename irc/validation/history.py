"""What a schedule that is being carried out says of its entries: cancelled, abandoned.

A cancelled action is one that the task has as optional and with a deadline at the cancellation:
whatever had begun of it stays in the schedule, as an entry that ended then.

A group that need not be there is given up where some of its actions ran and others never will. What
ran stays, with all that it used and did, and is marked as abandoned unless another group has it.

Where a schedule is judged as of a time, what began before is history (`Occurrence.past`), and a
violation that the history alone has as well is *carried*. Each rule decides that where it is
checked: by who takes part (durations, precedence, capacity), or by comparing with the history alone
(reservoirs, state). A running action whose duration is a range has its end still to choose: what a
better choice of it avoids is not carried. Missing actions, groups and goals are never carried, nor
is what the document says of itself: unknown actions, statuses, objectives.
"""

from __future__ import annotations

from irc.model.quantities import Number
from irc.validation.bound_schedule import ABANDONED, CANCELLED, BoundSchedule, Occurrence
from irc.validation.verdict import Violations


def check_statuses(bound: BoundSchedule, violations: Violations) -> None:
    """The task bears out every status that an entry has."""
    for entry in bound.schedule.entries:
        if entry.status not in (None, CANCELLED, ABANDONED):
            violations.add(
                "status",
                f"the entry of {entry.id!r} has the status {entry.status!r}; "
                f"an entry can only be {CANCELLED!r} or {ABANDONED!r}",
                [entry.id],
                (entry.start, entry.end),
            )
    marked = [o for o in bound.occurrences if o.entry.status in (CANCELLED, ABANDONED)]
    if not marked:
        return
    in_part = _present_in_part(bound)
    for occurrence in marked:
        if bound.at is not None:
            _check_begun(bound.at, occurrence, violations)
        if occurrence.cancelled:
            _check_cancelled(bound, occurrence, violations)
        elif occurrence.entry.id not in in_part:
            _add(
                occurrence,
                f"is {ABANDONED!r}, but no group that may be absent lacks others of its actions",
                violations,
            )


def _present_in_part(bound: BoundSchedule) -> set[str]:
    """The actions of groups that may be absent and of which not all actions are there."""
    return {
        name
        for group in bound.groups.values()
        if not group.required and not bound.is_present(group)
        for name in group.actions
    }


def _check_cancelled(bound: BoundSchedule, occurrence: Occurrence, violations: Violations) -> None:
    action, at = occurrence.action, violations.time(occurrence.end)
    if action.occurrence_bounds[0] > 0:
        _add(occurrence, f"is {CANCELLED!r}, but the task does not do without it", violations)
    elif action.deadline is None or bound.clock.number(action.deadline) > occurrence.end:
        _add(
            occurrence,
            f"is {CANCELLED!r} at {at}, but the task has no deadline by which it is over then",
            violations,
        )


def _check_begun(at: Number, occurrence: Occurrence, violations: Violations) -> None:
    """Only what has begun is abandoned, and only what ended by now was cancelled."""
    now = violations.time(at)
    if occurrence.past is None:
        _add(occurrence, f"is {occurrence.entry.status!r} and has not begun at {now}", violations)
    elif occurrence.cancelled and occurrence.end > at:
        _add(occurrence, f"is {CANCELLED!r}, but ends after {now}", violations)


def _add(occurrence: Occurrence, what: str, violations: Violations) -> None:
    violations.add(
        "status",
        f"{occurrence.name} {what}",
        [occurrence.entry.id],
        (occurrence.start, occurrence.end),
    )


def is_abandoned(bound: BoundSchedule, name: str) -> bool:
    """Whether all that is there of an action is marked as abandoned."""
    return all(o.entry.status == ABANDONED for o in bound.by_action[name] if not o.cancelled)


def given_up(bound: BoundSchedule) -> frozenset[str]:
    """The groups that may be absent, are there in part, and leave nothing behind unexplained.

    Each action that is there is marked as abandoned, or in another group that is wholly there.
    """
    in_part = [
        group
        for group in bound.groups.values()
        if not group.required
        and not bound.is_present(group)
        and not bound.done.isdisjoint(group.actions)
    ]
    if not in_part:
        return frozenset()
    elsewhere = {
        name for group in bound.groups.values() if bound.is_present(group) for name in group.actions
    }
    return frozenset(
        group.id
        for group in in_part
        if all(
            name in elsewhere or is_abandoned(bound, name)
            for name in group.actions
            if name in bound.done
        )
    )
