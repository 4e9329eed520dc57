"""Reservoirs in a CP-SAT model: one reservoir constraint each.

Levels count from the initial one. A reservoir constraint sees all changes of one value of its line
together, so the line is time, or moments where there are ranks; and where an instant may need an
order of its happenings (see `_wants_order`), each of them has a place of its own on a finer line.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from irc.problem import Problem, Reservoir
from irc.targets import Refusal
from irc_cpsat.encoding.builder import Builder


class _Happening(NamedTuple):
    """A start or an end, or both where an activity takes no time, and its net changes.

    `mode`: the mode in which it has these changes; None: in all.
    """

    activity: int
    at_end: bool
    amounts: dict[int, int]
    mode: int | None = None


@dataclass
class _StockChanges:
    """The changes of one reservoir: their times, amounts and literals."""

    places: list[Any] = field(default_factory=list)
    amounts: list[int] = field(default_factory=list)
    actives: list[Any] = field(default_factory=list)


MOST_CHANGES = 800
"""The most changes of a reservoir that is given and taken: the solver compares all pairs."""


def add_reservoirs(builder: Builder) -> None:
    """Adds every reservoir. Raises `Refusal` where one has more than `MOST_CHANGES`."""
    happenings = list(_happenings(builder.problem))
    finer = _reservoirs_that_want_order(builder.problem, happenings)
    ordered = {(h.activity, h.at_end): h for h in happenings if not finer.isdisjoint(h.amounts)}
    places = _places(builder, list(ordered.values()))
    changes = [_StockChanges() for _ in builder.problem.reservoirs]
    for happening in happenings:
        i, at_end, amounts, mode = happening
        present = builder.present[i] if mode is None else builder.modes[i][mode]
        for r, amount in amounts.items():
            own = changes[r]
            own.places.append(places[i, at_end] if r in finer else builder.point(i, at_end=at_end))
            own.amounts.append(amount)
            own.actives.append(True if present is None else present)
    for reservoir, own in zip(builder.problem.reservoirs, changes, strict=True):
        if own.places:
            _add_reservoir(builder, reservoir, own)


def _add_reservoir(builder: Builder, reservoir: Reservoir, changes: _StockChanges) -> None:
    mixed = min(changes.amounts) < 0 < max(changes.amounts)
    if mixed and len(changes.amounts) > MOST_CHANGES:
        raise Refusal(
            f"reservoir {reservoir.id!r} is changed {len(changes.amounts):,} times; at most "
            f"{MOST_CHANGES:,} changes of one that is given and taken fit into a model",
            reservoir.origin,
            "let one action stand for several changes, or split the task",
        )
    below = sum(a for a in changes.amounts if a < 0)
    above = sum(a for a in changes.amounts if a > 0)
    if reservoir.greatest is not None:
        above = min(above, reservoir.greatest - reservoir.initial)
    builder.model.add_reservoir_constraint_with_active(
        changes.places,
        changes.amounts,
        changes.actives,
        max(below, reservoir.least - reservoir.initial),
        above,
    )


def _happenings(problem: Problem) -> Iterator[_Happening]:
    for i, activity in enumerate(problem.activities):
        details = activity.details
        by_mode = any(mode.stock for mode in details.modes)
        modes = range(len(details.modes)) if by_mode else (None,)
        for mode in modes:
            found: dict[bool, dict[int, int]] = {}
            for change in details.in_mode(mode).stock:
                at_end = change.at_end and activity.duration_max > 0
                amounts = found.setdefault(at_end, {})
                amounts[change.reservoir] = amounts.get(change.reservoir, 0) + change.amount
            for at_end, amounts in sorted(found.items()):
                changed = {r: amount for r, amount in amounts.items() if amount}
                if changed:
                    yield _Happening(i, at_end, changed, mode)


# --- an order of the happenings of one instant ---


def order_count(problem: Problem) -> int:
    """The number of places in a moment for happenings whose order may matter; at least 1."""
    happenings = list(_happenings(problem))
    finer = _reservoirs_that_want_order(problem, happenings)
    return max(1, sum(not finer.isdisjoint(h.amounts) for h in happenings))


def _places(builder: Builder, ordered: Sequence[_Happening]) -> dict[tuple[int, bool], Any]:
    """A place for each happening: its moment, and behind that a number that no other one has.

    What starts and ends as one happening has one place.
    """
    model, count = builder.model, len(ordered)
    places: dict[tuple[int, bool], Any] = {}
    numbers = []
    last = 4 * (builder.horizon + 1) * builder.rank_count * max(1, count)
    reach = max((a.duration_min + (a.start or 0) for a in builder.problem.activities), default=0)
    last += 2 * reach * builder.rank_count * max(1, count)
    for i, at_end, *_ in ordered:
        number = model.new_int_var(0, count - 1, "")
        place = model.new_int_var(0, last, "")
        numbers.append(number)
        places[i, at_end] = place
        moment = builder.moment(i, at_end=at_end)
        activity = builder.problem.activities[i]
        if not (at_end and activity.duration_min == 0 and (i, False) in places):
            model.add(place == moment * count + number)
            continue
        first = builder.moment(i, at_end=False)
        apart = model.new_bool_var("")
        model.add(moment >= first + 1).only_enforce_if(apart)
        model.add(moment == first).only_enforce_if(~apart)
        model.add(place == moment * count + number).only_enforce_if(apart)
        model.add(place == places[i, False]).only_enforce_if(~apart)
    if count > 1:
        model.add_all_different(numbers)
    for k, j in _past_first(builder.problem, ordered):
        model.add(numbers[k] < numbers[j])
    return places


def _past_first(problem: Problem, ordered: Sequence[_Happening]) -> Iterator[tuple[int, int]]:
    """The pairs of what has ended at an event's instant and what starts then, by number."""
    for j, starting in enumerate(ordered):
        not_before = problem.activities[starting.activity].details.not_before
        if not_before is None or starting.at_end:
            continue
        for k, other in enumerate(ordered):
            if other.at_end and problem.activities[other.activity].has_ended_by(not_before[0]):
                yield k, j


def _reservoirs_that_want_order(
    problem: Problem, happenings: Sequence[_Happening]
) -> frozenset[int]:
    """The reservoirs of which some instant, fine as a whole, may have no order that is.

    They are taken together with those that the same happenings change. What may start and end as
    one happening counts as that, too.
    """
    happenings = [*happenings, *_in_one(problem, happenings)]
    binding = {
        r: _binding_sides(reservoir, [h.amounts[r] for h in happenings if r in h.amounts])
        for r, reservoir in enumerate(problem.reservoirs)
    }
    amounts = [{r: a for r, a in h.amounts.items() if any(binding[r])} for h in happenings]
    found: set[int] = set()
    for component in _components(amounts):
        own = [a for a in amounts if not component.isdisjoint(a)]
        if _wants_order(problem, component, own, binding):
            found |= component
    return frozenset(found)


def _in_one(problem: Problem, happenings: Sequence[_Happening]) -> Iterator[_Happening]:
    """The start and the end together, of each activity that may take no time, by mode."""
    starts = {(h.activity, h.mode): h for h in happenings if not h.at_end}
    for end in happenings:
        start = starts.get((end.activity, end.mode))
        if end.at_end and start is not None and problem.activities[end.activity].duration_min == 0:
            both = {
                r: start.amounts.get(r, 0) + end.amounts.get(r, 0)
                for r in start.amounts | end.amounts
            }
            yield start._replace(amounts={r: amount for r, amount in both.items() if amount})


def _binding_sides(reservoir: Reservoir, amounts: Sequence[int]) -> tuple[bool, bool]:
    """Whether the level could ever fall below its least, and rise above its greatest."""
    lowest = reservoir.initial + sum(a for a in amounts if a < 0)
    highest = reservoir.initial + sum(a for a in amounts if a > 0)
    return lowest < reservoir.least, (
        reservoir.greatest is not None and highest > reservoir.greatest
    )


def _components(amounts: Sequence[dict[int, int]]) -> list[set[int]]:
    """The reservoirs, together with those that one happening changes with them."""
    components: list[set[int]] = []
    for own in amounts:
        together = set(own)
        apart = []
        for component in components:
            if component.isdisjoint(together):
                apart.append(component)
            else:
                together |= component
        components = [*apart, together] if together else apart
    return components


def _wants_order(
    problem: Problem,
    component: set[int],
    amounts: Sequence[dict[int, int]],
    binding: dict[int, tuple[bool, bool]],
) -> bool:
    """Whether an order is not sure to exist wherever the levels before and after are in bounds.

    One reservoir has one if its range has room for the greatest amounts given and taken: what
    does not fit above leaves room below. Several that can only run out have one if nothing is
    given for itself, however indirectly: givers first, takers last, in between by what is made
    of what.
    """
    if len(component) == 1:
        (r,) = component
        if not all(binding[r]):
            return False
        reservoir = problem.reservoirs[r]
        given = max(a[r] for a in amounts)
        taken = -min(a[r] for a in amounts)
        assert reservoir.greatest is not None
        return reservoir.greatest - reservoir.least < given + taken - 1
    if any(binding[r][1] for r in component):
        return True
    following: dict[int, set[int]] = {r: set() for r in component}
    for own in amounts:
        for r, amount in own.items():
            if amount < 0:
                following[r] |= {other for other, a in own.items() if a > 0}
    return _has_cycle(following)


def _has_cycle(following: dict[int, set[int]]) -> bool:
    left = dict(following)
    while left:
        last = [r for r, others in left.items() if others.isdisjoint(left)]
        if not last:
            return True
        for r in last:
            del left[r]
    return False
