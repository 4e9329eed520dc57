"""The resolution of a task: its times are read as multiples of it (docs/ir.md, "Resolution").

A task without a `resolution` is read exactly, unless one of its times is finer than any clock, as
the raw double 0.30000000000000004 is. Such a task has the resolution of a running task.
"""

from __future__ import annotations

import typing
from collections.abc import Callable, Container, Iterable, Iterator
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any

from pydantic import PlainValidator

from irc.diagnostics.source import Pointer
from irc.model.base import Node
from irc.model.quantities import Number, Quantity, TimeError, exact
from irc.model.times import Clock, Instant, format_number, parse_instant, parse_span

if TYPE_CHECKING:
    from irc.model.task import Task

FINEST = 10**9
"""A time with a greater denominator, as it is written and in seconds, is finer than any clock."""

COARSEST = Fraction(1, 1000)
"""Seconds: the resolution of a running task, unless it has a duration below a second."""

STEPS = 1000
"""The smallest duration is at least this multiple of a resolution that is derived."""


def derived_resolution(task: Task, clock: Clock, exact: tuple[Any, ...] = ()) -> Number | None:
    """The resolution of a task that gives none; None: it is read exactly.

    Parts of the tuples in `exact` are known to have no raw times.
    """
    known = {id(part) for parts in exact if isinstance(parts, tuple) for part in parts}
    return running_resolution(task, clock) if _has_raw_times(task, clock.unit, known) else None


def running_resolution(task: Task, clock: Clock) -> Number:
    """1 ms, or a power of ten of it at or below a thousandth of the smallest duration.

    In the task's unit, which is a multiple of it. A `resolution` that the task gives comes first.
    """
    if task.resolution is not None:
        return clock.exact(task.resolution)
    return fine_enough(durations(task.actions), clock)


def fine_enough(lengths: Iterable[Instant], clock: Clock) -> Number:
    """The resolution of a running task with these durations; those that cannot be read are left
    out.
    """
    smallest = min((n for n in _exact_all(lengths, clock) if n > 0), default=None)
    limit = min(COARSEST, clock.unit)
    if smallest is not None:
        limit = min(limit, Fraction(smallest) * clock.unit / STEPS)
    step = COARSEST
    while step > limit:
        step /= 10
    return exact(step / clock.unit)


def in_words(resolution: Number, clock: Clock) -> str:
    """ "1 ms": a resolution in the greatest unit of which it is a multiple."""
    seconds = Fraction(resolution) * clock.unit
    for name, size in (("s", 1), ("ms", 1000), ("us", 1_000_000)):
        if (seconds * size).denominator == 1:
            return f"{seconds * size} {name}"
    return f"{format_number(exact(seconds))} s"


def pinned(task: Task) -> Task:
    """The task with its derived resolution written down, so that no event changes it."""
    resolution = task.clock.resolution
    if task.resolution is not None or resolution is None:
        return task
    return task.model_copy(update={"resolution": resolution})


def durations(actions: Iterable[Any]) -> Iterator[Instant]:
    """Every duration of actions, as it was written; of a range its least above 0."""
    for action in actions:
        written = [action.duration, *(mode.duration for mode in action.modes)]
        for duration in written:
            if isinstance(duration, Node):  # A range.
                yield duration.min or duration.max  # type: ignore[attr-defined]
            elif duration is not None:
                yield duration


def with_times(node: Any, change: Callable[[Instant, Pointer], Instant], at: Pointer = ()) -> Any:
    """A part of the IR with all of its times changed; `at` is the pointer of the part."""
    updated: dict[str, Any] = {}
    kind: type[Node] = type(node)
    names = _time_fields(kind)
    for name in node.model_fields_set:
        value, place = getattr(node, name), (*at, _key(node, name))
        if isinstance(value, Node):
            new = with_times(value, change, place)
        elif isinstance(value, tuple):
            new = tuple(
                with_times(item, change, (*place, k)) if isinstance(item, Node) else item
                for k, item in enumerate(value)
            )
            new = value if all(a is b for a, b in zip(new, value, strict=True)) else new
        elif name in names and value is not None:
            new = change(value, place)
        else:
            continue
        if new is not value:
            updated[name] = new
    return node.model_copy(update=updated) if updated else node


def times_of(node: Any) -> list[tuple[Pointer, Instant]]:
    """Every time in a part of the IR, as it was written, with its pointer in that part."""
    found: list[tuple[Pointer, Instant]] = []

    def keep(value: Instant, place: Pointer) -> Instant:
        found.append((place, value))
        return value

    with_times(node, keep)
    return found


def _key(node: Any, name: str) -> str:
    return type(node).model_fields[name].alias or name


def _exact_all(values: Iterable[Instant], clock: Clock) -> Iterator[Number]:
    for value in values:
        try:
            yield clock.exact(value)
        except TimeError:  # It is reported where the element is checked.
            continue


def _has_raw_times(task: Task, unit: Fraction, known: Container[int]) -> bool:
    """Whether a time of the task is finer than any clock. Its events do not count.

    `known` are the identities of parts that have no such time.
    """
    if _is_raw(task.deadline, unit):
        return True
    parts = [*task.actions, *task.resources, *task.groups]
    parts += [e for e in task.precedence if e.model_fields_set != _PLAIN]
    return any(id(part) not in known and _holds_raw(part, unit) for part in parts)


_PLAIN = {"before", "after"}


def _holds_raw(node: Node, unit: Fraction) -> bool:
    held = node.__dict__
    for name in node.model_fields_set:  # No default is raw.
        value = held[name]
        if type(value) is int or type(value) is str or name in _WITHOUT_TIMES:
            continue
        if isinstance(value, tuple):
            if any(isinstance(item, Node) and _holds_raw(item, unit) for item in value):
                return True
        elif _holds_raw(value, unit) if isinstance(value, Node) else _is_raw(value, unit):
            return True
    return False


_WITHOUT_TIMES = ("conditions", "effects")


def _is_raw(value: Any, unit: Fraction) -> bool:
    if isinstance(value, Fraction):
        return value.denominator > FINEST and (value * unit).denominator > FINEST
    return isinstance(value, Quantity) and value.seconds.denominator > FINEST


@cache
def _time_fields(kind: type[Node]) -> frozenset[str]:
    """The fields of a part that hold a time."""
    return frozenset(
        name
        for name, field in kind.model_fields.items()
        if _is_time(field.metadata) or _mentions_time(field.annotation)
    )


def _is_time(metadata: Iterable[Any]) -> bool:
    return any(
        isinstance(m, PlainValidator) and m.func in (parse_span, parse_instant) for m in metadata
    )


def _mentions_time(annotation: Any) -> bool:
    if _is_time(getattr(annotation, "__metadata__", ())):
        return True
    return any(_mentions_time(part) for part in typing.get_args(annotation))
