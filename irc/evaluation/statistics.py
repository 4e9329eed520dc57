"""How sure a figure is, and whether two methods differ."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import lru_cache
from math import comb
from typing import TYPE_CHECKING, Any

from irc.evaluation.figure import PLACES, Rate

if TYPE_CHECKING:
    import numpy

DRAWS = 10_000
SEED = 0
LEVEL = 95


def interval(rate: Rate) -> tuple[float, float]:
    """The bootstrap interval of a rate: percentiles of 10,000 draws over its instances.

    Answers to the same instance are drawn together, since they are not independent.
    """
    if not rate.values or min(rate.values) == max(rate.values):
        return rate.value, rate.value
    import numpy as np

    sums, sizes = _by_instance(rate.values, rate.instances)
    weights = _draws(len(sums))
    means = (weights @ np.array(sums)) / (weights @ np.array(sizes))
    tail = (100 - LEVEL) / 2
    low, high = np.percentile(means, [tail, 100 - tail])
    return round(float(low) * rate.scale, PLACES), round(float(high) * rate.scale, PLACES)


def _by_instance(
    values: Sequence[float], instances: Sequence[Hashable]
) -> tuple[list[float], list[float]]:
    """By instance: the sum of its values, and their number."""
    sums: dict[Hashable, float] = {}
    sizes: dict[Hashable, float] = {}
    for value, instance in zip(values, instances, strict=True):
        sums[instance] = sums.get(instance, 0) + value
        sizes[instance] = sizes.get(instance, 0) + 1
    return list(sums.values()), list(sizes.values())


@lru_cache(maxsize=4)
def _draws(size: int) -> numpy.ndarray[Any, numpy.dtype[numpy.float64]]:
    """By draw: how many times each of `size` instances is drawn."""
    import numpy as np

    generator = np.random.default_rng(SEED)
    drawn = generator.multinomial(size, np.full(size, 1 / size), size=DRAWS)
    return drawn.astype(np.float64)


def mcnemar(only_first: int, only_second: int) -> float:
    """The exact two-sided p-value that two methods are equally often right (McNemar 1947).

    The arguments are the instances on which one method alone is right.
    """
    discordant = only_first + only_second
    fewer = min(only_first, only_second)
    tail = sum(comb(discordant, k) for k in range(fewer + 1))
    return min(1.0, 2 * tail / (1 << discordant))
