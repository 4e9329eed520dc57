"""Changes of capacity by an event, over a window or from a time on."""

from __future__ import annotations

from dataclasses import dataclass

from irc.model import Calendar, Resource, Window
from irc.model.quantities import Number
from irc.model.times import Clock


@dataclass(frozen=True)
class _Piece:
    start: Number
    end: Number | None
    capacity: int


def with_capacity(
    resource: Resource,
    capacity: int,
    start: Number,
    end: Number | None,
    clock: Clock,
    calendar: Calendar | None = None,
) -> Resource:
    """The resource with `capacity` at every instant of [start, end), or from `start` on.

    Its windows are cut at `start` and `end`. Without an end the new capacity becomes the usual
    one, and windows give the previous capacity before `start`. With a `calendar` that is the
    capacity at its open times; a window with an end overrides it.
    """
    if end is None and calendar is not None:
        return _from_now(resource, calendar, capacity, start, clock)
    pieces = [p for piece in _pieces(resource, clock) for p in _outside(piece, start, end)]
    pieces.append(_Piece(start, end, capacity))
    pieces.sort(key=lambda piece: piece.start)
    base = capacity if end is None else resource.capacity
    windows = [
        Window(from_=piece.start, to=piece.end, capacity=piece.capacity)
        for piece in _joined(pieces)
        if piece.end is not None and piece.capacity != base
    ]
    changed = {"capacity": base, "availability": tuple(windows)}
    return resource.model_copy(update=changed)


def _from_now(
    resource: Resource, calendar: Calendar, capacity: int, start: Number, clock: Clock
) -> Resource:
    """The resource with another capacity at open times from `start` on, and windows before that."""
    from irc.lowering.calendars import OpenTimes, without

    opened = [(a, min(b, start)) for a, b in OpenTimes([calendar], clock).until(start) if a < start]
    given = sorted(
        (clock.number(w.from_), min(clock.number(w.to), start), w.capacity)
        for w in resource.availability
        if clock.number(w.from_) < start
    )
    left = without(opened, [(a, b) for a, b, _ in given], start)
    before = sorted([*given, *((a, b, resource.capacity) for a, b in left)])
    windows: list[Window] = []
    reached: Number = 0
    for a, b, level in [*before, (start, start, 0)]:
        if reached < a:
            windows.append(Window(from_=reached, to=a, capacity=0))
        if a < b:
            windows.append(Window(from_=a, to=b, capacity=level))
        reached = b
    return resource.model_copy(update={"capacity": capacity, "availability": tuple(windows)})


def _pieces(resource: Resource, clock: Clock) -> list[_Piece]:
    """The capacity over all time as pieces without gaps; the last piece has no end."""
    windows = sorted(
        (
            _Piece(clock.number(window.from_), clock.number(window.to), window.capacity)
            for window in resource.availability
        ),
        key=lambda piece: piece.start,
    )
    pieces: list[_Piece] = []
    reached: Number = 0
    for window in windows:
        if reached < window.start:
            pieces.append(_Piece(reached, window.start, resource.capacity))
        pieces.append(window)
        reached = window.end if window.end is not None else reached
    return [*pieces, _Piece(reached, None, resource.capacity)]


def _outside(piece: _Piece, start: Number, end: Number | None) -> list[_Piece]:
    """The parts of a piece outside [start, end)."""
    left = []
    if piece.start < start:
        until = start if piece.end is None else min(piece.end, start)
        left.append(_Piece(piece.start, until, piece.capacity))
    if end is not None and (piece.end is None or piece.end > end):
        left.append(_Piece(max(piece.start, end), piece.end, piece.capacity))
    return left


def _joined(pieces: list[_Piece]) -> list[_Piece]:
    """The same pieces, with neighbours of equal capacity joined."""
    joined: list[_Piece] = []
    for piece in pieces:
        if joined and joined[-1].capacity == piece.capacity and joined[-1].end == piece.start:
            joined[-1] = _Piece(joined[-1].start, piece.end, piece.capacity)
        else:
            joined.append(piece)
    return joined
