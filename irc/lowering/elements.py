"""Lowers parts of a task to integers: times, demands for resources, the order of names."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from irc.model import DurationRange, Use
from irc.model.times import Instant
from irc.problem import NO_FAMILY, ContendedPool, OpenDemand, Renewable, Requirement

_DIGITS = re.compile(r"([0-9]{1,18})")


ToTicks = Callable[[Instant], int]


def natural_order(name: str) -> tuple[list[tuple[int, str]], str]:
    """A sort key that orders names as people do: "job2" before "job10"."""
    parts = _DIGITS.split(name)
    if len(parts) == 3:
        return [(-1, parts[0]), (int(parts[1]), ""), (-1, parts[2])], name
    return [(int(p), "") if k % 2 else (-1, p) for k, p in enumerate(parts)], name


def pool_of(resource: Renewable, k: int) -> ContendedPool:
    """The contended pool of one resource (the k-th) that is interchangeable with no other."""
    if not resource.windows:
        return ContendedPool(resource.id, resource.capacity, (k,))
    greatest = resource.greatest_capacity()
    return ContendedPool(resource.id, greatest, (k,), resource.capacity, resource.windows)


def ticks_or_none(value: Instant, to_ticks: ToTicks) -> int | None:
    """A time in ticks; None for one without meaning or before 0, which the checks report."""
    ticks = due_ticks(value, to_ticks)
    return None if ticks is None or ticks < 0 else ticks


def due_ticks(due: Instant | None, to_ticks: ToTicks) -> int | None:
    """A due date in ticks, which may be before 0; None for none, or for one without meaning."""
    try:
        return None if due is None else to_ticks(due)
    except KeyError:
        return None


def span(duration: object, to_ticks: ToTicks) -> tuple[int, int]:
    if isinstance(duration, DurationRange):
        return to_ticks(duration.min), to_ticks(duration.max)
    ticks = to_ticks(duration)  # type: ignore[arg-type]
    return ticks, ticks


def requirements(
    uses: tuple[Use, ...], resource_index: dict[str, int], families: Mapping[str, int]
) -> tuple[Requirement, ...]:
    requirements = [
        Requirement(
            tuple(sorted({resource_index[r] for r in use.alternatives})),
            use.amount,
            k,
            NO_FAMILY if use.family is None else families.get(use.family, NO_FAMILY),
        )
        for k, use in enumerate(uses)
        if use.alternatives and all(r in resource_index for r in use.alternatives)
    ]
    return tuple(sorted(requirements))


def open_demands_of(uses: tuple[Requirement, ...]) -> tuple[OpenDemand, ...]:
    """The open demands of an activity before any pass: all of its uses.

    (Callers leave out activities of duration 0, which use nothing.)
    """
    return tuple(OpenDemand(k, use.alternatives, use.amount) for k, use in enumerate(uses))
