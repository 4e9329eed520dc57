"""Rule 4.6: uses of a batch resource that overlap are one load.

One pass over the uses of each resource in the order of their starts: O(n log n).
"""

from __future__ import annotations

from collections.abc import Iterator

from irc.model import Resource
from irc.model.quantities import Number
from irc.validation.bound_schedule import BoundSchedule, Occurrence, UncheckedTaskError
from irc.validation.happenings import Edge, Timelines
from irc.validation.verdict import Violations


def check_loads(bound: BoundSchedule, violations: Violations) -> None:
    """Checks that what overlaps, in time and rank, has one start, one end and one family."""
    for resource in _batches(bound):
        last: Occurrence | None = None
        for use in _uses(bound, resource):
            if last is not None and (use.start, use.rank) < (last.end, last.end_rank):
                _check_together(resource, last, use, violations)
                if (use.end, use.end_rank) <= (last.end, last.end_rank):
                    continue
            last = use


def _batches(bound: BoundSchedule) -> Iterator[Resource]:
    return (r for r in bound.resources.values() if r.kind == "batch")


def _uses(bound: BoundSchedule, resource: Resource) -> list[Occurrence]:
    """The uses of a resource, in order. What takes no time uses nothing."""
    holders = [
        o
        for o in bound.occurrences
        if o.start < o.end and o.entry.resources.get(resource.id, 0) > 0
    ]
    return sorted(holders, key=lambda o: (o.start, o.rank, o.end, o.end_rank))


def _check_together(
    resource: Resource, one: Occurrence, other: Occurrence, violations: Violations
) -> None:
    families = [_family(o, resource.id) for o in (one, other)]
    if (one.start, one.end) == (other.start, other.end) and families[0] == families[1]:
        return
    who = f"{one.name} and {other.name} are in {resource.id!r} at once"
    if one.start != other.start:
        why = f"but start at {violations.time(one.start)} and {violations.time(other.start)}"
    elif one.end != other.end:
        why = f"but end at {violations.time(one.end)} and {violations.time(other.end)}"
    else:
        why = f"but their families are {_named(families[0])} and {_named(families[1])}"
    violations.add(
        "load",
        f"{who}, {why}",
        [one.entry.id, other.entry.id],
        (one.start, other.start),
        carried=one.past is not None and other.past is not None,
    )


def _family(occurrence: Occurrence, resource: str) -> str | None:
    """The family of the uses by which an occurrence may hold a resource."""
    families = {use.family for use in occurrence.uses if resource in use.alternatives}
    if len(families) > 1:
        raise UncheckedTaskError(
            f"uses of {resource!r} by {occurrence.entry.id!r} have different families"
        )
    return next(iter(families), None)


def _named(family: str | None) -> str:
    return "none" if family is None else repr(family)


def load_edges(bound: BoundSchedule, timelines: Timelines, count: int) -> tuple[int, list[Edge]]:
    """The number of nodes, and the edges that keep loads apart which touch in time.

    Each instant at which one load ends and another begins has a node of its own between them.
    """
    edges: list[Edge] = []
    for resource in _batches(bound):
        uses = _uses(bound, resource)
        ending: dict[Number, list[int]] = {}
        for use in uses:
            ending.setdefault(use.end, []).append(timelines.nodes[use.number][True])
        begun: dict[Number, int] = {}
        for use in uses:
            if use.start not in ending:
                continue
            if use.start not in begun:
                begun[use.start] = count
                edges += [(node, count, 0) for node in ending[use.start]]
                count += 1
            edges.append((begun[use.start], timelines.nodes[use.number][False], 0))
    return count, edges
