"""Stock in re-timing: the changes of a reservoir keep an order in which its level stays in bounds.

The changes are cut into batches that follow each other (weakly: `t_next >= t_before`). Within a
batch any order, and any spread over time, keeps the level within bounds:

- all changes of one instant, where neither all of its productions alone nor all of its consumptions
  alone would leave the bounds;
- otherwise its productions and then its consumptions, or the other way round, where that stays
  within bounds: levels rise to a peak and fall from it;
- otherwise, where only both together are possible, all of them tied to one instant.

Two batches that come to fall into one instant only take an intermediate level away.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from operator import itemgetter
from typing import NamedTuple

from irc.problem import Problem, Reservoir
from irc.problem.decisions import Decision, Moment
from irc.problem.temporal_network import Network
from irc.problem.time_points import PointMap


class _Change(NamedTuple):
    """`amount` at `offset` after a point of the network."""

    time: Moment
    amount: int
    point: int
    offset: int


class _Batch(NamedTuple):
    changes: list[_Change]
    tied: bool = False


def keep_stock(
    problem: Problem,
    decisions: Sequence[Decision],
    points: PointMap,
    network: Network,
    floors: list[int],
) -> None:
    """Adds the order of each reservoir's changes to a network, linear in their number.

    Between two batches stands a point of its own, so `network` and `floors` grow.
    """
    changes: list[list[_Change]] = [[] for _ in problem.reservoirs]
    for i, activity in enumerate(problem.activities):
        for stock, amount, at_end in activity.details.stock:
            place = (points.end[i], points.end_offset[i]) if at_end else (points.start[i], 0)
            time = decisions[i].end if at_end else decisions[i].start
            changes[stock].append(_Change(time, amount, *place))
    for reservoir, its in zip(problem.reservoirs, changes, strict=True):
        batches = list(_batches(reservoir, sorted(its)))
        for number, batch in enumerate(batches):
            if number:
                _add_boundary(network, floors, batches[number - 1].changes, batch.changes)
            if batch.tied:
                _tie(network, batch.changes)


def _batches(reservoir: Reservoir, changes: list[_Change]) -> Iterator[_Batch]:
    greatest = reservoir.greatest
    level = reservoir.initial
    for _, same in groupby(changes, key=itemgetter(0)):
        instant = list(same)
        gives = [c for c in instant if c.amount > 0]
        takes = [c for c in instant if c.amount <= 0]
        fits_given = greatest is None or level + sum(c.amount for c in gives) <= greatest
        fits_taken = level + sum(c.amount for c in takes) >= reservoir.least
        if fits_given and fits_taken:
            yield _Batch(instant)
        elif fits_given:
            yield from (_Batch(part) for part in (gives, takes) if part)
        elif fits_taken:
            yield from (_Batch(part) for part in (takes, gives) if part)
        else:
            yield _Batch(instant, tied=True)
        level += sum(c.amount for c in instant)


def _add_boundary(
    network: Network, floors: list[int], before: list[_Change], after: list[_Change]
) -> None:
    boundary = network.size
    network.size += 1
    floors.append(0)
    for change in before:
        network.add(change.point, boundary, change.offset)
    for change in after:
        network.add(boundary, change.point, -change.offset)


def _tie(network: Network, changes: list[_Change]) -> None:
    first = changes[0]
    for other in changes[1:]:
        if other.point != first.point:
            network.add(first.point, other.point, first.offset - other.offset)
            network.add(other.point, first.point, other.offset - first.offset)
