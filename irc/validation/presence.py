"""Rule 1: every required action is present, no other is, and occurrences are in order."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

from irc.schedule import ABANDONED
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.history import check_statuses, given_up, is_abandoned
from irc.validation.verdict import Violations, listed


def check_presence(bound: BoundSchedule, violations: Violations) -> None:
    """Checks occurrence bounds, groups, unknown entries, statuses, numbering and overlap."""
    _check_unknown(bound, violations)
    check_statuses(bound, violations)
    _check_bounds(bound, violations)
    for occurrences in bound.by_action.values():
        if len(occurrences) > 1 or occurrences[0].entry.occurrence != 1:
            _check_numbers(occurrences, violations)
            _check_overlap(occurrences, violations)
    _check_groups(bound, violations)


def _check_unknown(bound: BoundSchedule, violations: Violations) -> None:
    for entry in bound.unknown:
        times = (entry.start, entry.end)
        violations.add("unknown", f"the task has no action {entry.id!r}", [entry.id], times)


def _check_bounds(bound: BoundSchedule, violations: Violations) -> None:
    # An optional group decides for its members, whatever their own default is.
    decided_by_group = {
        name for group in bound.groups.values() if not group.required for name in group.actions
    }
    for name, action in bound.actions.items():
        least, greatest = action.occurrence_bounds
        if name in decided_by_group:
            least = 0
        found = bound.by_action.get(name, ())
        if len(found) < least:
            wanted = "" if least == 1 else f"; it must occur at least {least} times"
            count = f"occurs {len(found)} times" if found else "is missing"
            carried = name in bound.left_out
            violations.add("presence", f"{name!r} {count}{wanted}", [name], carried=carried)
        elif greatest is not None and len(found) > greatest:
            violations.add(
                "presence",
                f"{name!r} occurs {len(found)} times; it may occur at most "
                + ("once" if greatest == 1 else f"{greatest} times"),
                [name],
                (o.start for o in found),
            )


def _check_numbers(occurrences: list[Occurrence], violations: Violations) -> None:
    name = occurrences[0].entry.id
    given = Counter(o.entry.occurrence for o in occurrences)
    for number, count in given.items():
        if count > 1:
            violations.add(
                "occurrence",
                f"occurrence {number} of {name!r} stands {count} times in the schedule",
                [name],
                carried=all(o.past for o in occurrences if o.entry.occurrence == number),
            )
    if set(given) != set(range(1, len(given) + 1)):
        numbers = ", ".join(str(n) for n in sorted(given)[:10])
        violations.add(
            "occurrence",
            f"the occurrences of {name!r} must be numbered from 1 on without a gap, but are "
            f"numbered {numbers}",
            [name],
            carried=all(o.past for o in occurrences),
        )
    for one, two in pairwise(sorted(occurrences, key=lambda o: o.entry.occurrence)):
        if two.start < one.start:
            violations.add(
                "occurrence",
                f"the occurrences of {name!r} are not numbered by start: "
                f"number {two.entry.occurrence} starts at {violations.time(two.start)}, "
                f"number {one.entry.occurrence} at {violations.time(one.start)}",
                [name],
                (one.start, two.start),
                carried=bool(one.past and two.past),
            )


def _check_overlap(occurrences: list[Occurrence], violations: Violations) -> None:
    in_time = sorted(occurrences, key=lambda o: (o.start, o.end))
    running = in_time[0]
    for later in in_time[1:]:
        if later.start < running.end:
            violations.add(
                "occurrence",
                f"two occurrences of {running.entry.id!r} overlap: one lasts until "
                f"{violations.time(running.end)}, another starts at "
                f"{violations.time(later.start)}",
                [running.entry.id],
                (later.start, running.end),
                carried=bool(running.past and later.past),
            )
        if later.end > running.end:
            running = later


def _check_groups(bound: BoundSchedule, violations: Violations) -> None:
    without_blame = given_up(bound)
    for group in bound.groups.values():
        missing = [name for name in group.actions if name not in bound.done]
        if not missing or (len(missing) == len(group.actions) and not group.required):
            continue
        if group.id in without_blame:
            continue
        rule = "is required" if group.required else "is all or none"
        message = f"the group {group.id!r} {rule}; missing: {listed(missing, len(missing))}"
        there = [name for name in group.actions if name in bound.done]
        unmarked = [name for name in there if not is_abandoned(bound, name)]
        if not group.required and len(unmarked) < len(there):
            message += f"; present and not {ABANDONED}: {listed(unmarked, len(unmarked))}"
        left_out = group.required and bound.left_out.issuperset(missing)
        violations.add("group", message, missing, carried=left_out)
