"""The statuses of entries in a schedule that is being carried out: cancelled, abandoned.

A cancelled action is optional in the task, with a deadline at the cancellation. An occurrence of it
that had begun stays in the schedule, as an entry that ended then.

An optional group is given up where some of its actions ran and others never will. The entries that
ran stay, with their uses and effects. They are marked as abandoned unless another group has them.

Where a schedule is judged as of a time, entries that began before it are history
(`Occurrence.past`), and a violation that the history alone has too is *carried*. Each rule decides
that where it is checked: by the occurrences that take part (durations, precedence, capacity), or by
a comparison with the history alone (reservoirs, state). The end of a running action whose duration
is a range is still to be chosen: a violation that another choice avoids is not carried. Missing
actions, groups and goals are never carried, nor are faults of the document itself: unknown actions,
statuses, objectives.
"""

from __future__ import annotations

from irc.model.quantities import Number
from irc.schedule import ABANDONED, BEGUN, CANCELLED
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.verdict import Violations


def check_statuses(bound: BoundSchedule, violations: Violations) -> None:
    """Checks every status of an entry against the task."""
    for entry in bound.schedule.entries:
        if entry.status not in (None, CANCELLED, ABANDONED, BEGUN):
            violations.add(
                "status",
                f"the entry of {entry.id!r} has the status {entry.status!r}; "
                f"an entry can only be {CANCELLED!r}, {ABANDONED!r} or {BEGUN!r}",
                [entry.id],
                (entry.start, entry.end),
            )
    if bound.at is not None:
        now = violations.time(bound.at)
        for occurrence in bound.occurrences:
            if occurrence.entry.status == BEGUN and occurrence.past is None:
                _add(occurrence, f"is {BEGUN!r}, but begins after {now}", violations)
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
                f"is {ABANDONED!r}, but it is in no optional group that lacks other actions",
                violations,
            )


def _present_in_part(bound: BoundSchedule) -> set[str]:
    """The actions of optional groups that are present only in part."""
    return {
        name
        for group in bound.groups.values()
        if not group.required and not bound.is_present(group)
        for name in group.actions
    }


def _check_cancelled(bound: BoundSchedule, occurrence: Occurrence, violations: Violations) -> None:
    action, at = occurrence.action, violations.time(occurrence.end)
    if action.occurrence_bounds[0] > 0:
        _add(occurrence, f"is {CANCELLED!r}, but the task requires it", violations)
    elif action.deadline is None or bound.clock.number(action.deadline) > occurrence.end:
        _add(
            occurrence,
            f"is {CANCELLED!r} at {at}, but the task gives it no deadline at that time",
            violations,
        )


def _check_begun(at: Number, occurrence: Occurrence, violations: Violations) -> None:
    """Checks that abandoned entries have begun, and that cancelled entries have ended by now."""
    now = violations.time(at)
    if occurrence.past is None:
        _add(occurrence, f"is {occurrence.entry.status!r}, but has not begun at {now}", violations)
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
    """Whether all entries of an action are marked as abandoned."""
    return all(o.entry.status == ABANDONED for o in bound.by_action[name] if not o.cancelled)


def given_up(bound: BoundSchedule) -> frozenset[str]:
    """The optional groups that are present in part, where each entry is accounted for.

    Each of their entries is marked as abandoned, or is in another group that is wholly present.
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
