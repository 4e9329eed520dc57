"""Rule 4.5: orders of uses, one directly after another or the same on several resources.

The uses of a resource are looked at in the order of their starts: O(n log n) for each resource,
and O(jobs²) for each `same_order`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.verdict import Violations

_Places = Mapping[str, int]
"""By action, the place of its use among the uses of a resource."""


def check_sequences(bound: BoundSchedule, violations: Violations) -> None:
    """Checks every sequence of the task."""
    if not bound.task.sequences:
        return
    uses = _UsesInOrder(bound)
    for order in bound.task.sequences:
        if order.consecutive is not None:
            _check_consecutive(order.consecutive, order.resource, uses, violations)
        elif order.same_order is not None:
            rows = order.jobs or [*_jobs(bound, order.same_order)]
            _check_same_order(order.same_order, rows, uses, violations)


class _UsesInOrder:
    """The uses of each resource in order. What takes no time uses nothing."""

    def __init__(self, bound: BoundSchedule) -> None:
        self.bound = bound
        self.found: dict[str, tuple[list[Occurrence], _Places]] = {}

    def of(self, resource: str) -> tuple[list[Occurrence], _Places]:
        """The uses of a resource, and the place of each present action among them."""
        if resource not in self.found:
            holders = [
                o
                for o in self.bound.occurrences
                if o.start < o.end and o.entry.resources.get(resource, 0) > 0
            ]
            holders.sort(key=lambda o: (o.start, o.rank, o.end, o.end_rank))
            places = {o.entry.id: k for k, o in enumerate(holders) if not o.cancelled}
            self.found[resource] = holders, places
        return self.found[resource]


def _check_consecutive(
    pair: Sequence[str], resource: str | None, uses: _UsesInOrder, violations: Violations
) -> None:
    first, second = pair
    names = [*uses.bound.resources] if resource is None else [resource]
    for name in names:
        held, places = uses.of(name)
        if first not in places or second not in places:
            continue
        before, after = places[first], places[second]
        if after == before + 1:
            continue
        if after < before:
            message = f"{held[after].name} uses {name!r} before {held[before].name}"
            history = held[after].past is not None
        else:
            between = held[before + 1]
            message = f"{between.name} uses {name!r} after {held[before].name}"
            history = between.past is not None
        violations.add(
            "sequence",
            f"{message}; {second!r} must be its next use after {first!r}",
            [first, second],
            (held[before].start, held[after].start),
            carried=history,
        )


def _check_same_order(
    resources: Sequence[str],
    rows: Sequence[Sequence[str | None]],
    uses: _UsesInOrder,
    violations: Violations,
) -> None:
    for (k, one), (n, other) in combinations(enumerate(resources), 2):
        held, places = uses.of(one)
        also_held, also_places = uses.of(other)
        there = [row for row in rows if row[k] in places and row[n] in also_places]
        for first, second in combinations(there, 2):
            a, b = places[str(first[k])], places[str(second[k])]
            c, d = also_places[str(first[n])], also_places[str(second[n])]
            if a == b or c == d or (a < b) == (c < d):
                continue
            before, after = (held[min(a, b)], held[max(a, b)])
            earlier, later = (also_held[min(c, d)], also_held[max(c, d)])
            violations.add(
                "sequence",
                f"{before.name} uses {one!r} before {after.name}, but {earlier.name} uses "
                f"{other!r} before {later.name}: the order must be the same",
                [o.entry.id for o in (before, after, earlier, later)],
                (before.start, earlier.start),
                carried=before.past is not None and earlier.past is not None,
            )


def _jobs(bound: BoundSchedule, resources: Sequence[str]) -> Iterator[list[str | None]]:
    """A row for each group, and for each action in no group: who of it may hold each resource."""
    grouped = {name for group in bound.task.groups for name in group.actions}
    members: list[Sequence[str]] = [group.actions for group in bound.task.groups]
    members += [[a.id] for a in bound.task.actions if a.id not in grouped]
    users = {
        resource: {
            action.id
            for action in bound.task.actions
            for use in (*action.uses, *(u for mode in action.modes for u in mode.uses))
            if resource in use.alternatives
        }
        for resource in resources
    }
    for names in members:
        yield [next((n for n in names if n in users[r]), None) for r in resources]
