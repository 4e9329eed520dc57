"""Checks for cycles, windows, deadlines, lags and demands that no schedule can satisfy.

They read the lowered task, whose elements know where they were written.
"""

from __future__ import annotations

from collections import Counter

from irc.diagnostics import Code, Findings
from irc.diagnostics.source import Pointer
from irc.problem import Activity, Problem
from irc.problem.temporal_network import Times, earliest
from irc.problem.time_points import DURATION, TimingNetwork, timing_network

_LONGEST_SHOWN = 8


def check_temporal(problem: Problem, findings: Findings) -> None:
    """Adds temporal constraints and demands that no schedule can satisfy."""
    impossible = {
        i for i, activity in enumerate(problem.activities) if _check_window(problem, i, findings)
    }
    timing = timing_network(problem)
    times = earliest(timing.network, timing.floors)
    for cycle in times.cycles:
        _report_cycle(problem, timing, cycle, findings)
    _check_latest(problem, timing, times, impossible, findings)
    _check_demand(problem, findings)


def _check_window(problem: Problem, index: int, findings: Findings) -> bool:
    """Whether an activity's own fields leave it no room; reports it if so."""
    activity = problem.activities[index]
    if activity.start is not None and activity.start < activity.release:
        findings.add(
            Code.WINDOW,
            f"action {activity.id!r} is fixed to start at {problem.time_text(activity.start)}, "
            f"before its release at {problem.time_text(activity.release)}",
            (*activity.origin, "start"),
            hint=f"the start must be at least {problem.time_text(activity.release)}",
        )
        return True
    start = activity.start if activity.start is not None else activity.release
    if activity.latest_start is not None and start > activity.latest_start:
        findings.add(
            Code.WINDOW,
            f"action {activity.id!r} cannot start by its latest start of "
            f"{problem.time_text(activity.latest_start)}: "
            f"it starts at {problem.time_text(start)} at the earliest",
            (*activity.origin, "latest_start"),
            hint=f"the latest start must be at least {problem.time_text(start)}",
        )
        return True
    if _ends_too_early(problem, index, findings):
        return True
    deadline = activity.deadline
    if deadline is None:
        return False
    if deadline < 0:
        return True  # It may occur at most 0 times, which other checks report.
    if start + activity.duration_min <= deadline:
        return False
    findings.add(
        Code.WINDOW,
        f"action {activity.id!r} cannot end by {_whose(activity)} {problem.time_text(deadline)}: "
        f"it starts at {problem.time_text(start)} at the earliest "
        f"and takes {problem.time_text(activity.duration_min)}",
        activity.deadline_origin,
        hint=f"the deadline must be at least {problem.time_text(start + activity.duration_min)}",
    )
    return True


def _ends_too_early(problem: Problem, index: int, findings: Findings) -> bool:
    """Whether an activity cannot last until its earliest end; reports it if so."""
    activity = problem.activities[index]
    earliest = activity.earliest_end
    if earliest is None:
        return False
    latest = activity.latest_start if activity.start is None else activity.start
    ends = None if latest is None else latest + activity.duration_max
    why = "it starts"
    if latest is not None:
        why = f"it starts by {problem.time_text(latest)} and takes "
        why += f"{problem.time_text(activity.duration_max)} at most"
    deadline = activity.deadline
    if deadline is not None and deadline >= 0 and (ends is None or deadline < ends):
        ends, why = deadline, f"{_whose(activity)} {problem.time_text(deadline)} comes first"
    if ends is None or ends >= earliest:
        return False
    findings.add(
        Code.WINDOW,
        f"action {activity.id!r} cannot end at its earliest end of "
        f"{problem.time_text(earliest)} or later: {why}",
        (*activity.origin, "earliest_end"),
        hint=f"the earliest end must be at most {problem.time_text(ends)}",
    )
    return True


def _whose(activity: Activity) -> str:
    by = activity.deadline_by
    return "its deadline of" if by is None else f"the deadline of group {by.group!r},"


def _step(problem: Problem, timing: TimingNetwork, edge: int) -> str:
    """The text of one constraint."""
    label, is_max = timing.labels[edge]
    if label == DURATION:
        activity = problem.activities[timing.owner[timing.network.src[edge]]]
        limit = activity.duration_max if is_max else activity.duration_min
        word = "at most" if is_max else "at least"
        return f"{activity.id!r} takes {word} {problem.time_text(limit)}"
    # (Loaded for a message only.)
    from irc.problem.arc_text import arc_in_words
    from irc.problem.statements import Side

    return arc_in_words(problem, problem.arcs[label], Side.MOST if is_max else Side.LEAST)


def _origin(problem: Problem, timing: TimingNetwork, edge: int) -> Pointer:
    label, is_max = timing.labels[edge]
    if label == DURATION:
        return (*problem.activities[timing.owner[timing.network.src[edge]]].origin, "duration")
    pointer: Pointer = ("precedence", problem.arcs[label].origin)
    return (*pointer, "max_lag") if is_max else pointer


def _report_cycle(
    problem: Problem, timing: TimingNetwork, cycle: list[int], findings: Findings
) -> None:
    if len({timing.labels[edge][0] for edge in cycle}) == 1:
        return  # One precedence with contradictory lags: the structural checks report that.
    network = timing.network
    excess = sum(network.weight[edge] for edge in cycle)
    only_order = not any(timing.labels[edge][1] for edge in cycle)
    edges = [edge for edge in cycle if timing.labels[edge][0] != DURATION]
    # The last written precedence of the cycle is where an author would look first.
    last = max(edges, key=lambda e: problem.arcs[timing.labels[e][0]].origin)
    pointer = _origin(problem, timing, last)
    if only_order:
        turned = cycle[cycle.index(last) :] + cycle[: cycle.index(last)]
        names: list[str] = []
        for edge in turned:
            name = problem.activities[timing.owner[network.dst[edge]]].id
            if not names or names[-1] != name:
                names.append(name)
        shown = [names[-1], *names]
        findings.add(
            Code.CYCLE,
            f"{'these actions wait' if len(names) > 1 else 'this action waits'} for each other: "
            f"{_joined(shown)}",
            pointer,
            hint="remove or reverse one of these precedences",
        )
        return
    steps = "; ".join(_step(problem, timing, edge) for edge in cycle[:_LONGEST_SHOWN])
    more = f"; and {len(cycle) - _LONGEST_SHOWN} more" if len(cycle) > _LONGEST_SHOWN else ""
    findings.add(
        Code.LAGS,
        f"these statements contradict each other by {problem.time_text(excess)}: {steps}{more}",
        pointer,
        hint="raise a maximum or lower a minimum",
    )


def _joined(names: list[str]) -> str:
    quoted = [repr(n) for n in names]
    if len(quoted) > _LONGEST_SHOWN:
        middle = len(quoted) - _LONGEST_SHOWN + 1
        quoted = [*quoted[: _LONGEST_SHOWN - 2], f"… ({middle} more)", quoted[-1]]
    return " → ".join(quoted)


def _check_latest(
    problem: Problem,
    timing: TimingNetwork,
    times: Times,
    impossible: set[int],
    findings: Findings,
) -> None:
    """Compares fixed and latest starts and deadlines with the earliest times by precedence."""
    points = timing.points
    latest_end, last = -1, 0
    for i, activity in enumerate(problem.activities):
        start = times.t[points.start[i]]
        end = max(times.t[points.end[i]] + points.end_offset[i], start + activity.duration_min)
        if end > latest_end:
            latest_end, last = end, i
        if i in impossible:
            continue
        if activity.start is not None and start > activity.start:
            findings.add(
                Code.TOO_LATE,
                f"action {activity.id!r} is fixed to start at {problem.time_text(activity.start)}, "
                f"but cannot start before {problem.time_text(start)}"
                + _because(problem, timing, times, points.start[i]),
                (*activity.origin, "start"),
                hint=f"the start must be at least {problem.time_text(start)}",
            )
        elif activity.latest_start is not None and start > activity.latest_start:
            findings.add(
                Code.TOO_LATE,
                f"action {activity.id!r} has the latest start "
                f"{problem.time_text(activity.latest_start)}, "
                f"but cannot start before {problem.time_text(start)}"
                + _because(problem, timing, times, points.start[i]),
                (*activity.origin, "latest_start"),
                hint=f"the latest start must be at least {problem.time_text(start)}",
            )
        elif activity.deadline is not None and end > activity.deadline:
            findings.add(
                Code.TOO_LATE,
                _too_late(problem, activity, end) + _because(problem, timing, times, points.end[i]),
                activity.deadline_origin,
                hint=f"the deadline must be at least {problem.time_text(end)}",
            )
    if problem.deadline is not None and latest_end > problem.deadline:
        findings.add(
            Code.TOO_LATE,
            f"the task's deadline is {problem.time_text(problem.deadline)}, but action "
            f"{problem.activities[last].id!r} cannot end before {problem.time_text(latest_end)}"
            + _because(problem, timing, times, points.end[last]),
            ("deadline",),
            hint=f"the deadline must be at least {problem.time_text(latest_end)}",
        )


def _too_late(problem: Problem, activity: Activity, end: int) -> str:
    deadline, earliest_end = problem.time_text(activity.deadline or 0), problem.time_text(end)
    if activity.deadline_by is None:
        return (
            f"action {activity.id!r} has the deadline {deadline}, "
            f"but cannot end before {earliest_end}"
        )
    return (
        f"group {activity.deadline_by.group!r} has the deadline {deadline}, "
        f"but action {activity.id!r} cannot end before {earliest_end}"
    )


def _because(problem: Problem, timing: TimingNetwork, times: Times, point: int) -> str:
    chain = times.chain(point, timing.network)
    if not chain:
        return ""
    ids: list[str] = []
    for p in [timing.network.src[chain[0]], *(timing.network.dst[edge] for edge in chain)]:
        name = problem.activities[timing.owner[p]].id
        if not ids or ids[-1] != name:
            ids.append(name)
    return f" (critical path: {_joined(ids)})" if len(ids) > 1 else ""


def _check_demand(problem: Problem, findings: Findings) -> None:
    for activity in problem.activities:
        if not activity.uses or activity.duration_min == 0:
            continue  # A zero duration uses nothing.
        if _check_single_demands(problem, activity, findings):
            _check_joint_demand(problem, activity, findings)


def _check_single_demands(problem: Problem, activity: Activity, findings: Findings) -> bool:
    fits = True
    for use in activity.uses:
        best = max(use.alternatives, key=lambda r: problem.resources[r].capacity)
        capacity = problem.resources[best].capacity
        if use.amount > capacity:
            fits = False
            which = (
                f"{problem.resources[best].id!r} has only {capacity}"
                if len(use.alternatives) == 1
                else f"no alternative has more than {capacity}"
            )
            findings.add(
                Code.DEMAND,
                f"action {activity.id!r} needs {use.amount} units, but {which}",
                (*activity.origin, "uses"),
                hint="raise the capacity or lower the amount",
            )
    return fits


def _check_joint_demand(problem: Problem, activity: Activity, findings: Findings) -> None:
    """Compares the sum of an activity's plain uses of one resource with its capacity."""
    needed: Counter[int] = Counter()
    for use in activity.uses:
        if len(use.alternatives) == 1:
            needed[use.alternatives[0]] += use.amount
    for r, amount in needed.items():
        if amount > problem.resources[r].capacity:
            findings.add(
                Code.DEMAND,
                f"action {activity.id!r} needs {amount} units of {problem.resources[r].id!r} "
                f"in all, which has only {problem.resources[r].capacity}",
                (*activity.origin, "uses"),
                hint="raise the capacity or lower the amounts",
            )
