"""Structural checks of orders of uses: names, resources, jobs, orders that exclude each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from irc.checks.structure import DeclaredNames
from irc.diagnostics import Code
from irc.diagnostics.source import Pointer
from irc.model import Action, DurationRange, Resource, Task
from irc.model.details import UseOrder

_Next = dict[str, dict[str, tuple[str, Pointer]]]
"""By resource and action: the action that holds it next, and the place of that demand."""


def check_sequences(task: Task, names: DeclaredNames) -> None:
    """Reports orders of uses that have no sense, or that cannot all hold."""
    following: _Next = {}
    for k, order in enumerate(task.sequences):
        at: Pointer = ("sequences", k)
        if order.consecutive is not None:
            _check_consecutive(task, order, at, names, following)
        else:
            _check_same_order(task, order, at, names)
    _check_circles(task, following, names)


# --- one directly after another -----------------------------------------------------------------


def _check_consecutive(
    task: Task, order: UseOrder, at: Pointer, names: DeclaredNames, following: _Next
) -> None:
    pair = order.consecutive or ()
    places = [(*at, "consecutive", j) for j in range(2)]
    known = [_is_action(n, p, names) for n, p in zip(pair, places, strict=True)]
    if not all(known):
        return
    if order.resource is not None and not _is_ordered(order.resource, (*at, "resource"), names):
        return
    if pair[0] == pair[1]:
        names.findings.add(
            Code.SEQUENCE,
            f"action {pair[0]!r} cannot come after itself",
            places[1],
            hint="name two actions",
        )
        return
    held = [_may_hold(names.actions[name]) for name in pair]
    common = held[0] & held[1] if order.resource is None else {order.resource}
    for name, own, place in zip(pair, held, places, strict=True):
        if order.resource is not None and order.resource not in own:
            _add_unused(name, order.resource, place, names)
    if not common:
        names.findings.add(
            Code.WITHOUT_EFFECT,
            f"actions {pair[0]!r} and {pair[1]!r} use no resource in common",
            (*at, "consecutive"),
            hint="let both use the resource on which one follows the other",
        )
    for resource in sorted(common):
        if order.resource is None and not _is_ordered(resource, (*at, "consecutive"), names):
            continue
        if all(_always_holds(task, names, name, resource) for name in pair):
            _add_next(resource, pair, at, names, following)


def _add_next(
    resource: str, pair: Sequence[str], at: Pointer, names: DeclaredNames, following: _Next
) -> None:
    """Notes who is next, and reports a second one."""
    first, second = pair
    nexts = following.setdefault(resource, {})
    known, place = nexts.get(first, (second, at))
    if known != second:
        _add_two(f"after {first!r}", resource, (known, second), place, at, names)
        return
    before = next((a for a, (b, _) in nexts.items() if b == second and a != first), None)
    if before is not None:
        _add_two(f"before {second!r}", resource, (before, first), nexts[before][1], at, names)
        return
    nexts[first] = second, at


def _add_two(
    where: str,
    resource: str,
    both: Sequence[str],
    place: Pointer,
    at: Pointer,
    names: DeclaredNames,
) -> None:
    names.findings.add(
        Code.AT_ODDS,
        f"two actions cannot both be directly {where} on {resource!r}: {both[0]!r}, by sequence "
        f"{int(place[1]) + 1}, and {both[1]!r}",
        at,
        hint="keep one of the two sequences",
    )


def _check_circles(task: Task, following: _Next, names: DeclaredNames) -> None:
    """Reports sequences that, with precedences, lead back to their first action."""
    ahead: dict[str, list[tuple[str, Pointer | None]]] = {}
    for nexts in following.values():
        for first, (second, place) in nexts.items():
            ahead.setdefault(first, []).append((second, place))
    for edge in task.precedence:
        if edge.type == "finish-start" and task.number(edge.min_lag) >= 0:
            ahead.setdefault(edge.before, []).append((edge.after, None))
    seen: set[str] = set()
    for nexts in following.values():
        for first, (second, place) in sorted(nexts.items(), key=lambda item: item[1][1]):
            way = _way(second, first, ahead)
            if way is None or first in seen:
                continue
            seen |= {first, *way}
            names.findings.add(
                Code.CYCLE,
                f"the order of uses leads back to {first!r}: "
                f"{', then '.join(repr(name) for name in (first, *way))}",
                place,
                hint="leave out one of these sequences or precedences",
            )


def _way(
    start: str, target: str, ahead: dict[str, list[tuple[str, Pointer | None]]]
) -> list[str] | None:
    """The actions from one to another, both included; None where no way leads there."""
    came: dict[str, str | None] = {start: None}
    queue = [start]
    for name in queue:
        if name == target:
            path = [name]
            while (before := came[path[-1]]) is not None:
                path.append(before)
            return path[::-1]
        for other, _ in ahead.get(name, ()):
            if other not in came:
                came[other] = name
                queue.append(other)
    return None


# --- the same order on several resources --------------------------------------------------------


def _check_same_order(task: Task, order: UseOrder, at: Pointer, names: DeclaredNames) -> None:
    resources = order.same_order or ()
    places = [(*at, "same_order", j) for j in range(len(resources))]
    known = [_is_ordered(r, p, names) for r, p in zip(resources, places, strict=True)]
    if not all(known):
        return
    for j, resource in enumerate(resources):
        if resource in resources[:j]:
            names.findings.add(
                Code.SEQUENCE,
                f"resource {resource!r} is named twice",
                places[j],
                hint="name each resource once",
            )
            return
    for k, row in enumerate(order.jobs):
        for j, (name, resource) in enumerate(zip(row, resources, strict=True)):
            place = (*at, "jobs", k, j)
            if _is_action(name, place, names) and resource not in _may_hold(names.actions[name]):
                _add_unused(name, resource, place, names)
    if not order.jobs:
        _check_jobs(task, resources, at, names)


def _check_jobs(task: Task, resources: Sequence[str], at: Pointer, names: DeclaredNames) -> None:
    """Each group, and each action in no group, may hold each of the resources by one action."""
    complete = 0
    for what, members in _jobs(task):
        users = [
            [n for n in members if n in names.actions and r in _may_hold(names.actions[n])]
            for r in resources
        ]
        complete += sum(map(bool, users)) > 1
        for resource, own in zip(resources, users, strict=True):
            if len(own) > 1:
                names.findings.add(
                    Code.SEQUENCE,
                    f"{what} uses {resource!r} by more than one action: "
                    f"{', '.join(map(repr, own[:4]))}",
                    (*at, "same_order"),
                    hint='say by "jobs" which action of each job is meant on each resource',
                )
                return
            for name in own:
                _check_single(names.actions[name], (*at, "same_order"), names)
    if complete < 2:
        names.findings.add(
            Code.WITHOUT_EFFECT,
            f"there are no two jobs that use both {resources[0]!r} and {resources[1]!r}: a job is "
            "a group, or an action that uses both",
            (*at, "same_order"),
            hint='put the actions of each job into a group, or list them in "jobs"',
        )


def _jobs(task: Task) -> Iterator[tuple[str, Sequence[str]]]:
    grouped = {name for group in task.groups for name in group.actions}
    for group in task.groups:
        yield f"group {group.id!r}", group.actions
    for action in task.actions:
        if action.id not in grouped:
            yield f"action {action.id!r}", [action.id]


# --- names --------------------------------------------------------------------------------------


def _is_action(name: str, at: Pointer, names: DeclaredNames) -> bool:
    if not names.require("action", name, at):
        return False
    _check_single(names.actions[name], at, names)
    return True


def _check_single(action: Action, at: Pointer, names: DeclaredNames) -> None:
    if action.may_repeat:
        names.findings.add(
            Code.OCCURRENCE,
            f"action {action.id!r} may occur more than once, so its uses have no one place in an "
            "order",
            at,
            hint=f"let {action.id!r} occur at most once",
        )


def _is_ordered(name: str, at: Pointer, names: DeclaredNames) -> bool:
    """Whether it is a resource whose uses come one after another; reports it if not."""
    if not names.require("resource", name, at):
        return False
    resource = names.resources[name]
    if resource.kind != "renewable":
        kind = "takes loads" if resource.kind == "batch" else "is a stock"
        names.findings.add(
            Code.SEQUENCE,
            f"{name!r} {kind}, so its uses do not come one after another",
            at,
            hint="name a renewable resource with a capacity of 1",
        )
        return False
    most = _greatest_capacity(resource)
    if most > 1:
        names.findings.add(
            Code.SEQUENCE,
            f"{name!r} has a capacity of {most}, so its uses do not come one after another",
            at,
            hint="make a resource of each unit, and let uses take `one_of` them",
        )
    return most <= 1


def _greatest_capacity(resource: Resource) -> int:
    return max((resource.capacity, *(window.capacity for window in resource.availability)))


def check_capacity_in_order(task: Task, resource: Resource, capacity: int) -> str | None:
    """The reason why a resource of a sequence cannot have a capacity; None if it can."""
    named = {
        name
        for order in task.sequences
        for name in (*(order.same_order or ()), order.resource)
        if name is not None
    }
    if capacity <= 1 or resource.id not in named:
        return None
    return (
        f"a sequence orders the uses of {resource.id!r}, so one comes after another; "
        f"it cannot have a capacity of {capacity}"
    )


def _add_unused(name: str, resource: str, at: Pointer, names: DeclaredNames) -> None:
    own = sorted(_may_hold(names.actions[name]))
    names.findings.add(
        Code.WITHOUT_EFFECT,
        f"action {name!r} does not use {resource!r}",
        at,
        hint=f"it uses {', '.join(map(repr, own[:6]))}" if own else "it uses nothing",
    )


def _may_hold(action: Action) -> set[str]:
    uses = (*action.uses, *(use for mode in action.modes for use in mode.uses))
    return {name for use in uses for name in use.alternatives}


def _always_holds(task: Task, names: DeclaredNames, name: str, resource: str) -> bool:
    """Whether an action is in every schedule, takes some time, and always holds a resource."""
    action = names.actions[name]
    optional = (group for group in task.groups if not group.required)
    if action.occurs != "once" or any(name in group.actions for group in optional):
        return False
    if action.modes or not any(use.alternatives == (resource,) for use in action.uses):
        return False
    duration = action.duration
    if isinstance(duration, DurationRange):
        duration = duration.min
    return duration is not None and task.number(duration) > 0
