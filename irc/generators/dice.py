"""Random choices that are the same on every machine, and evenly spread targets.

Only `random.Random.random` is used, whose sequence Python guarantees for a seed, and arithmetic
that IEEE 754 defines to the last bit: no function of the system's mathematical library.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import TypeVar

T = TypeVar("T")

_BASES = (2, 3, 5, 7)
"""The bases of a Halton sequence in four dimensions.

Source: J. H. Halton, Algorithm 247: Radical-inverse quasi-random point sequence, CACM 1964.
"""

_LOGISTIC_DEVIATION = 1.8137993642342178
"""The standard deviation of the logistic distribution, π / √3."""

_TERMS = 40


class Dice:
    """Random choices of one instance."""

    def __init__(self, *seed: str | int) -> None:
        # (A text is hashed by SHA-512, the same everywhere.)
        self._random = random.Random("/".join(map(str, seed)))

    def chance(self, probability: float) -> bool:
        """Whether something with a probability happens."""
        return self._random.random() < probability

    def below(self, limit: int) -> int:
        """A whole number from 0 to `limit` - 1."""
        return int(self._random.random() * limit)

    def between(self, low: int, high: int) -> int:
        """A whole number from `low` to `high`."""
        return low + self.below(high - low + 1)

    def one_of(self, choices: Sequence[T]) -> T:
        """One of the choices, each as probable as any other."""
        return choices[self.below(len(choices))]

    def shuffled(self, items: Sequence[T]) -> list[T]:
        """The items in random order."""
        found = list(items)
        for k in range(len(found) - 1, 0, -1):
            other = self.below(k + 1)
            found[k], found[other] = found[other], found[k]
        return found


def spread(index: int, dice: Dice) -> tuple[float, ...]:
    """Four numbers between 0 and 1 for the instance `index` of a set, which fill the space evenly.

    `dice` are those of the set: they shift all of its numbers.
    """
    shifts = [dice.below(1_000_000) / 1_000_000 for _ in _BASES]
    found = (_mirrored(index, base) + shift for base, shift in zip(_BASES, shifts, strict=True))
    return tuple(min(0.999, max(0.001, value - int(value))) for value in found)


def _mirrored(index: int, base: int) -> float:
    """The digits of a number behind the point, in reverse."""
    found, place = 0.0, 1.0
    while index:
        place /= base
        index, digit = divmod(index, base)
        found += digit * place
    return found


def logarithm(value: float) -> float:
    """The natural logarithm of a number above 0, by its series: the same bits everywhere."""
    halvings = 0
    while value > 1.5:
        value, halvings = value / 2, halvings + 1
    while value < 0.75:
        value, halvings = value * 2, halvings - 1
    ratio = (value - 1) / (value + 1)
    power, total = ratio, 0.0
    for k in range(_TERMS):
        total += power / (2 * k + 1)
        power *= ratio * ratio
    return 2 * total + halvings * 0.6931471805599453


def bell(share: float) -> float:
    """The quantile of the logistic distribution with mean 0 and deviation 1."""
    return logarithm(share / (1 - share)) / _LOGISTIC_DEVIATION


def tail(share: float) -> float:
    """The quantile of the exponential distribution with mean 1 and deviation 1."""
    return -logarithm(1 - share)
