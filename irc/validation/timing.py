"""Rules 2 and 3: durations, releases, fixed and latest starts, deadlines, precedence, its lags."""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType

from irc.model.quantities import Number
from irc.model.times import format_number
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.history import given_up
from irc.validation.verdict import Violations

AT_END = MappingProxyType(
    {
        "finish-start": (True, False),
        "start-start": (False, False),
        "finish-finish": (True, True),
        "start-finish": (False, True),
    }
)
"""For each precedence type: whether it binds the end of `before`, and the end of `after`."""


def check_windows(bound: BoundSchedule, violations: Violations) -> None:
    """Checks rule 2: mode, duration, release, starts and deadlines of each occurrence."""
    deadlines = _group_deadlines(bound)
    if bound.task.deadline is not None:
        of_task = (bound.clock.number(bound.task.deadline), "the task's deadline")
    else:
        of_task = None
    for occurrence in bound.occurrences:
        _check_mode(occurrence, violations)
        _check_duration(occurrence, violations)
        _check_start(bound, occurrence, violations)
        if not occurrence.cancelled:
            _check_end(bound, occurrence, violations)
        limits = deadlines.get(occurrence.entry.id, [])
        if occurrence.action.deadline is not None:
            own = bound.clock.number(occurrence.action.deadline)
            limits = [(own, "its deadline"), *limits]
        if of_task is not None:
            limits = [*limits, of_task]
        for limit, whose in limits:
            if occurrence.end > limit:
                violations.add(
                    "deadline",
                    f"{occurrence.name} ends at {violations.time(occurrence.end)}, "
                    f"after {whose} ({violations.time(limit)})",
                    [occurrence.entry.id],
                    (occurrence.end, limit),
                    carried=occurrence.past is not None and occurrence.past.earliest_end > limit,
                )


def _group_deadlines(bound: BoundSchedule) -> dict[str, list[tuple[Number, str]]]:
    limits: dict[str, list[tuple[Number, str]]] = {}
    no_longer = given_up(bound)
    for group in bound.groups.values():
        if group.deadline is not None and group.id not in no_longer:
            limit = (bound.clock.number(group.deadline), f"the deadline of group {group.id!r}")
            for name in group.actions:
                limits.setdefault(name, []).append(limit)
    return limits


def _check_mode(occurrence: Occurrence, violations: Violations) -> None:
    given, action = occurrence.entry.mode, occurrence.action
    if occurrence.mode is not None or (given is None and not action.modes):
        return
    if not action.modes:
        message = f"{occurrence.name} has no modes, but its entry has the mode {given!r}"
    else:
        known = ", ".join(repr(mode.id) for mode in action.modes[:10])
        fault = f"has no mode {given!r}" if given is not None else "has no mode in the schedule"
        message = f"{occurrence.name} {fault}; its modes are {known}"
    carried = occurrence.past is not None
    violations.add("mode", message, [occurrence.entry.id], carried=carried)


def _check_duration(occurrence: Occurrence, violations: Violations) -> None:
    shortest, longest = occurrence.shortest, occurrence.longest
    lasts = occurrence.end - occurrence.start
    pauses = ""
    if occurrence.paused is not None and longest is not None:
        longest = occurrence.most_work
        lasts -= occurrence.paused
        pauses = f" besides {violations.time(occurrence.paused)} of pauses"
    if shortest is None or longest is None:
        # Its mode is unknown, which is reported elsewhere; still, nothing ends before it starts.
        if lasts >= 0:
            return
        wanted = "a duration of its modes"
    elif shortest <= lasts <= longest:
        return
    elif shortest == longest:
        wanted = violations.time(shortest)
    else:
        wanted = f"{format_number(shortest)} to {violations.time(longest)}"
    violations.add(
        "duration",
        f"{occurrence.name} lasts {violations.time(lasts)} "
        f"({format_number(occurrence.start)} to {format_number(occurrence.end)}){pauses} "
        f"instead of {wanted}",
        [occurrence.entry.id],
        (occurrence.start, occurrence.end),
        # The end of a running action is not certain yet, and nothing ends before it starts. (That
        # an occurrence of an action that repeats takes another time, no task can express.)
        carried=occurrence.past is not None
        and (occurrence.past.over or occurrence.action.may_repeat)
        and lasts >= 0,
    )


def _check_start(bound: BoundSchedule, occurrence: Occurrence, violations: Violations) -> None:
    action, start = occurrence.action, occurrence.start
    release = bound.clock.number(action.release)
    if start < release or start < 0:
        limit = max(0, release)
        why = f"its release ({violations.time(limit)})" if limit else violations.time(0)
        violations.add(
            "release",
            f"{occurrence.name} starts at {violations.time(start)}, before {why}",
            [occurrence.entry.id],
            (start, limit),
            carried=occurrence.past is not None,
        )
    if action.start is not None and start != (fixed := bound.clock.number(action.start)):
        violations.add(
            "start",
            f"{occurrence.name} starts at {violations.time(start)}; "
            f"its start is fixed at {violations.time(fixed)}",
            [occurrence.entry.id],
            (start, fixed),
            carried=occurrence.past is not None,
        )
    if action.latest_start is not None:
        latest = bound.clock.number(action.latest_start)
        if start > latest:
            violations.add(
                "latest_start",
                f"{occurrence.name} starts at {violations.time(start)}, "
                f"after its latest start ({violations.time(latest)})",
                [occurrence.entry.id],
                (start, latest),
                carried=occurrence.past is not None,
            )


def _check_end(bound: BoundSchedule, occurrence: Occurrence, violations: Violations) -> None:
    earliest = occurrence.action.earliest_end
    if earliest is None or occurrence.end >= (limit := bound.clock.number(earliest)):
        return
    violations.add(
        "earliest_end",
        f"{occurrence.name} ends at {violations.time(occurrence.end)}, "
        f"before its earliest end ({violations.time(limit)})",
        [occurrence.entry.id],
        (occurrence.end, limit),
        carried=occurrence.past is not None and occurrence.past.latest_end < limit,
    )


def check_precedence(bound: BoundSchedule, violations: Violations) -> None:
    """Checks rule 3: both lags of every precedence between actions that are present.

    A minimum is compared with ranks, lexicographically; a maximum by time alone.
    """
    number, present, ranked = bound.clock.number, bound.by_action, bound.ranked
    for precedence in bound.task.precedence:
        if precedence.before not in present or precedence.after not in present:
            continue
        before, after = present[precedence.before][0], present[precedence.after][0]
        if before.cancelled or after.cancelled:
            continue
        from_end, to_end = AT_END[precedence.type]
        base = before.end if from_end else before.start
        time = after.end if to_end else after.start
        lag = number(precedence.min_lag)
        if time < base + lag:
            _add_too_early(before, from_end, after, to_end, lag, violations)
        elif ranked and time == base + lag:
            _check_rank(before, from_end, after, to_end, violations)
        if precedence.max_lag is not None:
            longest = number(precedence.max_lag)
            if time > base + longest:
                _add_too_late(before, from_end, after, to_end, longest, violations)


def tight_precedences(bound: BoundSchedule) -> Iterator[tuple[Occurrence, bool, Occurrence, bool]]:
    """The precedences that are met with no time to spare, so that ranks decide.

    Each is `before`, whether its end is bound, `after`, and whether its end is bound."""
    present = bound.by_action
    for precedence in bound.task.precedence:
        if precedence.before not in present or precedence.after not in present:
            continue
        before, after = present[precedence.before][0], present[precedence.after][0]
        if before.cancelled or after.cancelled:
            continue
        from_end, to_end = AT_END[precedence.type]
        base = before.end if from_end else before.start
        time = after.end if to_end else after.start
        if time == base + bound.clock.number(precedence.min_lag):
            yield before, from_end, after, to_end


def _add_too_early(
    before: Occurrence,
    from_end: bool,
    after: Occurrence,
    to_end: bool,
    lag: Number,
    violations: Violations,
) -> None:
    base = before.end if from_end else before.start
    time = after.end if to_end else after.start
    plus = f" ({violations.time(base)}) + lag {violations.time(lag)}" if lag else ""
    violations.add(
        "precedence",
        f"{after.name} {_verb(to_end)} at {violations.time(time)}, but must not {_noun(to_end)} "
        f"before {violations.time(base + lag)}: the {_noun(from_end)} of {before.name}{plus}",
        [before.entry.id, after.entry.id],
        (time, base + lag),
        carried=_is_certain(before, from_end, after, to_end, least=lag),
    )


def _add_too_late(
    before: Occurrence,
    from_end: bool,
    after: Occurrence,
    to_end: bool,
    longest: Number,
    violations: Violations,
) -> None:
    base = before.end if from_end else before.start
    time = after.end if to_end else after.start
    violations.add(
        "precedence",
        f"{after.name} {_verb(to_end)} at {violations.time(time)}, but must not {_noun(to_end)} "
        f"after {violations.time(base + longest)}: the {_noun(from_end)} of {before.name} "
        f"({violations.time(base)}) + maximum lag {violations.time(longest)}",
        [before.entry.id, after.entry.id],
        (time, base + longest),
        carried=_is_certain(before, from_end, after, to_end, most=longest),
    )


def _check_rank(
    before: Occurrence, from_end: bool, after: Occurrence, to_end: bool, violations: Violations
) -> None:
    base_rank = before.end_rank if from_end else before.rank
    rank = after.end_rank if to_end else after.rank
    if rank >= base_rank:
        return
    time = after.end if to_end else after.start
    violations.add(
        "precedence",
        f"{after.name} {_verb(to_end)} at {violations.time(time)} with rank {rank}, but needs at "
        f"least rank {base_rank}, the rank of the {_noun(from_end)} of {before.name}",
        [before.entry.id, after.entry.id],
        (time,),
        carried=all(
            occurrence.past is not None and (occurrence.past.end_is_certain or not at_end)
            for occurrence, at_end in ((before, from_end), (after, to_end))
        ),
    )


def _is_certain(
    before: Occurrence,
    from_end: bool,
    after: Occurrence,
    to_end: bool,
    *,
    least: Number | None = None,
    most: Number | None = None,
) -> bool:
    """Whether the history of both already breaks a lag, wherever they end from now on."""
    if before.past is None or after.past is None:
        return False
    base, time = (before.start, before.start), (after.start, after.start)
    if from_end:
        base = (before.past.earliest_end, before.past.latest_end)
    if to_end:
        time = (after.past.earliest_end, after.past.latest_end)
    if least is not None:
        return time[1] < base[0] + least
    return most is not None and time[0] > base[1] + most


def _verb(at_end: bool) -> str:
    return "ends" if at_end else "starts"


def _noun(at_end: bool) -> str:
    return "end" if at_end else "start"
