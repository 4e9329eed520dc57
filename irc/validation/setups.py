"""Rules 4.3 and 4.4: between two consecutive uses of a resource there is its set-up, and perhaps
nothing else.

One pass over the uses of each resource in the order of their starts: O(n log n).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from irc.model import Resource
from irc.model.quantities import Number
from irc.validation.bound_schedule import BoundSchedule, Occurrence, UncheckedTaskError
from irc.validation.verdict import Violations

_ANY = "*"

_Rows = Mapping[tuple[str, str], tuple[Number, int]]
"""The time and the cost of each row, by the families before and after."""


class SetupDone(NamedTuple):
    """A set-up of a resource before a use, since the last use (None: since t = 0)."""

    resource: str
    before: Occurrence | None
    after: Occurrence
    families: tuple[str | None, str | None]
    time: Number
    cost: int


def setups_of(bound: BoundSchedule) -> Iterator[SetupDone]:
    """Every set-up that the uses of a schedule need, with those that take no time."""
    for resource in bound.resources.values():
        if resource.setups is not None:
            yield from _of_resource(bound, resource)


def _uses_without_gaps(bound: BoundSchedule) -> Iterator[SetupDone]:
    for resource in bound.resources.values():
        if resource.no_idle and resource.kind == "renewable":
            yield from _of_resource(bound, resource)


def _of_resource(bound: BoundSchedule, resource: Resource) -> Iterator[SetupDone]:
    rows = _rows(bound, resource)
    before: Occurrence | None = None
    family = None if resource.setups is None else resource.setups.initial
    known = family is not None
    holders = [
        o
        for o in bound.occurrences
        if o.start < o.end and o.entry.resources.get(resource.id, 0) > 0
    ]
    for after in sorted(holders, key=lambda o: (o.start, o.rank, o.end, o.end_rank)):
        following = _family(after, resource.id)
        if known:
            time, cost = _setup(rows, family, following)
            yield SetupDone(resource.id, before, after, (family, following), time, cost)
        before, family, known = after, following, True


def _rows(bound: BoundSchedule, resource: Resource) -> _Rows:
    rows: dict[tuple[str, str], tuple[Number, int]] = {}
    for row in () if resource.setups is None else resource.setups.times:
        said = bound.clock.number(row.time), row.cost
        if rows.setdefault((row.from_, row.to), said) != said:
            raise UncheckedTaskError(
                f"the set-up of {resource.id!r} from {row.from_!r} to {row.to!r} is given twice, "
                "in different ways"
            )
    return rows


def _family(occurrence: Occurrence, resource: str) -> str | None:
    """The family of the use by which an occurrence holds a resource."""
    families = {use.family for use in occurrence.uses if resource in use.alternatives}
    if len(families) > 1:
        raise UncheckedTaskError(
            f"uses of {resource!r} by {occurrence.entry.id!r} have different families"
        )
    return next(iter(families), None)


def _setup(rows: _Rows, before: str | None, after: str | None) -> tuple[Number, int]:
    """The time and the cost of the most specific row."""
    if before == after:
        return (0, 0) if after is None else rows.get((after, after), (0, 0))
    first, last = before or _ANY, after or _ANY
    for row in ((first, last), (first, _ANY), (_ANY, last), (_ANY, _ANY)):
        if row in rows:
            return rows[row]
    return (0, 0)


def check_setups(bound: BoundSchedule, violations: Violations) -> None:
    """Checks rule 4.3: each use begins when the set-up since the last one can be done.

    A set-up is compared by time alone: it takes place between two uses, whatever their ranks.
    """
    for setup in setups_of(bound):
        ready = setup.time if setup.before is None else setup.before.end + setup.time
        if setup.time and setup.after.start < ready:
            _add_too_early(setup, ready, violations)


def check_idle(bound: BoundSchedule, violations: Violations) -> None:
    """Checks rule 4.4: nothing but a set-up is between two uses of a resource with `no_idle`.

    As of a time, what is past is no gap.
    """
    for setup in _uses_without_gaps(bound):
        if setup.before is None:
            continue
        ready = setup.before.end + setup.time
        latest = ready if bound.at is None else max(ready, bound.at)
        if setup.after.start > latest:
            violations.add(
                "idle",
                f"{setup.resource!r} is idle from {violations.time(ready)} to "
                f"{violations.time(setup.after.start)}, between {setup.before.name} and "
                f"{setup.after.name}",
                [setup.before.entry.id, setup.after.entry.id],
                (ready, setup.after.start),
                carried=setup.after.past is not None and setup.before.past is not None,
            )


def _add_too_early(setup: SetupDone, ready: Number, violations: Violations) -> None:
    before, after = setup.before, setup.after
    since = "t = 0" if before is None else f"the end of {before.name}"
    at = "" if before is None else f" ({violations.time(before.end)})"
    of, to = (_named(family) for family in setup.families)
    violations.add(
        "setup",
        f"{after.name} starts at {violations.time(after.start)}, but {setup.resource!r} is not "
        f"set up before {violations.time(ready)}: {since}{at} + set-up from {of} to {to} "
        f"{violations.time(setup.time)}",
        [after.entry.id] if before is None else [before.entry.id, after.entry.id],
        (after.start, ready),
        carried=_is_history(setup),
    )


def _named(family: str | None) -> str:
    return "no family" if family is None else repr(family)


def _is_history(setup: SetupDone) -> bool:
    """Whether the history of both uses already lacks the time, wherever they end from now on."""
    if setup.after.past is None:
        return False
    if setup.before is None:
        return True
    past = setup.before.past
    return past is not None and setup.after.start < past.earliest_end + setup.time
