"""`Task` → `Problem`: exact times become ticks, names become indexes, arrays a canonical order."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from math import gcd

from irc.model import Action, DurationRange, Precedence, Task, Use
from irc.problem import Activity, Arc, Claim, Problem, Renewable, Requirement, Shared
from irc.times import Clock, Instant, Number, TimeError, common_tick

_FROM_END = {"finish-start", "finish-finish"}
_TO_END = {"finish-finish", "start-finish"}

_DIGITS = re.compile(r"([0-9]{1,18})")

ToTicks = Callable[[Instant], int]


def lower(task: Task) -> Problem:
    """The part of a task that every schedule contains, as integers.

    That is the whole task where it has only "once" actions, no state, no stock and no calendars;
    of other tasks it is a relaxation (what holds of it holds of every valid schedule), which is
    what the checks look at. Elements that refer to nothing are left out: the structural checks
    have told of them.
    """
    clock = task.clock
    unsure = {name for group in task.groups if not group.required for name in group.actions}
    actions = {
        a.id: i
        for i, a in reversed(list(enumerate(task.actions)))
        if a.id not in unsure and _is_sure(a, clock)
    }
    to_ticks, tick = _tick(task, actions.values(), clock)
    ids = sorted(actions, key=natural_order)
    resources = {r.id: i for i, r in reversed(list(enumerate(task.resources)))}
    renewable = (r for r in resources if task.resources[resources[r]].kind == "renewable")
    resource_ids = sorted(renewable, key=natural_order)
    resource_index = {name: k for k, name in enumerate(resource_ids)}
    renewables = tuple(
        Renewable(name, _greatest_capacity(task, resources[name]), ("resources", resources[name]))
        for name in resource_ids
    )
    return Problem(
        name=task.name,
        time_unit=task.time_unit,
        tick=tick,
        activities=tuple(
            _activity(task.actions[actions[name]], actions[name], resource_index, to_ticks)
            for name in ids
        ),
        resources=renewables,
        shared=tuple(Shared(r.id, r.capacity, (k,)) for k, r in enumerate(renewables)),
        arcs=_arcs(task, {name: k for k, name in enumerate(ids)}, to_ticks),
        deadline=None if task.deadline is None else _ticks_or_none(task.deadline, to_ticks),
    )


def natural_order(name: str) -> tuple[list[tuple[int, str]], str]:
    """Sorts names as people do: "job2" before "job10"."""
    parts = _DIGITS.split(name)
    return [(int(p), "") if k % 2 else (-1, p) for k, p in enumerate(parts)], name


def _greatest_capacity(task: Task, index: int) -> int:
    resource = task.resources[index]
    return max((resource.capacity, *(w.capacity for w in resource.availability)))


def _is_sure(action: Action, clock: Clock) -> bool:
    """Whether every schedule contains the action exactly once, with durations that make sense."""
    if type(action.duration) is int and not action.modes and action.occurs == "once":
        return action.duration >= 0
    if action.occurrence_bounds != (1, 1) or not (action.duration is not None or action.modes):
        return False
    try:
        return all(0 <= lo <= hi for lo, hi in _duration_numbers(action, clock))
    except TimeError:
        return False


def _duration_numbers(action: Action, clock: Clock) -> Iterator[tuple[Number, Number]]:
    durations = [m.duration for m in action.modes] if action.modes else [action.duration]
    for duration in durations:
        if isinstance(duration, DurationRange):
            yield clock.number(duration.min), clock.number(duration.max)
        elif duration is not None:
            value = clock.number(duration)
            yield value, value


def _tick(task: Task, kept: Iterable[int], clock: Clock) -> tuple[ToTicks, Fraction]:
    """The largest tick that divides every time of the task, and how to count in it."""
    numbers: dict[Instant, Number] = {}
    for value in _times(task, kept):
        if value not in numbers:
            try:
                numbers[value] = clock.number(value)
            except TimeError:
                continue
    if all(type(n) is int for n in numbers.values()):
        whole = gcd(*(int(n) for n in numbers.values())) or 1
        tick = Fraction(whole)
    else:
        tick = common_tick(numbers.values())
    ticks = {
        value: int(number / tick) if tick != 1 else int(number) for value, number in numbers.items()
    }
    return ticks.__getitem__, tick


def _times(task: Task, kept: Iterable[int]) -> Iterator[Instant]:
    """Every time of what is kept, as it was written."""
    if task.deadline is not None:
        yield task.deadline
    for i in kept:
        action = task.actions[i]
        durations = [m.duration for m in action.modes] if action.modes else [action.duration]
        for duration in durations:
            if isinstance(duration, DurationRange):
                yield duration.min
                yield duration.max
            elif duration is not None:
                yield duration
        yield action.release
        if action.deadline is not None:
            yield action.deadline
        if action.start is not None:
            yield action.start
    for edge in task.precedence:
        yield edge.min_lag
        if edge.max_lag is not None:
            yield edge.max_lag


def _ticks_or_none(value: Instant, to_ticks: ToTicks) -> int | None:
    """None for a date-time without meaning here or a time before 0; the checks have told of it."""
    try:
        ticks = to_ticks(value)
    except KeyError:
        return None
    return ticks if ticks >= 0 else None


def _activity(
    action: Action, index: int, resource_index: dict[str, int], to_ticks: ToTicks
) -> Activity:
    duration = action.duration
    if action.modes:
        spans = [_span(m.duration, to_ticks) for m in action.modes]
        shortest, longest = min(s[0] for s in spans), max(s[1] for s in spans)
    else:
        shortest, longest = _span(duration, to_ticks)
    uses = _requirements(action.uses, resource_index) if action.uses else ()
    return Activity(
        id=action.id,
        duration_min=shortest,
        duration_max=longest,
        release=_ticks_or_none(action.release, to_ticks) or 0,
        deadline=None if action.deadline is None else _ticks_or_none(action.deadline, to_ticks),
        start=None if action.start is None else _ticks_or_none(action.start, to_ticks),
        uses=uses,
        claims=_claims(uses) if longest else (),
        origin=("actions", index),
    )


def _span(duration: object, to_ticks: ToTicks) -> tuple[int, int]:
    if isinstance(duration, DurationRange):
        return to_ticks(duration.min), to_ticks(duration.max)
    ticks = to_ticks(duration)  # type: ignore[arg-type]
    return ticks, ticks


def _requirements(uses: tuple[Use, ...], resource_index: dict[str, int]) -> tuple[Requirement, ...]:
    requirements = [
        Requirement(tuple(sorted({resource_index[r] for r in use.alternatives})), use.amount, k)
        for k, use in enumerate(uses)
        if use.alternatives and all(r in resource_index for r in use.alternatives)
    ]
    return tuple(sorted(requirements))


def _claims(uses: tuple[Requirement, ...]) -> tuple[Claim, ...]:
    """Every use is open at first. (A zero duration uses nothing, so it claims nothing.)"""
    return tuple(Claim(k, use.alternatives, use.amount) for k, use in enumerate(uses))


def _arcs(task: Task, index: dict[str, int], to_ticks: ToTicks) -> tuple[Arc, ...]:
    """Plain precedences first, then the others, each in canonical order and once."""
    plain: dict[tuple[int, int], int] = {}
    others: dict[tuple[int, ...], Arc] = {}
    for k, edge in enumerate(task.precedence):
        before, after = index.get(edge.before), index.get(edge.after)
        if before is None or after is None or before == after:
            continue
        if edge.max_lag is None and edge.min_lag == 0 and edge.type == "finish-start":
            plain.setdefault((before, after), k)
        else:
            arc = _arc(edge, k, index, to_ticks)
            if arc._replace(origin=0) == Arc(before, after):  # Its lag of 0 is written in units.
                plain.setdefault((before, after), k)
            else:
                others.setdefault(_arc_order(arc), arc)
    return (
        *(Arc(before, after, origin=k) for (before, after), k in sorted(plain.items())),
        *(others[key] for key in sorted(others)),
    )


def _arc(edge: Precedence, origin: int, index: dict[str, int], to_ticks: ToTicks) -> Arc:
    return Arc(
        index[edge.before],
        index[edge.after],
        edge.type in _FROM_END,
        edge.type in _TO_END,
        to_ticks(edge.min_lag),
        None if edge.max_lag is None else to_ticks(edge.max_lag),
        origin,
    )


def _arc_order(arc: Arc) -> tuple[int, ...]:
    return (*arc[:5], arc.max_lag is not None, arc.max_lag or 0)
