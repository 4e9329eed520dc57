"""Rules 4 and 5: renewable capacity at every instant, and the levels of reservoirs.

Both are sweeps over the instants at which something changes: O(n log n).
"""

from __future__ import annotations

from itertools import groupby

from irc.model import Resource
from irc.times import Number
from irc.validate.subject import Occurrence, Subject, UncheckedTaskError
from irc.validate.verdict import Violations, listed

_Step = tuple[Number, int, int]
"""A time, by how much something changes then, and the number of the occurrence that does it."""


def check_capacity(subject: Subject, violations: Violations) -> None:
    """Rule 4: use is held over [start, end), so what is freed at t can be taken at t."""
    holds: dict[str, list[_Step]] = {}
    for occurrence in subject.occurrences:
        if occurrence.end <= occurrence.start:
            continue
        for name, amount in occurrence.entry.resources.items():
            if amount <= 0:
                continue
            steps = holds.setdefault(name, [])
            steps.append((occurrence.start, amount, occurrence.number))
            steps.append((occurrence.end, -amount, occurrence.number))
    for resource in subject.resources.values():
        if resource.kind == "renewable" and resource.id in holds:
            _check_renewable(subject, resource, holds[resource.id], violations)


def _check_renewable(
    subject: Subject, resource: Resource, steps: list[_Step], violations: Violations
) -> None:
    capacities = _capacities(subject, resource)
    capacity, in_use = resource.capacity, 0
    holding: dict[int, int] = {}
    moments: list[_Step] = [(time, 0, -1) for time in capacities]
    for time, group in groupby(sorted(steps + moments), key=lambda step: step[0]):
        tighter = False
        for _, amount, number in group:
            if number < 0:
                tighter = tighter or capacities[time] < capacity
                capacity = capacities[time]
                continue
            in_use += amount
            tighter = tighter or amount > 0
            if amount > 0:
                holding[number] = amount
            else:
                holding.pop(number, None)
        if tighter and in_use > capacity:
            _add_overload(subject, resource, time, in_use, capacity, holding, violations)


def _capacities(subject: Subject, resource: Resource) -> dict[Number, int]:
    """The capacity from each instant on at which an availability window starts or ends."""
    number = subject.clock.number
    windows = sorted(
        (number(w.from_), number(w.to), w.capacity)
        for w in dict.fromkeys(resource.availability)
        if number(w.from_) < number(w.to)
    )
    capacities: dict[Number, int] = {}
    last: Number | None = None
    for start, end, capacity in windows:
        if last is not None and start < last:
            raise UncheckedTaskError(f"the availability windows of {resource.id!r} overlap")
        capacities[start] = capacity
        capacities[end] = resource.capacity
        last = end
    return capacities


def _add_overload(
    subject: Subject,
    resource: Resource,
    time: Number,
    in_use: int,
    capacity: int,
    holding: dict[int, int],
    violations: Violations,
) -> None:
    users = (subject.occurrences[number] for number in holding)
    named = listed((user.entry.id for user in users), len(holding))
    violations.add(
        "capacity",
        f"{in_use} of {resource.id!r} are in use at {violations.time(time)}, "
        f"its capacity then is {capacity} (used by {named})",
        (subject.occurrences[number].entry.id for number in holding),
        (time,),
    )


def check_reservoirs(subject: Subject, violations: Violations) -> None:
    """Rule 5: the net level after all changes of an instant stays within [min, max]."""
    changes: dict[str, list[_Step]] = {}
    for occurrence in subject.occurrences:
        action = occurrence.action
        for change in action.consumes:
            time = _time(occurrence, change.at or "start")
            changes.setdefault(change.resource, []).append(
                (time, -change.amount, occurrence.number)
            )
        for change in action.produces:
            time = _time(occurrence, change.at or "end")
            changes.setdefault(change.resource, []).append((time, change.amount, occurrence.number))
    for resource in subject.resources.values():
        if resource.kind == "reservoir":
            _check_reservoir(subject, resource, changes.get(resource.id, []), violations)


def _time(occurrence: Occurrence, at: str) -> Number:
    return occurrence.end if at == "end" else occurrence.start


def _check_reservoir(
    subject: Subject, resource: Resource, changes: list[_Step], violations: Violations
) -> None:
    level, was_within = resource.initial, True
    # What no action changes at t = 0 has its initial level there.
    steps = sorted(changes)
    if not steps or steps[0][0] > 0:
        steps.insert(0, (0, 0, -1))
    for time, group in groupby(steps, key=lambda step: step[0]):
        members = list(group)
        net = sum(amount for _, amount, _ in members)
        level += net
        within = resource.min <= level and (resource.max is None or level <= resource.max)
        worse = net < 0 if level < resource.min else net > 0
        if not within and (was_within or worse):
            doers = [subject.occurrences[n].entry.id for _, _, n in members if n >= 0]
            _add_level(resource, time, level, doers, violations)
        was_within = within


def _add_level(
    resource: Resource, time: Number, level: int, doers: list[str], violations: Violations
) -> None:
    if level < resource.min:
        limit = f"below its minimum {resource.min}"
    else:
        limit = f"above its maximum {resource.max}"
    by = f" (after {listed(doers, len(doers))})" if doers else ""
    violations.add(
        "reservoir",
        f"the level of {resource.id!r} is {level} at {violations.time(time)}, {limit}{by}",
        doers,
        (time,),
    )
