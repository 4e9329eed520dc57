"""Decisions of an engine about activities, and the places of activities in an exact schedule."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from irc.errors import IrcError

Moment = int | Fraction


class AnswerError(IrcError):
    """An engine's answer does not correspond to any exact schedule of the task.

    `line` is the line of the answer's text, from 1, that shows it, if there is one.
    """

    def __init__(self, message: str, line: int | None = None) -> None:
        super().__init__(message)
        self.line = line


@dataclass(frozen=True, slots=True)
class Decision:
    """A decision of an engine about one activity. Times are in ticks, perhaps not whole.

    `chosen[u]` is the resource (index) taken for use u, or None where the engine did not say.
    Happenings of equal time come in the order of their ranks, as far as the engine gives any.
    """

    start: Moment
    end: Moment
    chosen: tuple[int | None, ...] = ()
    present: bool = True
    mode: int | None = None
    rank: int = 0
    end_rank: int = 0


ABSENT = Decision(0, 0, (), present=False)


@dataclass(frozen=True, slots=True)
class Placed:
    """One activity's place in the exact schedule: whole ticks, one resource for each use.

    (None for the uses of modes that were not chosen.)
    """

    start: int
    end: int
    resources: tuple[int | None, ...]
    present: bool = True
    mode: int | None = None
    rank: int = 0
    end_rank: int = 0


def as_decision(place: Placed) -> Decision:
    """The decision that leads to a place."""
    return Decision(
        place.start,
        place.end,
        place.resources,
        place.present,
        place.mode,
        place.rank,
        place.end_rank,
    )


ABSENT_PLACE = Placed(0, 0, (), present=False)
