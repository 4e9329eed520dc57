"""All that has a value that changes: state variables and number variables."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from irc.diagnostics.source import Pointer
from irc.model.quantities import exact
from irc.model.state_values import limits_text
from irc.model.times import format_number
from irc.problem.needs import _is_within


class NumberGoal(NamedTuple):
    """In the end the number `number` (index) is within [least, greatest]; None: no limit."""

    number: int
    least: int | None
    greatest: int | None

    def allows(self, level: int) -> bool:
        """Whether a level is within the limits."""
        return _is_within(level, self.least, self.greatest)


class TimedChange(NamedTuple):
    """At the tick `at` the world gives a variable a value (index into its values)."""

    at: int
    value: int


@dataclass(frozen=True, slots=True)
class Variable:
    """A state variable; `initial` is an index into its `values`.

    `changes` are in the order of time, no two of them at one time.
    """

    id: str
    values: tuple[bool | str, ...]
    initial: int
    origin: Pointer = ()
    changes: tuple[TimedChange, ...] = ()

    @property
    def known_values(self) -> frozenset[int]:
        """The values that it has at some time if no activity changes it."""
        return frozenset([self.initial, *(change.value for change in self.changes)])


@dataclass(frozen=True, slots=True)
class NumberVariable:
    """A number that stays within [least, greatest] (None: no limit) after every happening.

    Levels are whole: `scale` of them are 1 in the task. `changes` are in the order of time, no two
    of them at one time; the value of each is the new level.
    """

    id: str
    initial: int
    least: int | None = None
    greatest: int | None = None
    scale: int = 1
    origin: Pointer = ()
    changes: tuple[TimedChange, ...] = ()

    def allows(self, level: int) -> bool:
        """Whether a level is within the bounds."""
        return _is_within(level, self.least, self.greatest)

    def text(self, level: int) -> str:
        """A level as text for messages, as the task writes it."""
        return format_number(exact(Fraction(level, self.scale)))

    def limits_text(self, least: int | None, greatest: int | None) -> str:
        """Limits as text for messages: "at least 10"."""
        low, high = (
            None if level is None else exact(Fraction(level, self.scale))
            for level in (least, greatest)
        )
        return limits_text(low, high)
