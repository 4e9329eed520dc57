"""Checks of set-ups and loads: rows that contradict each other, families, capacities."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from irc.diagnostics import Code, Findings, did_you_mean
from irc.diagnostics.source import Pointer
from irc.model import Action, Resource, Task, Use
from irc.model.base import write_time

if TYPE_CHECKING:
    from irc.checks.structure import DeclaredNames, TimeChecks

ANY = "*"
"""In a row, any family that the other one is not."""

_MOST_NAMED = 6


def check_setups(task: Task, names: DeclaredNames, times: TimeChecks, findings: Findings) -> None:
    """Adds the faults of set-ups and of the families of uses."""
    for i, resource in enumerate(task.resources):
        if resource.kind == "batch":
            _check_batch(task, resource, ("resources", i), findings)
        elif (resource.setups is not None or resource.no_idle) and resource.kind == "renewable":
            _check_resource(resource, ("resources", i), times, findings)
    for i, action in enumerate(task.actions):
        if action.is_simple:
            continue
        owner = f"action {action.id!r}"
        _check_uses(action.uses, ("actions", i, "uses"), owner, names, findings)
        for k, mode in enumerate(action.modes):
            at: Pointer = ("actions", i, "modes", k, "uses")
            _check_uses(mode.uses, at, owner, names, findings, beside=action.uses)


def _check_batch(task: Task, resource: Resource, at: Pointer, findings: Findings) -> None:
    """Reports what loads do not have, and uses without a family beside uses with one."""
    for field in ("setups", "no_idle"):
        if getattr(resource, field):
            what = "set-ups" if field == "setups" else "idle time to avoid"
            findings.add(
                Code.SETUPS,
                f"{resource.id!r} takes loads: a batch resource has no {what}",
                (*at, field),
                at_key=True,
                hint='remove it, or make it a renewable resource: "kind": "renewable"',
            )
    uses = [found for i, a in enumerate(task.actions) for found in _uses_of(a, i, resource.id)]
    if not any(use.family is not None for _, _, use in uses):
        return
    for name, place, use in uses:
        if use.family is None:
            findings.add(
                Code.FAMILY,
                f"action {name!r} names no family for {resource.id!r}, unlike others: it is never "
                "in one load with these",
                place,
                hint='add its "family", or one for all of them',
            )


def _uses_of(action: Action, index: int, resource: str) -> Iterator[tuple[str, Pointer, Use]]:
    """The name of an action, the place and the entry of each of its uses of a resource."""
    at: Pointer = ("actions", index)
    parts = [(action.uses, (*at, "uses"))]
    parts += [(mode.uses, (*at, "modes", m, "uses")) for m, mode in enumerate(action.modes)]
    for uses, place in parts:
        for k, use in enumerate(uses):
            if resource in use.alternatives:
                yield action.id, (*place, k), use


def check_capacity_with_setups(resource: Resource, capacity: int) -> str | None:
    """The reason why a resource cannot have a capacity; None if it can."""
    if capacity <= 1 or (resource.setups is None and not resource.no_idle):
        return None
    why = "has set-ups" if resource.setups is not None else "may have no idle time"
    return (
        f"{resource.id!r} {why}, so one use comes after another; "
        f"it cannot have a capacity of {capacity}"
    )


def _check_resource(resource: Resource, at: Pointer, times: TimeChecks, findings: Findings) -> None:
    capacities = [(resource.capacity, (*at, "capacity"))]
    for k, window in enumerate(resource.availability):
        capacities.append((window.capacity, (*at, "availability", k, "capacity")))
    for capacity, place in capacities:
        if (wrong := check_capacity_with_setups(resource, capacity)) is not None:
            hint = "make a resource of each unit, and let uses take `one_of` them"
            findings.add(Code.SETUPS, wrong, place, hint=hint)
    _check_rows(resource, at, times, findings)


def _check_rows(resource: Resource, at: Pointer, times: TimeChecks, findings: Findings) -> None:
    setups = resource.setups
    if setups is None:
        return
    first: dict[tuple[str, str], int] = {}
    for k, row in enumerate(setups.times):
        place: Pointer = (*at, "setups", "times", k)
        owner = f"the set-up of {resource.id!r} from {row.from_!r} to {row.to!r}"
        length = times.number(row.time, "time", (*place, "time"))
        if length is not None and length < 0:
            findings.add(
                Code.NEGATIVE_TIME,
                f"{owner} is negative: {write_time(row.time)}",
                (*place, "time"),
                hint="a set-up takes 0 or more",
            )
        earlier = first.setdefault((row.from_, row.to), k)
        if earlier == k:
            continue
        other = setups.times[earlier]
        if other == row:
            _add_repeated(owner, place, findings)
        else:
            findings.add(
                Code.SETUPS,
                f"{owner} is given twice: {_row(other.time, other.cost)} in row {earlier + 1}, "
                f"{_row(row.time, row.cost)} in row {k + 1}",
                place,
                hint="keep one of the two rows",
            )
    if setups.initial == ANY:
        findings.add(
            Code.SETUPS,
            f"{resource.id!r} begins with the family {ANY!r}, which means any other",
            (*at, "setups", "initial"),
            hint='name the family that it is set up for, or leave "initial" out',
        )


def _add_repeated(owner: str, place: Pointer, findings: Findings) -> None:
    from irc.diagnostics.fix import removed

    findings.add(
        Code.REPEATED,
        f"{owner} is stated twice; it counts once",
        place,
        hint="remove the repetition",
        fix=removed(place),
    )


def _row(time: object, cost: int) -> str:
    return f"{write_time(time)} with a cost of {cost}" if cost else f"{write_time(time)}"


def _check_uses(
    uses: Sequence[Use],
    at: Pointer,
    owner: str,
    names: DeclaredNames,
    findings: Findings,
    beside: Sequence[Use] = (),
) -> None:
    held: dict[str, str | None] = {}
    for use in beside:
        held.update(dict.fromkeys(use.alternatives, use.family))
    for k, use in enumerate(uses):
        resources = [names.resources[r] for r in use.alternatives if r in names.resources]
        with_setups = [r for r in resources if r.setups is not None]
        batches = [r for r in resources if r.kind == "batch"]
        if use.family is not None and (not batches or use.family == ANY):
            _check_family(use.family, with_setups, (*at, k, "family"), owner, findings)
        for resource in (*with_setups, *batches):
            if held.setdefault(resource.id, use.family) != use.family:
                findings.add(
                    Code.SETUPS,
                    f"{owner} can hold {resource.id!r} for two families: "
                    f"{_family(held[resource.id])} and {_family(use.family)}",
                    (*at, k),
                    hint="let only one of its uses name the resource",
                )


def _family(family: str | None) -> str:
    return "none" if family is None else repr(family)


def _check_family(
    family: str, with_setups: Sequence[Resource], at: Pointer, owner: str, findings: Findings
) -> None:
    if family == ANY:
        findings.add(
            Code.SETUPS,
            f"{owner} has the family {ANY!r}, which means any other one in a row of set-ups",
            at,
            hint="name the family of this use",
        )
    elif not with_setups:
        findings.add(
            Code.WITHOUT_EFFECT,
            f"the family of {owner} has no meaning: what it uses has no set-ups and takes no loads",
            at,
            at_key=True,
            hint='add "setups" to the resource, or remove the family',
        )
    elif not any(_knows(resource, family) for resource in with_setups):
        _add_unknown_family(family, with_setups, at, owner, findings)


def _families(resource: Resource) -> list[str]:
    """The families that the rows and the beginning of a resource name."""
    setups = resource.setups
    if setups is None:
        return []
    named = dict.fromkeys(
        family for row in setups.times for family in (row.from_, row.to) if family != ANY
    )
    if setups.initial is not None:
        named[setups.initial] = None
    return list(named)


def _knows(resource: Resource, family: str) -> bool:
    """Whether a row is about a family, perhaps as any other one."""
    rows = () if resource.setups is None else resource.setups.times
    return family in _families(resource) or any(ANY in (row.from_, row.to) for row in rows)


def _add_unknown_family(
    family: str, with_setups: Sequence[Resource], at: Pointer, owner: str, findings: Findings
) -> None:
    known = list(dict.fromkeys(f for resource in with_setups for f in _families(resource)))
    listed = ", ".join(f"`{name}`" for name in known[:_MOST_NAMED])
    which = " or ".join(repr(resource.id) for resource in with_setups)
    findings.add(
        Code.FAMILY,
        f"{owner} has the family {family!r}, which no set-up of {which} names: it needs none",
        at,
        hint=did_you_mean(family, known)
        or (f"the families of its set-ups are {listed}" if known else "add rows of set-ups"),
    )
