"""Rules 4 and 5: renewable capacity at every instant, and the levels of reservoirs.

Both are sweeps over the instants at which something changes: O(n log n).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import chain, groupby
from operator import itemgetter

from irc.model import Resource
from irc.model.quantities import Number
from irc.validation.subject import Occurrence, Subject, UncheckedTaskError
from irc.validation.verdict import Violations, listed

_Step = tuple[int, int, int]
"""The place of an instant in time, by how much something changes then, and the number of the
occurrence that does it (-1: none). Places are whole numbers, which sort far faster than times."""


class _Instants:
    """The instants that matter, in order."""

    def __init__(self, times: Iterable[Number]) -> None:
        self.times = sorted(set(times))
        self.place = {time: place for place, time in enumerate(self.times)}


def check_capacity(subject: Subject, violations: Violations) -> None:
    """Rule 4: use is held over [start, end), so what is freed at t can be taken at t."""
    holders = [
        occurrence
        for occurrence in subject.occurrences
        if occurrence.entry.resources and occurrence.start < occurrence.end
    ]
    capacities = {
        resource.id: _capacities(subject, resource)
        for resource in subject.resources.values()
        if resource.kind == "renewable"
    }
    instants = _Instants(
        chain(
            (occurrence.start for occurrence in holders),
            (occurrence.end for occurrence in holders),
            *capacities.values(),
        )
    )
    steps: dict[str, list[_Step]] = {}
    for occurrence in holders:
        start, end = instants.place[occurrence.start], instants.place[occurrence.end]
        for name, amount in occurrence.entry.resources.items():
            if amount > 0 and name in capacities:
                steps.setdefault(name, []).append((start, amount, occurrence.number))
                steps[name].append((end, -amount, occurrence.number))
    for name, own in steps.items():
        _check_renewable(subject, name, own, capacities[name], instants, violations)


def _check_renewable(
    subject: Subject,
    name: str,
    steps: list[_Step],
    capacities: Mapping[Number, int],
    instants: _Instants,
    violations: Violations,
) -> None:
    capacity, in_use = subject.resources[name].capacity, 0
    holding: dict[int, int] = {}
    steps += [(instants.place[time], 0, -1) for time in capacities]
    for place, group in groupby(sorted(steps), key=itemgetter(0)):
        time = instants.times[place]
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
            _add_overload(subject, name, time, in_use, capacity, holding, violations)


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
    name: str,
    time: Number,
    in_use: int,
    capacity: int,
    holding: dict[int, int],
    violations: Violations,
) -> None:
    users = [subject.occurrences[number] for number in holding]
    named = listed((user.entry.id for user in users), len(holding))
    violations.add(
        "capacity",
        f"{in_use} of {name!r} are in use at {violations.time(time)}, "
        f"its capacity then is {capacity} (used by {named})",
        (user.entry.id for user in users),
        (time,),
        carried=all(user.past for user in users),
    )


def check_reservoirs(subject: Subject, violations: Violations) -> None:
    """Rule 5: the net level after all changes of an instant stays within [min, max]."""
    changes: dict[str, list[tuple[Number, int, int]]] = {}
    for occurrence in subject.occurrences:
        action = occurrence.action
        for change in action.consumes:
            at = change.at or "start"
            if at == "end" and occurrence.cancelled:
                continue
            time = _time(occurrence, at)
            step = (time, -change.amount, occurrence.number)
            changes.setdefault(change.resource, []).append(step)
        for change in action.produces:
            at = change.at or "end"
            if at == "end" and occurrence.cancelled:
                continue
            time = _time(occurrence, at)
            step = (time, change.amount, occurrence.number)
            changes.setdefault(change.resource, []).append(step)
    # What no action changes at t = 0 has its initial level there.
    instants = _Instants(chain([0], (time for own in changes.values() for time, _, _ in own)))
    for resource in subject.resources.values():
        if resource.kind == "reservoir":
            own = changes.get(resource.id, [])
            steps = [(instants.place[time], amount, number) for time, amount, number in own]
            _check_reservoir(subject, resource, steps, instants, violations)


def _time(occurrence: Occurrence, at: str) -> Number:
    return occurrence.end if at == "end" else occurrence.start


def _check_reservoir(
    subject: Subject,
    resource: Resource,
    steps: list[_Step],
    instants: _Instants,
    violations: Violations,
) -> None:
    level, was_within, was_carried = resource.initial, True, False
    by_history, has_history = resource.initial, False
    steps.append((instants.place[0], 0, -1))
    for place, group in groupby(sorted(steps), key=itemgetter(0)):
        members = list(group)
        net = sum(amount for _, amount, _ in members)
        past = [amount for _, amount, n in members if n >= 0 and subject.occurrences[n].past]
        level += net
        by_history += sum(past)
        has_history = has_history or bool(past)
        within = resource.min <= level and (resource.max is None or level <= resource.max)
        if level < resource.min:
            worse, mended_by = net < 0, min(level - by_history, net - sum(past))
        else:
            worse, mended_by = net > 0, min(by_history - level, sum(past) - net)
        # What is open makes it no worse, neither by now nor at this instant.
        carried = has_history and mended_by >= 0
        if not within and (was_within or worse or (was_carried and not carried)):
            doers = [subject.occurrences[n].entry.id for _, _, n in members if n >= 0]
            _add_level(resource, instants.times[place], level, doers, carried, violations)
        was_within, was_carried = within, not within and carried


def _add_level(
    resource: Resource,
    time: Number,
    level: int,
    doers: list[str],
    carried: bool,
    violations: Violations,
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
        carried=carried,
    )
