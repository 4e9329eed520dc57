"""The resources, stock, conditions, effects and modes of an activity."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from irc.problem.resources import NO_FAMILY


class Requirement(NamedTuple):
    """Holds `amount` units of one of the `alternatives` (indexes into `Problem.resources`).

    `origin` is the index of the entry in the source's `uses`; `family` (an index into
    `Problem.families`) is what set-ups of the resource depend on.
    """

    alternatives: tuple[int, ...]
    amount: int
    origin: int = 0
    family: int = NO_FAMILY


class OpenDemand(NamedTuple):
    """A use of a resource that a solver still has to decide on.

    `use` is the index in the activity's `uses`; the `alternatives` index `Contention.pools`.
    """

    use: int
    alternatives: tuple[int, ...]
    amount: int


class StockChange(NamedTuple):
    """A change of a reservoir by an activity at one of its ends; a negative amount takes."""

    reservoir: int
    amount: int
    at_end: bool


class Condition(NamedTuple):
    """`var` (index) has `value` (index into its values) at the start, throughout, or at the end.

    `at` is "start", "all" or "end".
    """

    var: int
    value: int
    at: str


class Effect(NamedTuple):
    """`var` (index) gets `value` (index into its values) at the start or the end."""

    var: int
    value: int
    at_end: bool


def _is_within(level: int, least: int | None, greatest: int | None) -> bool:
    return (least is None or level >= least) and (greatest is None or level <= greatest)


class NumberCondition(NamedTuple):
    """The number `number` (index) is within [least, greatest] at the start, throughout, or at the
    end; None: no limit. `at` is "start", "all" or "end".
    """

    number: int
    least: int | None
    greatest: int | None
    at: str

    def allows(self, level: int) -> bool:
        """Whether a level is within the limits."""
        return _is_within(level, self.least, self.greatest)


class NumberEffect(NamedTuple):
    """The number `number` (index) changes by `amount` at the start or the end, or, if it `sets`,
    becomes `amount`.
    """

    number: int
    amount: int
    sets: bool
    at_end: bool


def together(effects: Iterable[NumberEffect]) -> tuple[NumberEffect, ...]:
    """Effects on numbers: all that one end of an activity adds to one is a sum."""
    found: dict[tuple[int, bool, bool, int], int] = {}
    for number, amount, sets, at_end in effects:
        key = number, at_end, sets, amount if sets else 0
        found[key] = amount if sets else found.get(key, 0) + amount
    return tuple(
        NumberEffect(number, amount, sets, at_end)
        for (number, at_end, sets, _), amount in sorted(found.items())
    )


class Mode(NamedTuple):
    """One way to carry out an activity; a fixed duration has both the same.

    Its stock, conditions, effects and cost come on top of the activity's own.
    """

    id: str
    duration_min: int
    duration_max: int
    stock: tuple[StockChange, ...] = ()
    conditions: tuple[Condition, ...] = ()
    effects: tuple[Effect, ...] = ()
    number_conditions: tuple[NumberCondition, ...] = ()
    number_effects: tuple[NumberEffect, ...] = ()
    cost: int = 0

    @property
    def bare(self) -> Mode:
        """The mode with its durations alone."""
        return Mode(self.id, self.duration_min, self.duration_max)


class Ranks(NamedTuple):
    """The ranks of an executed start and end; None where a rank is still to be found.

    `at_least`: the start has that rank or a higher one. (A running activity of fixed duration ends
    with the rank of its start, and must not come too early in the order of that instant.)
    """

    start: int | None
    end: int | None
    at_least: bool = False


class ProtectedLimits(NamedTuple):
    """While `activity` (index) runs, a number does not leave the limits of a `condition` where it
    is within them.

    The activity needs the limits throughout, and they are broken; who has this in its
    `protects_limits` does not break them again. -1 stands for the bounds of the number itself,
    which the history leaves: they count at all times.
    """

    activity: int
    condition: NumberCondition

    def takes_away(self, effect: NumberEffect) -> bool:
        """Whether an effect can lead out of the limits."""
        limits = self.condition
        if effect.number != limits.number:
            return False
        if effect.sets:
            return not limits.allows(effect.amount)
        return limits.least is not None if effect.amount < 0 else limits.greatest is not None


class Protected(NamedTuple):
    """While `activity` (index) runs, `var` does not lose `value` (both indexes) where it has it.

    The activity needs the value throughout and has lost it; who has this in its `protects` does not
    take the value away again.
    """

    activity: int
    var: int
    value: int
