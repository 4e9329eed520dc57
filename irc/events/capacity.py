"""Changes of capacity by an event, over a window or from a time on."""

from __future__ import annotations

from dataclasses import dataclass

from irc.model import Resource, Window
from irc.model.quantities import Number
from irc.model.times import Clock


@dataclass(frozen=True)
class _Piece:
    start: Number
    end: Number | None
    capacity: int


def with_capacity(
    resource: Resource, capacity: int, start: Number, end: Number | None, clock: Clock
) -> Resource:
    """The resource with `capacity` at every instant of [start, end), or from `start` on.

    Its windows are cut at `start` and `end`. Without an end the new capacity becomes the usual
    one, and windows give the previous capacity before `start`.
    """
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
