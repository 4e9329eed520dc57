"""Lowers set-ups: rows of families become a table of indexes. Loaded for tasks that have some."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from irc.lowering.elements import ToTicks, natural_order, ticks_or_none
from irc.model import Resource, Task
from irc.model import Setups as SetupsNode
from irc.model.quantities import Span
from irc.problem import ANY_FAMILY, Setup, Setups

ANY = "*"
"""In a row, any family that the other one is not."""


def families_of(task: Task) -> tuple[str, ...]:
    """The names of all families, in order."""
    return tuple(sorted(set(_named(task)) - {ANY}, key=natural_order))


def _named(task: Task) -> Iterator[str]:
    for resource in task.resources:
        if resource.setups is not None:
            if resource.setups.initial is not None:
                yield resource.setups.initial
            for row in resource.setups.times:
                yield from (row.from_, row.to)
    for action in task.actions:
        for use in (*action.uses, *(use for mode in action.modes for use in mode.uses)):
            if use.family is not None:
                yield use.family


def setup_between(resource: Resource, before: str | None, after: str | None) -> Span:
    """The time of the set-up between two families, as the task writes it."""
    setups = resource.setups
    if setups is None:
        return 0
    rows = {(row.from_, row.to): row.time for row in setups.times}
    if before == after:
        return 0 if after is None else rows.get((after, after), 0)
    a, b = before or ANY, after or ANY
    return next((rows[r] for r in ((a, b), (a, ANY), (ANY, b), (ANY, ANY)) if r in rows), 0)


def lowered_setups(resource: Resource, families: Mapping[str, int], to_ticks: ToTicks) -> Setups:
    """The set-ups of a resource, by the indexes of their families."""
    setups = resource.setups or SetupsNode()
    table: dict[tuple[int, int], Setup] = {}
    for row in setups.times:
        time = ticks_or_none(row.time, to_ticks)
        key = families.get(row.from_, ANY_FAMILY), families.get(row.to, ANY_FAMILY)
        if time is not None:
            table.setdefault(key, Setup(time, row.cost))
    initial = None if setups.initial is None else families.get(setups.initial)
    return Setups(dict(sorted(table.items())), initial, tight=resource.no_idle)
