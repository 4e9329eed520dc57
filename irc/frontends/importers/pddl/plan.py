"""Writes a schedule of an imported task as a time-triggered plan of the original PDDL problem.

PDDL2.1 separates dependent happenings by some epsilon; a schedule has ranks instead. Here ranks
become epsilons: each happening moves by a whole number of epsilons, so that happenings of one
instant come in the order of their ranks, durations do not change, and timed initial literals do not
move.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from irc.errors import IrcError
from irc.model import DurationRange, Task
from irc.model.quantities import Number
from irc.schedule import Entry, Schedule
from irc.validation import validate
from irc.validation.ranked import NoRanksError, ScheduleRanks, ranks_of

_VARIANT = re.compile(r" #\d+\Z")

LARGEST_EPSILON = Fraction(1, 1000)
"""The usual epsilon of planners."""


class PlanError(IrcError, ValueError):
    """A schedule that cannot be written as a plan; the message says why."""


def plan_text(task: Task, schedule: Schedule) -> str:
    """The plan: a line `time: (action objects) [duration]` for each entry, in order of time.

    Times are exact; one that no decimal number equals is rounded to a thousandth of the epsilon,
    and a comment says so. Raises `PlanError` for a schedule that is not valid, or is only valid for
    an infinitesimal epsilon.
    """
    verdict = validate(task, schedule)
    if not verdict.valid:
        raise PlanError(f"the schedule is {verdict}")
    try:
        found = ranks_of(task, schedule)
    except NoRanksError as error:
        raise PlanError(f"the schedule's ranks are needed: {error}") from None
    steps = _offsets(schedule.entries, found)
    moved = [(steps[start], steps[end]) for start, end in found.nodes]
    epsilon = _epsilon(task, schedule.entries, moved)
    times = [
        (entry.start + at_start * epsilon, entry.end + at_end * epsilon)
        for entry, (at_start, at_end) in zip(schedule.entries, moved, strict=True)
    ]
    rounded = _rounded(times, epsilon)
    lines = []
    for entry, (start, end) in zip(schedule.entries, rounded or times, strict=True):
        duration = f" [{_decimal(end - start)}]" if end > start else ""
        name = _VARIANT.sub("", entry.id)
        lines.append((start, entry.id, f"{_decimal(start)}: {name}{duration}\n"))
    heading = "; times are rounded: no decimal number equals some of them\n" if rounded else ""
    return heading + "".join(line for _, _, line in sorted(lines))


def _rounded(
    times: Sequence[tuple[Number, Number]], epsilon: Fraction
) -> list[tuple[Fraction, Fraction]] | None:
    """The times as decimal numbers; None where they are some already.

    Equal times stay equal, and others apart.
    """
    step = epsilon / 1000

    def decimal(time: Number) -> Fraction:
        exact = Fraction(time)
        return exact if _digits(exact) is not None else round(exact / step) * step

    made = [(decimal(start), decimal(end)) for start, end in times]
    return None if made == list(times) else made


@dataclass(frozen=True)
class _Tie:
    """offset(later) ≥ offset(earlier) + least"""

    earlier: int
    later: int
    least: int


def _offsets(entries: Sequence[Entry], found: ScheduleRanks) -> list[int]:
    """The number of epsilons by which each rank node moves (difference constraints)."""
    origin = len(found.ranks)
    ties = [_Tie(a, b, least) for a, b, least in found.edges]
    instants: dict[Number, dict[int, set[int]]] = {}
    for entry, (start, end) in zip(entries, found.nodes, strict=True):
        if entry.start == 0:
            ties.append(_Tie(origin, start, 0))
        for time, node in ((entry.start, start), (entry.end, end)):
            instants.setdefault(time, {}).setdefault(found.ranks[node], set()).add(node)
    for time, node in found.changes:
        ties += [_Tie(origin, node, 0), _Tie(node, origin, 0)]
        instants.setdefault(time, {}).setdefault(found.ranks[node], set()).add(node)
    for ranks in instants.values():
        # Happenings of one rank stay together.
        for level in ranks.values():
            first, *others = sorted(level)
            ties += [tie for b in others for tie in (_Tie(first, b, 0), _Tie(b, first, 0))]
        for lower, upper in pairwise(sorted(ranks)):
            ties.append(_Tie(min(ranks[lower]), min(ranks[upper]), 1))
    offsets = [0] * (origin + 1)
    for _ in range(len(offsets) + 1):
        changed = False
        for tie in ties:
            if offsets[tie.earlier] > offsets[tie.later] - tie.least:
                offsets[tie.earlier] = offsets[tie.later] - tie.least
                changed = True
        if not changed:
            return [offset - offsets[origin] for offset in offsets[:origin]]
    raise PlanError(
        "the schedule leaves no room for any epsilon: a happening must come just before t = 0 or "
        "just before a timed initial literal that it cannot come before"
    )


def _epsilon(task: Task, entries: Iterable[Entry], moved: Sequence[tuple[int, int]]) -> Fraction:
    """A power of ten so small that the order of times stays and ranges of durations hold."""
    steps = [step for pair in moved for step in pair]
    most = max(steps, default=0) - min(steps, default=0) + 1
    times = sorted(
        {Fraction(time) for entry in entries for time in (entry.start, entry.end)} | {Fraction(0)}
    )
    room = [later - earlier for earlier, later in pairwise(times)]
    durations = {action.id: action.duration for action in task.actions}
    for entry in entries:
        duration = durations[entry.id]
        if isinstance(duration, DurationRange):
            lasts = entry.end - entry.start
            bounds = (lasts - task.number(duration.min), task.number(duration.max) - lasts)
            room += [Fraction(slack) for slack in bounds if slack]
    wanted = min([LARGEST_EPSILON, *(gap / (2 * most) for gap in room)])
    epsilon = LARGEST_EPSILON
    while epsilon > wanted:
        epsilon /= 10
    return epsilon


def _digits(value: Fraction) -> int | None:
    """The decimal places that a number has; None where no decimal number equals it."""
    digits, rest = 0, value.denominator
    for factor in (2, 5):
        count = 0
        while rest % factor == 0:
            rest //= factor
            count += 1
        digits = max(digits, count)
    return digits if rest == 1 else None


def _decimal(value: Number) -> str:
    """The decimal number that equals a value."""
    value = Fraction(value)
    digits = _digits(value)
    assert digits is not None, f"no decimal number equals {value}"
    whole = str(abs(value.numerator) * 10**digits // value.denominator).rjust(digits + 1, "0")
    sign = "-" if value < 0 else ""
    if not digits:
        return f"{sign}{whole}"
    return f"{sign}{whole[: len(whole) - digits]}.{whole[len(whole) - digits :]}"
